"""Spoilt descriptions through `toolroom fmu check` and FMPy's validation: do both find a fault, or neither?

    venv/bin/python fmu/conformance/mutations.py --toolroom target/debug/toolroom --count 50 UNIT.fmu ...

Of each unit's modelDescription.xml one attribute or element without children is left out, an attribute gets the value of another one of
its name, or none, or an element is doubled, changes places with its neighbour, moves elsewhere or gets the name of another. Prints, for each unit, how often both agree, and every disagreement with what each of them says. Exit code
1 where FMPy finds a fault and `fmu check` does not; being stricter than FMPy is no fault.
"""

import argparse
import copy
import json
import random
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

ATTRIBUTE = re.compile(r'\s([A-Za-z]+)="([^"]*)"')
LEAF = re.compile(r"[ \t]*<([A-Za-z0-9]+)(\s[^<>]*)?/>\n?")


def moved(text, random):
    """A text with one element doubled, moved or renamed, and what was done."""
    root = ElementTree.fromstring(text)
    pairs = [(parent, child) for parent in root.iter() for child in parent]
    parent, child = random.choice(pairs)
    kind = random.choice(["doubled", "swapped", "moved", "renamed"])
    what = f"<{child.tag}> in <{parent.tag}> {kind}"
    if kind == "doubled":
        parent.append(copy.deepcopy(child))
    elif kind == "swapped":
        place = list(parent).index(child)
        parent.remove(child)
        parent.insert(place + 1 if place + 1 <= len(parent) else 0, child)
    elif kind == "moved":
        target = random.choice([each for each in root.iter() if each not in list(child.iter())])
        parent.remove(child)
        target.append(child)
        what += f" to <{target.tag}>"
    else:
        name = random.choice(sorted({each.tag for _, each in pairs} - {child.tag}))
        what += f" to {name}"
        child.tag = name
    return f"{what} ({child.attrib})", '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode")


def mutations(text, random):
    """Endless spoilt texts with what was done to them."""
    body = text.index("<fmiModelDescription")
    attributes = [each for each in ATTRIBUTE.finditer(text, body) if not each[1].startswith("xmlns")]
    leaves = list(LEAF.finditer(text, body))
    while True:
        chance = random.random()
        if chance < 0.3:
            yield moved(text, random)
            continue
        if chance < 0.45 and leaves:
            leaf = random.choice(leaves)
            yield f"without {leaf[0].strip()}", text[: leaf.start()] + text[leaf.end() :]
            continue
        own = random.choice(attributes)
        others = sorted({each[2] for each in attributes if each[1] == own[1] and each[2] != own[2]})
        kind = random.choice(["left out", "another", "another", "empty", "number"])
        line = text.count("\n", 0, own.start()) + 1
        if kind == "left out":
            new = ""
        elif kind == "another" and others:
            new = f' {own[1]}="{random.choice(others)}"'
        elif kind == "number":
            new = f' {own[1]}="{random.choice(["-1", "0", "7", "99999", "1e400", "x"])}"'
        else:
            new = f' {own[1]}=""'
        if new != own[0]:
            yield f"line {line}:{own[0]} →{new or ' (left out)'}", text[: own.start()] + new + text[own.end() :]


def main():
    from fmpy.validation import validate_fmu

    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--toolroom", required=True)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("units", nargs="+", type=Path)
    arguments = parser.parse_args()
    missed = 0
    for path in arguments.units:
        draw = random.Random(f"{arguments.seed} {path.name}")
        with zipfile.ZipFile(path) as package:
            files = {name: package.read(name) for name in package.namelist()}
        text = files["modelDescription.xml"].decode()
        agreed, stricter, seen = 0, [], set()
        holes = []
        for what, spoilt in mutations(text, draw):
            if len(seen) == arguments.count:
                break
            if what in seen:
                continue
            seen.add(what)
            with tempfile.TemporaryDirectory() as folder:
                unit = Path(folder) / "unit.fmu"
                with zipfile.ZipFile(unit, "w") as package:
                    for name, content in files.items():
                        package.writestr(name, spoilt if name == "modelDescription.xml" else content)
                try:
                    theirs = [str(each) for each in validate_fmu(str(unit))]
                except Exception as error:
                    theirs = [str(error)]
                done = subprocess.run(
                    [arguments.toolroom, "fmu", "check", str(unit), "--json"], capture_output=True, text=True, timeout=60
                )
            ours = json.loads(done.stdout)["findings"] if done.stdout.startswith("{") else [{"message": done.stderr}]
            if (done.returncode != 0) == bool(theirs):
                agreed += 1
            elif theirs:
                holes.append(f"{what}: FMPy says {theirs[0]}")
            else:
                found = [each["message"] for each in ours if each.get("severity", "error") == "error"]
                stricter.append(f"{what}: fmu check says {found[:1]}")
        print(f"{path.stem}: agree on {agreed} of {len(seen)}, stricter in {len(stricter)}, missed {len(holes)}", flush=True)
        for each in holes:
            print(f"  missed   {each}")
        for each in stricter:
            print(f"  stricter {each}")
        missed += len(holes)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
