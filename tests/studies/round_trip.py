"""How often a calibration on what a shop records holds the parameters that the shop was simulated with.

    python tests/studies/round_trip.py PROGRAM [--seeds 20] [--diagnose 1]

A shop of three lathes, each at a speed and feed of its own, reads wear after every pass and changes edges near the limit. Its
records (`run --records`) are calibrated from the shipped set, whose values are others, and the truth is looked for in the 90 % region
of the draws: the ellipsoid of their mean and covariance in working coordinates, with the correlations that the program tells (those
above 0.6). Of the first seeds the records are diagnosed with the shop itself as the nominal model, and new records of the same shop
(seed + 100) with the shop on the calibrated set: in neither is a gap to be found.
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile

import numpy as np

# The set with which the shop is simulated, and the limits of the working coordinates.
LIFE, SPEED, FEED, DEPTH, CONTRAST, SCATTER = 67.9, 4.63, 1.11, 0.75, 0.69, 0.16
TRUTH = {
    "extended_taylor.reference_life": math.log(LIFE),
    "extended_taylor.speed_exponent": math.log(SPEED),
    "extended_taylor.feed_exponent": FEED,
    "extended_taylor.depth_exponent": DEPTH,
    "extended_taylor.stage_contrast": math.log(CONTRAST / (0.95 - CONTRAST)),
    "edge_scatter": math.log(SCATTER),
}
CHANNELS = ["cutting_force", "feed_force", "spindle_power", "temperature", "thermo_emf", "cycle_time"]  # that are left out
CHI_SQUARE = 10.6446  # 90 % point of six degrees of freedom
SET = f"""schema = 1
name = "truth"
title = "what the shop is simulated with"
process = "turning"
based_on = "c45_t15k6"
law = "extended_taylor"
[parameters.extended_taylor]
reference_life = {{ value = "{LIFE} min", source = "truth" }}
speed_exponent = {{ value = {SPEED}, source = "truth" }}
feed_exponent = {{ value = {FEED}, source = "truth" }}
depth_exponent = {{ value = {DEPTH}, source = "truth" }}
hardness_exponent = {{ value = 1.0, source = "truth" }}
stage_contrast = {{ value = {CONTRAST}, source = "truth" }}
stage_tilt = {{ value = 0.0, source = "truth" }}
wear_limit = {{ value = "0.3 mm", source = "truth" }}
reference_speed = {{ value = "180 m/min", source = "truth" }}
reference_feed = {{ value = "0.3 mm/rev", source = "truth" }}
reference_depth = {{ value = "1.5 mm", source = "truth" }}
[parameters.limits]
wear_limit = {{ value = "0.3 mm", source = "truth" }}
[scatter]
common_wear = {SCATTER}
mechanical_wear = 0.0
thermal_wear = 0.0
batch_hardness = 0.0
piece_hardness = 0.0
allowance = "0 mm"
life_noise = 0.0
chipped_share = 0.0
"""
HEAD = """schema = 1
[shop]
name = "round-trip"
replications = 1
horizon = "30 h"
[[tool]]
name = "insert"
process = "turning"
parameter_set = "truth.toml"
edge_cost = "2.5 EUR"
[[policy]]
name = "programmed"
speed = "programmed"
tool_change = { rule = "wear_limit", limit = "0.27 mm" }
"""
LATHE = """[[machine]]
name = "L{0}"
process = "turning"
rate = "60 EUR/h"
load_time = "10 s"
unload_time = "10 s"
tool_change_time = "1 min"
speed_range = ["60 m/min", "400 m/min"]
[[part]]
name = "part {0}"
[[part.operation]]
name = "turn"
machines = "L{0}"
tool = "insert"
passes = {1}
cutting_speed = "{2} m/min"
feed_per_rev = "{3} mm/rev"
depth_of_cut = "1.5 mm"
diameter = "120 mm"
length = "400 mm"
size_tolerance = "500 um"
[[arrivals]]
part = "part {0}"
pattern = "constant_work"
jobs = 1
"""
SHOP = HEAD + "".join(LATHE.format(*each) for each in [(1, 2, 180, 0.2), (2, 2, 220, 0.3), (3, 1, 280, 0.3)])


def call(folder, words):
    done = subprocess.run(words, capture_output=True, text=True, cwd=folder)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return done.stdout


def distance(found):
    """Squared distance of the truth from the middle of the draws, in their covariance; intervals that hold it."""
    told = {each["name"]: each["coordinate"] for each in found["parameters"]}
    names = list(TRUTH)
    off = np.array([(TRUTH[name] - told[name]["mean"]) / told[name]["sd"] for name in names])
    correlation = np.eye(len(names))
    for first, second, value in found["correlations"]:
        if first in names and second in names:
            i, j = names.index(first), names.index(second)
            correlation[i, j] = correlation[j, i] = value
    held = [told[name]["ci90"][0] <= TRUTH[name] <= told[name]["ci90"][1] for name in names]
    return float(off @ np.linalg.solve(correlation, off)), held


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--diagnose", type=int, default=0, help="seeds whose records are diagnosed as well")
    args = parser.parse_args()
    program = str(pathlib.Path(args.program).resolve())
    inside, intervals = 0, []
    for seed in range(1, args.seeds + 1):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "truth.toml").write_text(SET)
            pathlib.Path(folder, "shop.toml").write_text(SHOP)
            call(folder, [program, "run", "shop.toml", "--seed", str(seed), "--records", "records", "--out", "out"])
            # Wear alone: forces are another fit.
            data = pathlib.Path(folder, "records/operations.csv")
            rows = [line.split(",") for line in data.read_text().splitlines()]
            kept = [place for place, title in enumerate(rows[0]) if title.split(" ")[0] not in CHANNELS]
            pathlib.Path(folder, "wear.csv").write_text("".join(",".join(row[i] for i in kept) + "\n" for row in rows))
            words = ["calibrate", "turning", "--model", "c45_t15k6", "--limit", "0.3 mm", "--law", "extended_taylor", "--data",
                     "wear.csv", "--draws", "1000", "--seed", str(seed), "--json", "--out", "my.toml"]
            square, held = distance(json.loads(call(folder, [program, *words])))
            inside += square <= CHI_SQUARE
            intervals += held
            print(f"seed {seed}: chi square {square:.1f} of {len(TRUTH)}, {sum(held)} of {len(held)} intervals hold", flush=True)
            if seed <= args.diagnose:
                pathlib.Path(folder, "calibrated.toml").write_text(SHOP.replace('"truth.toml"', '"./my.toml"'))
                call(folder, [program, "run", "shop.toml", "--seed", str(seed + 100), "--records", "new", "--out", "later"])
                for model, records in [("shop.toml", "records"), ("calibrated.toml", "new")]:
                    words = ["gap", "diagnose", "--model", model, "--data", records, "--json", "--out", f"gap-{records}"]
                    found = json.loads(call(folder, [program, *words]))
                    parts = ", ".join(f"{part['what']} {part['test']} {part['p']:.3f}" for part in found["fit"]["parts"][:3])
                    print(f"  {model}: {found['verdict']}, p = {found['fit']['p']:.3f} ({parts})", flush=True)
    print(f"the truth lies in the 90 % region in {inside} of {args.seeds}; {sum(intervals)} of {len(intervals)} intervals hold it")


if __name__ == "__main__":
    main()
