"""Drives of the NIST box by robust least squares over its timed stretches: what jerk and settling explain of them.

    python tests/studies/box_drives.py TOOLROOM FOLDER FITTED HELD_OUT [--evaluations 14]

FOLDER holds box-op1.nc to box-op5.nc, FITTED and HELD_OUT hold OP1/stretches.csv and so on, as `toolroom import mtconnect --nc` writes
them. Stretches with a tool change, a hole or a hold are left out, in the fit those below 8 s, too. The times are those of
`toolroom program --drives hurco-winmax --set drives.…`; nothing else of toolroom takes part. Needs numpy and scipy.
"""

import argparse
import csv
import pathlib
import subprocess
import tempfile

import numpy as np
from scipy.optimize import least_squares

PROGRAMS = (1, 2, 3, 5)
KEYS = {
    "feed": ("inverse_acceleration", "s2/m"),
    "rapid": ("inverse_rapid_acceleration", "s2/m"),
    "corner": ("corner.value", "um"),
    "jerk": ("jerk_time", "ms"),
    "feed settling": ("settling.feed", "s"),
    "rapid settling": ("settling.rapid", "s"),
}
MODELS = {
    "preset": ((), [1 / 0.64, 1 / 2.7, 1.0, 0.0, 0.356, 0.052]),
    "settling, no jerk": (("feed", "rapid", "corner", "feed settling", "rapid settling"), [1.5, 0.35, 1.0, 0.0, 0.3, 0.07]),
    "jerk, no settling": (("feed", "rapid", "corner", "jerk"), [0.93, 0.41, 1.0, 120.0, 0.0, 0.0]),
    "jerk and settling": (tuple(KEYS), [0.93, 0.41, 1.0, 120.0, 0.02, 0.01]),
}


def stretches(folder):
    for program in PROGRAMS:
        path = pathlib.Path(folder) / f"OP{program}" / "stretches.csv"
        if path.exists():
            for row in csv.DictReader(path.open()):
                yield (program, *(int(row[key]) for key in ("first_block", "last_block")), float(row["cycle_time [s]"]),
                       float(row["feed_override [%]"]) / 100.0, float(row["hold_time [s]"]))


def clock(tool, program, values, scratch):
    table = scratch / f"{program}.csv"
    command = [tool, "program", program, "--drives", "hurco-winmax", "--blocks", table, "-q", "--force"]
    for (name, unit), value in zip(KEYS.values(), values):
        command += ["--set", f"drives.{name}={value} {unit}"]
    subprocess.run(command, check=True, capture_output=True)
    rows = list(csv.DictReader(table.open()))
    sums = [np.r_[0.0, np.cumsum([float(row[key]) for row in rows])] for key in ("time [s]", "feed_time [s]", "tool_change", "holes")]
    return np.array([int(row["line"]) for row in rows]), sums


def modelled(args, rows, values, scratch):
    """Times of the stretches, s, and whether they hold motions alone."""
    clocks = {p: clock(args.toolroom, str(pathlib.Path(args.folder) / f"box-op{p}.nc"), values, scratch) for p in PROGRAMS}
    times, plain = [], []
    for program, first, last, _, override, hold in rows:
        lines, sums = clocks[program]
        i, j = np.searchsorted(lines, first), np.searchsorted(lines, last, side="right")
        time, feed, changes, holes = (total[j] - total[i] for total in sums)
        times.append(time + feed * (1.0 / override - 1.0))
        plain.append(changes == 0 and holes == 0 and hold == 0.0)
    return np.array(times), np.array(plain)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("toolroom", "folder", "fitted", "held_out"):
        parser.add_argument(name)
    parser.add_argument("--evaluations", type=int, default=14, help="steps of the search")
    args = parser.parse_args()
    args.toolroom = str(pathlib.Path(args.toolroom).resolve())
    groups = [list(stretches(args.fitted)), list(stretches(args.held_out))]
    measured = [np.array([row[3] for row in rows]) for rows in groups]
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        for name, (free, start) in MODELS.items():
            index = [list(KEYS).index(key) for key in free]

            def values(x):
                found = np.array(start)
                found[index] *= np.exp(x - 1.0)
                return found

            if free:
                _, plain = modelled(args, groups[0], start, scratch)
                use = plain & (measured[0] >= 8.0)

                def residual(x):
                    return (measured[0] - modelled(args, groups[0], values(x), scratch)[0])[use]

                found = least_squares(residual, np.ones(len(free)), loss="soft_l1", f_scale=0.3, diff_step=0.02, max_nfev=args.evaluations)
                spread = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)) * 2.0 * found.cost / (use.sum() - len(free)))
                best = values(found.x)
            else:
                best, spread = np.array(start), []
            print(name, " ".join(f"{key} {value:.4g}" for key, value in zip(KEYS, best)))
            print("  standard deviations of logarithms:", " ".join(f"{key} {sd:.2f}" for key, sd in zip(free, spread)))
            for word, rows, times in zip(("fitted", "held out"), groups, measured):
                model, plain = modelled(args, rows, best, scratch)
                print(f"  {word}: rms {np.sqrt(np.mean((times - model)[plain] ** 2)):.3f} s over {plain.sum()} stretches")


if __name__ == "__main__":
    main()
