#!/usr/bin/env python3
"""Prints one digest a run of twelve scenario, study and gap runs, to compare two builds of toolroom byte by byte.

    python3 tests/digests.py target/release/toolroom > before.txt     # then change the code
    python3 tests/digests.py target/release/toolroom | diff before.txt -

What names the time taken (`run.json`) and the paths of this run are left out of the digests.
"""

import hashlib
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RUNS = {
    "demo": ["demo", "--replications", "4"],
    "compare constant-vs-adaptive": ["compare", "scenarios/constant-vs-adaptive.toml", "--replications", "4", "--format", "csv"],
    "compare chatter-policies": ["compare", "scenarios/chatter-policies.toml", "--replications", "2", "--format", "csv"],
    "compare grinding-policies": ["compare", "scenarios/grinding-policies.toml", "--replications", "4", "--format", "csv"],
    "run contour-milling": ["run", "scenarios/contour-milling.toml", "--replications", "2", "--format", "csv"],
    "run adverse": ["run", "scenarios/adverse.toml", "--replications", "4", "--format", "csv"],
    "life policies": ["life", "scenarios/life/policies.toml", "--lives", "400"],
    "life taylor-grid": ["life", "scenarios/life/taylor-grid.toml", "--lives", "400"],
    "lobes milling-slot": ["lobes", "scenarios/chatter/milling-slot.toml"],
    "contour rk3": ["contour", "scenarios/contour/rk3.toml"],
    "gap turning": None,
    "gap grinding": None,
}


def call(program, *words):
    """Runs the program in the project's folder; its standard output."""
    done = subprocess.run([program, *words], cwd=ROOT, capture_output=True)
    if done.returncode:
        sys.exit(f"{' '.join(words)}: exit {done.returncode}\n{done.stderr.decode()}")
    return done.stdout


def digest(folder, texts):
    """The hash of all files below a folder but run.json, and of texts, without the folder's own name."""
    total = hashlib.sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != "run.json":
            total.update(path.relative_to(folder).as_posix().encode() + b"\0")
            total.update(path.read_bytes().replace(str(folder).encode(), b"OUT"))
    for text in texts:
        total.update(text.replace(str(folder).encode(), b"OUT"))
    return total.hexdigest()[:16]


def gap(program, process, folder):
    """Records of a shop with a deviation that its model does not know, and what the diagnosis says of them."""
    model = f"scenarios/gap/{process}.toml"
    call(program, "run", model, "--seed", "2", "--replications", "1", "--records", str(folder / "records"), "--out", str(folder / "out"))
    table = {"turning": "operations", "grinding": "trials"}[process]
    data = str(folder / "records" / f"{table}.csv")
    return [call(program, "gap", "diagnose", "--model", model, "--data", data, "--json")]


def main():
    """One line a run."""
    program = str(pathlib.Path(sys.argv[1]).resolve())
    for name, words in RUNS.items():
        with tempfile.TemporaryDirectory() as temporary:
            folder = pathlib.Path(temporary)
            if words is None:
                texts = gap(program, name.split()[1], folder)
            else:
                call(program, *words, "--out", str(folder / "out"), "--quiet")
                texts = []
            print(f"{digest(folder, texts)}  {name}", flush=True)


if __name__ == "__main__":
    main()
