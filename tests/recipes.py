#!/usr/bin/env python3
"""Follows the recipes of CONTRIBUTING.md in a copy of the workspace, compiles the copy, and runs what was added.

    python3 tests/recipes.py                               # everything; third-party artefacts of target/debug are used again
    python3 tests/recipes.py --words                       # only whether every place that a recipe names is there
    python3 tests/recipes.py --features toolroom/fmu-import   # with the features of the build whose artefacts are there

All recipes are followed in one copy, which is compiled once. It stands in target/recipes, with a target directory of its own.
What target/debug holds of third parties, and of our crates that no recipe reaches, is used again; crates that the recipes reach
but whose speed none of them needs are compiled without optimisation. Where nothing is there to be used again, polars alone
takes fifteen minutes of processor time. Recipes are followed by their words: a block of code belongs to the line before it,
which says `New file PATH:`, or `In PATH, after LINE:`, `before` or `replacing`.
"""

import argparse
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Crates that compute while the recipes run: without optimisation they would take longer than their compilation saves.
COMPUTING = {f"toolroom-{name}" for name in ("effects", "cutting", "scenario", "cuts", "shop", "recording", "nominal", "facts", "gap")}
STEP = re.compile(r"^(?:New file `(?P<new>[^`]+)`|In `(?P<path>[^`]+)`, (?P<how>after|before|replacing) `(?P<line>.+)`):$")


def steps(text):
    """Every place and block of code of the recipes: (path, how, line, code)."""
    lines = text.splitlines()
    found = []
    for i, line in enumerate(lines):
        match = STEP.match(line)
        if not match:
            continue
        assert lines[i + 1].startswith("```"), f"CONTRIBUTING.md:{i + 2}: a block of code is due"
        end = lines.index("```", i + 2)
        code = "\n".join(lines[i + 2 : end]) + "\n"
        found.append((match["new"] or match["path"], match["how"], match["line"], code))
    return found


def followed(path, text, how, line, code):
    """The text of a file after one step."""
    if how is None:
        assert text is None, f"{path} exists already"
        return code
    assert text is not None, f"{path} does not exist"
    lines = text.splitlines(keepends=True)
    places = [i for i, text in enumerate(lines) if text.strip() == line.strip()]
    assert len(places) == 1, f"{path} has the line `{line}` {len(places)} times"
    start = places[0] + (how == "after")
    end = places[0] + (how != "before")
    return "".join(lines[:start]) + code + "".join(lines[end:])


def patched():
    """Every file that the recipes touch, as they leave it."""
    files = {}
    for path, how, line, code in steps((ROOT / "CONTRIBUTING.md").read_text()):
        before = files.get(path)
        if before is None and (ROOT / path).exists():
            before = (ROOT / path).read_text()
        files[path] = followed(path, before, how, line, code)
    assert files, "CONTRIBUTING.md has no recipe"
    return files


def reached():
    """Crates of the workspace that a recipe changes, and all that are built upon them."""
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    described = json.loads(subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout)
    folders, needs = {}, {}
    for package in described["packages"]:
        folders[pathlib.Path(package["manifest_path"]).parent] = package["name"]
        needs[package["name"]] = {need["name"] for need in package["dependencies"] if need["kind"] != "dev"}
    found = {ROOT: "toolroom"} | folders
    crates = {next(found[parent] for parent in (ROOT / path).parents if parent in found) for path in patched()}
    while above := {name for name, below in needs.items() if name not in crates and below & crates}:
        crates |= above
    return crates, set(needs)


