#!/usr/bin/env python3
"""Long commands are killed at random moments and go on with --resume to the bytes of an undisturbed run.

    python3 tests/kill_resume.py target/debug/toolroom [--kills 20] [--seed 1] [--signal KILL] [--only compare …]

For each case the command runs undisturbed once. Then it is started, killed after a time drawn between zero and the time
of the undisturbed run, and started again with --resume until it ends by itself, killed a few times on the way; every file
but run.json, which tells the time, must be the same. No draft, lock or journal may be left at the end.
"""

import argparse
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent.parent / "scenarios"
CASES = {
    "compare": ["compare", HERE / "constant-vs-adaptive.toml", "--replications", "12"],
    "tune": ["compare", HERE / "constant-vs-adaptive.toml", "--replications", "8", "--tune",
             "--policy", "constant", "--policy", "productivity", "--set", "tune.budget=100"],
    "variants": ["compare", HERE / "shop/crib.toml", "--replications", "12"],
    "run": ["run", HERE / "template.toml", "--replications", "6"],
    "life": ["life", HERE / "life/policies.toml", "--lives", "4000"],
    "contour": ["contour", HERE / "contour/rk3.toml", "--draws", "60"],
    "lobes": ["lobes", HERE / "chatter/milling-slot.toml", "--set", "chart.columns=40", "--set", "chart.rows=20"],
}
KILLS_OF_A_RUN = 3


def files(folder: pathlib.Path) -> dict:
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob("*")) if path.is_file() and path.name != "run.json"}


def begin(program, case, out, resume):
    more = ["--resume"] if resume else []
    return subprocess.Popen([program, *map(str, CASES[case]), "--out", str(out), *more], cwd=HERE.parent,
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def disturbed(program, case, out, seconds, kills, number):
    """Runs a case with a kill after each of `kills`; the seconds that the last run took."""
    for kill in kills:
        process = begin(program, case, out, True)
        try:
            process.wait(kill * seconds)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        error = process.communicate()[1]
        if process.returncode == 0:
            return
        if process.returncode not in (-number, 128 + number):
            sys.exit(f"{case}: {process.returncode}\n{error}")
    process = begin(program, case, out, True)
    error = process.communicate()[1]
    if process.returncode != 0:
        sys.exit(f"{case}: --resume gave {process.returncode}\n{error}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=20, help="disturbed runs of each case")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--signal", choices=["KILL", "INT", "TERM"], default="KILL")
    parser.add_argument("--only", nargs="+", choices=list(CASES), default=list(CASES))
    arguments = parser.parse_args()
    program, draw = arguments.program.resolve(), random.Random(arguments.seed)
    number = signal.Signals[f"SIG{arguments.signal}"]
    for case in arguments.only:
        with tempfile.TemporaryDirectory() as folder:
            whole = pathlib.Path(folder) / "whole"
            start = time.monotonic()
            process = begin(program, case, whole, False)
            error = process.communicate()[1]
            if process.returncode != 0:
                sys.exit(f"{case}: {process.returncode}\n{error}")
            seconds, expected, killed = time.monotonic() - start, files(whole), 0
            while killed < arguments.kills:
                kills = [draw.random() for _ in range(min(KILLS_OF_A_RUN, arguments.kills - killed))]
                killed += len(kills)
                out = pathlib.Path(folder) / f"out-{killed}"
                disturbed(program, case, out, seconds, kills, number)
                found = files(out)
                differ = [name for name in sorted(expected.keys() | found.keys()) if expected.get(name) != found.get(name)]
                if differ:
                    sys.exit(f"{case}, killed at {kills} of {seconds:.1f} s: {', '.join(differ)} differ")
                left = [path.name for path in out.iterdir() if path.name.startswith(".")]
                if left:
                    sys.exit(f"{case}: {', '.join(left)} left behind")
            print(f"{case}: {killed} × SIG{arguments.signal} within {seconds:.1f} s, same bytes of {len(expected)} files", flush=True)


if __name__ == "__main__":
    main()
