"""Whole runs of the NIST box, predicted by drives, spindle and changer that were fitted on its first pieces.

    python tests/studies/box_gates.py TOOLROOM FOLDER IMPORTED [--evaluations 12]

FOLDER holds box-op1.nc to box-op5.nc; IMPORTED holds OP1/stretches.csv and so on of all pieces, as `toolroom import mtconnect --nc` writes
them. Fitted are the runs of pieces 3 and 5 of operation 1, 5 of operation 3, and 4 and 5 of operation 5 (operation 2 has no run of the
published program before piece 6, and piece 3 of operation 5 ran at an override of 105 %, with an operator who stood in it), predicted those
of pieces 6 to 10, each under its override in force. --third-piece fits that piece, too. The fit is robust least squares
(soft L1, 0.3 s) of the logarithms over stretches of 8 s and more without a hold; tool changes and the end of the program are among
them. The times are those of `toolroom program --drives hurco-winmax --set drives.…`. Needs numpy and scipy.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.optimize import least_squares

# Runs of the published programs in the order of the pieces, and those that are fitted.
RUNS = {
    1: ((3, 5, 6, 7, 9, 10), (3, 5)),
    2: ((6, 7, 8, 9, 10), ()),
    3: ((5, 6, 7, 8, 9, 10), (5,)),
    5: ((3, 4, 5, 6, 7, 8, 9, 10), (4, 5)),
}
KEYS = {
    "feed": ("inverse_acceleration", "s2/m", 1 / 0.64),
    "rapid": ("inverse_rapid_acceleration", "s2/m", 1 / 2.7),
    "corner": ("corner.value", "um", 1.0),
    "feed settling": ("settling.feed", "s", 0.356),
    "rapid settling": ("settling.rapid", "s", 0.052),
    "jerk": ("jerk_time", "ms", 0.0),
    "spindle": ("spindle.constant", "s/rpm2", 4.54e-8),
    "spindle base": ("spindle.base_speed", "rpm", 3436.0),
    "braking": ("spindle.braking.constant", "s/rpm2", 5.03e-8),
    "braking base": ("spindle.braking.base_speed", "rpm", 3868.0),
    "change": ("changer.change_time", "s", 5.93),
}
# Starts that are not the solution of anybody: round numbers of the size of such a machine.
START = {"feed": 1.0, "rapid": 0.5, "corner": 5.0, "spindle": 6e-8, "spindle base": 3000.0, "braking": 6e-8, "braking base": 3000.0, "change": 4.0}
MODELS = {
    "settling": {"feed settling": 0.2, "rapid settling": 0.1, "jerk": 0.0},
    "jerk": {"feed settling": 0.0, "rapid settling": 0.0, "jerk": 60.0},
    "jerk and settling": {"feed settling": 0.1, "rapid settling": 0.02, "jerk": 60.0},
}


def options(values, override=None):
    for (name, unit, _), value in zip(KEYS.values(), values):
        yield from ("--set", f"drives.{name}={value} {unit}")
    if override is not None:
        yield from ("--set", f"drives.feed_override={override}")


def clock(args, program, values, scratch):
    table = scratch / f"{program}.csv"
    command = [args.toolroom, "program", args.folder / f"box-op{program}.nc", "--drives", "hurco-winmax", "--blocks", table, "-q", "--force"]
    subprocess.run([*command, *options(values)], check=True, capture_output=True)
    rows = list(csv.DictReader(table.open()))
    sums = [np.r_[0.0, np.cumsum([float(row[key]) for row in rows])] for key in ("time [s]", "feed_time [s]")]
    return np.array([int(row["line"]) for row in rows]), sums


def modelled(args, rows, values, scratch):
    clocks = {program: clock(args, program, values, scratch) for program in {row[0] for row in rows}}
    times = []
    for program, first, last, _, override in rows:
        lines, sums = clocks[program]
        i, j = np.searchsorted(lines, first), np.searchsorted(lines, last, side="right")
        time, feed = (total[j] - total[i] for total in sums)
        times.append(time + feed * (1.0 / override - 1.0))
    return np.array(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("toolroom", "folder", "imported"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--evaluations", type=int, default=12, help="steps of the search")
    parser.add_argument("--models", nargs="*", default=list(MODELS), choices=list(MODELS))
    parser.add_argument("--third-piece", action="store_true", help="fit piece 3 of operation 5, too")
    args = parser.parse_args()
    args.toolroom = args.toolroom.resolve()
    fitted, predicted = [], []
    for program, (pieces, first) in RUNS.items():
        folder = args.imported / f"OP{program}"
        rows = list(csv.DictReader((folder / "stretches.csv").open()))
        whole = {row["operation_id"]: float(row["cycle_time [s]"]) for row in csv.DictReader((folder / "runs.csv").open())}
        runs = list(dict.fromkeys(row["operation_id"] for row in rows))
        assert len(runs) == len(pieces), (program, runs)
        for piece, run in zip(pieces, runs):
            own = [row for row in rows if row["operation_id"] == run]
            override = [float(row["feed_override [%]"] or 100.0) / 100.0 for row in own]
            if piece in first or args.third_piece and (program, piece) == (5, 3):
                fitted += [(program, int(row["first_block"]), int(row["last_block"]), float(row["cycle_time [s]"]), ratio)
                           for row, ratio in zip(own, override) if float(row["cycle_time [s]"]) >= 8.0 and float(row["hold_time [s]"]) == 0.0]
            elif piece >= 6:
                predicted.append((program, piece, whole[run], float(np.median(override))))
    measured = np.array([row[3] for row in fitted])
    names = list(KEYS)
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        for model in args.models:
            start = np.array([MODELS[model].get(name, START.get(name, 0.0)) for name in names])
            free = [i for i, value in enumerate(start) if value > 0.0]

            def values(x):
                found = start.copy()
                found[free] *= np.exp(x)
                return found

            def residual(x):
                return measured - modelled(args, fitted, values(x), scratch)

            # The parameter of the search has to be of order one for its relative steps: it is counted from one.
            found = least_squares(lambda x: residual(x - 1.0), np.ones(len(free)), loss="soft_l1", f_scale=0.3, diff_step=0.02, max_nfev=args.evaluations)
            best = values(found.x - 1.0)
            print(model, " ".join(f"{name} {value:.4g}" for name, value in zip(names, best)))
            print(f"  fitted: median of the absolute residual {np.median(np.abs(residual(found.x - 1.0))):.3f} s over {len(fitted)} stretches")
            by_program = {}
            for program, piece, time, override in predicted:
                command = [args.toolroom, "program", args.folder / f"box-op{program}.nc", "--drives", "hurco-winmax", "--json"]
                told = json.loads(subprocess.run([*command, *options(best, override)], check=True, capture_output=True).stdout)
                error = 100.0 * (told["cycle_time [s]"] / time - 1.0)
                by_program.setdefault(program, []).append(error)
                print(f"  OP{program} piece {piece}: override {override:.3f}, measured {time:.1f} s, computed {told['cycle_time [s]']:.1f} s, {error:+.2f} %")
            for program, errors in by_program.items():
                print(f"  OP{program}: median of the runs {np.median(errors):+.2f} %, mean {np.mean(errors):+.2f} %")


if __name__ == "__main__":
    main()