def copy(folder):
    """The workspace with the recipes followed. A file that a recipe leaves alone has the time of the original, so that what was
    compiled of it there is fresh here; what has not changed since the last copy keeps its time."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    names = {name for name in listed.decode().split("\0") if name and (ROOT / name).is_file()}
    changed = patched()
    # The promises of the workspace are tested there; here the target is only what builds the program.
    changed["tests/main.rs"] = "//! Nothing.\n"
    for name in sorted(names | set(changed)):
        content = changed[name].encode() if name in changed else (ROOT / name).read_bytes()
        to = folder / name
        new = not to.exists()
        if new or to.read_bytes() != content:
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_bytes(content)
            if new and name not in changed:
                shutil.copystat(ROOT / name, to)
    for old in [path for part in ("models", "sim", "src", "analysis", "fmu") for path in (folder / part).rglob("*.rs")]:
        if old.relative_to(folder).as_posix() not in names | set(changed):
            old.unlink()


def reuse(target, crates, workspace):
    """Takes over the artefacts of third parties, and of our crates that no recipe reaches: neither depends on where the
    workspace stands. Artefacts are linked. What cargo keeps about ours is copied, for it may be written again in its place."""
    built = ROOT / "target" / "debug"
    libraries = {name.replace("-", "_"): name for name in workspace}

    def crate(file):
        """The crate of ours that an artefact belongs to; `None` for those of third parties."""
        stem = file.rsplit("-", 1)[0].removeprefix("lib")
        return stem if stem in workspace else libraries.get(stem, stem if "toolroom" in stem else None)

    def ignored(folder, files):
        top = pathlib.Path(folder).parent == built
        if not top:
            return set()
        named = [(file, crate(file)) for file in files]
        stale = {file for file, name in named if name is not None and (name in crates or name not in workspace)}
        # Tests of ours are built anew where they are run.
        return stale | {file for file in files if file.startswith(("promises", "catalogue"))}

    def take(source, to):
        path = pathlib.Path(source).relative_to(built)
        binary = path.suffix in (".rlib", ".rmeta", ".so")
        (os.link if binary or crate(path.parts[1]) is None else shutil.copy2)(source, to)

    for part in ("deps", "build", ".fingerprint"):
        if (built / part).is_dir() and not (target / "debug" / part).exists():
            shutil.copytree(built / part, target / "debug" / part, copy_function=take, ignore=ignored)


def call(program, *words):
    """Runs the program; its standard output."""
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def effect(program, folder):
    """The effect acts in a shop, is named from records made with it, and is a parameter of the exported unit."""
    listed = {entry["id"]: entry for entry in json.loads(call(program, "effects", "--json"))["effects"]}
    assert listed["coolant_friction"]["processes"] == ["turning"]
    model = ROOT / "scenarios" / "gap" / "turning.toml"
    text = model.read_text()
    tool, machine = 'parameter_set = "c45_t15k6"\n', 'process = "turning"\nrate'
    assert tool in text and machine in text
    text = text.replace(machine, 'process = "turning"\ncoolant_change = "20 h"\nrate')
    text = text.replace('horizon = "8 h"', 'horizon = "40 h"')  # twenty edges: four are too few to name an effect
    sizes = []
    for size in ("0 1/h", "0.02 1/h"):
        shop = folder / "shop.toml"
        shop.write_text(text.replace(tool, tool + f'effects = [{{ id = "coolant_friction", size = "{size}" }}]\n'))
        records = folder / f"records {size[:4].strip()}"
        call(program, "run", shop, "--seed", "2", "--replications", "1", "--records", records, "--out", folder / "run", "--force")
        answer = json.loads(call(program, "gap", "diagnose", "--model", model, "--data", records / "operations.csv", "--json"))
        sizes.append([(named["id"], named["ci90"]) for named in answer["effects"]])
        untried = {effect["id"] for effect in answer["untried"]}
        assert "coolant_friction" not in untried and "chipping" in untried, untried
    without, named = sizes
    assert without == [], f"named where nothing was hidden: {without}"
    assert [name for name, _ in named] == ["coolant_friction"], f"named: {named}"
    low, high = named[0][1]
    assert low <= 0.02 <= high, f"90 % interval of the size {low} … {high}, hidden was 0.02 1/h"
    unit = folder / "turning.fmu"
    call(program, "fmu", "export", "turning", "--fmi", "3", "--out", unit)
    description = zipfile.ZipFile(unit).read("modelDescription.xml").decode()
    assert 'name="effect.coolant_friction"' in description, "no parameter of the unit"


def process(program, folder):
    """A scenario whose machine runs the process makes parts."""
    shop = folder / "sawing.toml"
    shop.write_text(SAWING)
    call(program, "run", shop, "--out", folder / "sawn", "--format", "csv")
    figures = kpi(folder / "sawn")
    # Every part that came, and a band for every ten.
    assert figures["programmed"]["parts_per_shift"] == 40, figures
    assert figures["programmed"]["edges_per_100_parts"] == 10, figures


def policy(program, folder):
    """The policy runs beside the programmed speed, and slower, in a shop and in a study of tool lives."""
    text = (ROOT / "scenarios" / "template.toml").read_text()
    kept = text[: text.index("[[policy]]")]
    rules = '[[policy]]\nname = "{0}"\nspeed = "{0}"\n'
    shop = folder / "policies.toml"
    shop.write_text(kept + rules.format("programmed") + rules.format("eased") + 'ease = "0.5"\n')
    call(program, "compare", shop, "--replications", "2", "--out", folder / "compared", "--format", "csv")
    figures = kpi(folder / "compared")
    fast, slow = (figures[name]["mean_cutting_speed_turning"] for name in ("programmed", "eased"))
    assert 0.5 * fast < slow < 0.99 * fast, (fast, slow)
    lives = folder / "lives.toml"
    head = 'schema = 1\nname = "eased"\nlives = 20\nparameter_set = "c45_t15k6"\n'
    lives.write_text(head + rules.format("programmed") + rules.format("eased") + 'ease = "0.5"\n')
    call(program, "life", lives, "--out", folder / "lived")
    with open(folder / "lived" / "cells.csv", newline="") as file:
        path = {row["policy"]: float(row["mean path [m]"]) for row in csv.DictReader(file)}
    assert path["programmed"] != path["eased"], path
    refused = subprocess.run([program, "check", shop, "--set", "policy.eased.ease=2"], capture_output=True, text=True)
    assert refused.returncode != 0, "an ease beyond its range is accepted"


def kind(program, folder):
    """`check` and `schema` know the kind by its content."""
    bar = folder / "stock.toml"
    bar.write_text('schema = 1\nbar = "c45"\n')
    assert json.loads(call(program, "check", bar, "--json"))["kind"] == "bar"
    assert "bar" in json.loads(call(program, "schema", "bar"))["properties"]


def kpi(folder):
    """Mean of every key figure by policy."""
    sums = {}
    with open(folder / "kpi.csv", newline="") as file:
        for row in (row for row in csv.DictReader(file) if row["value"] and not row["machine"]):
            sums.setdefault(row["policy"], {}).setdefault(row["kpi"], []).append(float(row["value"]))
    return {policy: {name: sum(all) / len(all) for name, all in figures.items()} for policy, figures in sums.items()}


SAWING = """
schema = 1
[shop]
name = "saw"
replications = 1
horizon = "8 h"
shift_length = "8 h"
[[machine]]
name = "S"
process = "sawing"
rate = "40 EUR/h"
load_time = "30 s"
unload_time = "15 s"
speed_range = ["20 m/min", "120 m/min"]
[[tool]]
name = "band"
process = "sawing"
parameter_set = "band"
edge_cost = "20 EUR"
scatter = "none"
[[part]]
name = "billet"
[[part.operation]]
name = "saw"
machines = "S"
tool = "band"
cutting_speed = "60 m/min"
feed_per_tooth = "0.1 mm/tooth"
depth_of_cut = "1 mm"
width_of_cut = "50 mm"
path_length = "60 m"
size_tolerance = "500 um"
[[arrivals]]
part = "billet"
pattern = "batch"
interval = "4 h"
size = 20
[dispatch]
rule = "fifo"
[[policy]]
name = "programmed"
speed = "programmed"
tool_change = { rule = "part_count", parts = 10 }
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--words", action="store_true", help="only whether every place that a recipe names is there")
    parser.add_argument("--features", default="", help="features of the program")
    arguments = parser.parse_args()
    if arguments.words:
        print(f"{len(patched())} files are touched by the recipes, every place is there")
        return
    folder, target = ROOT / "target" / "recipes" / "workspace", ROOT / "target" / "recipes" / "target"
    if not folder.exists():
        shutil.rmtree(target, ignore_errors=True)  # times of a new copy say nothing about artefacts of an older one
    crates, workspace = reached()
    copy(folder)
    reuse(target, crates, workspace)
    features = ["--features", arguments.features] if arguments.features else []
    for crate in sorted(crates - COMPUTING):
        features += ["--config", f"profile.dev.package.{crate}.opt-level=0", "--config", f"profile.dev.package.{crate}.debug=false"]
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    begun = time.monotonic()
    # As in the workspace itself, so that the artefacts of third parties fit. The catalogue is the suite of effects.
    command = ["cargo", "test", "--workspace", *features, "--test", "promises", "--test", "catalogue"]
    built = subprocess.run(command, cwd=folder, env=environment)
    if built.returncode:
        sys.exit("the copy with the recipes followed does not compile, or fails the suite of effects")
    print(f"compiled in {time.monotonic() - begun:.0f} s")
    program = target / "debug" / "toolroom"
    for recipe in (effect, process, policy, kind):
        begun = time.monotonic()
        with tempfile.TemporaryDirectory() as scratch:
            recipe(program, pathlib.Path(scratch))
        print(f"{recipe.__name__}: {recipe.__doc__} ({time.monotonic() - begun:.0f} s)")


if __name__ == "__main__":
    main()
