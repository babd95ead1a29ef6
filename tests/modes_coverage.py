#!/usr/bin/env python3
"""How often the intervals of `toolroom modes update` hold the truth: simulated shops whose modes and coefficient are drawn
from what is known of them, cuts that are judged here with nothing of the program, and a twentieth of the records wrong.

    python3 tests/modes_coverage.py                      # 100 shops
    python3 tests/modes_coverage.py target/debug/toolroom --shops 20

Every third shop turns with one mode and tells no frequencies, every third turns and tells them, every third mills with two
modes. Intervals are lognormal, from the mean and the standard deviation that the program prints. Coverage of natural
frequency, damping ratio, stiffness and coefficient is printed with its standard error; the exit code is 1 where one of the
first three lies outside 85 to 95 %.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from lobes_truth import ROOT, Milled, Turned

SD = {"natural_frequency": 0.03, "damping_ratio": 0.25, "stiffness": 0.10, "coefficient": 0.15}
WRONG = 0.05  # share of wrong records, the assumption of the program
FREQUENCY = 0.01  # deviation of an observed chatter frequency from that of the limit, the same
NORMAL = 1.6449  # 90 % of a normal distribution lie within so many standard deviations


def structure(modes):
    lines = ["schema = 1", 'name = "known"', "[measurement]", 'source = "drawn"']
    for i, (x, y, f, zeta, k) in enumerate(modes):
        lines += ["[[mode]]", f'name = "m{i}"', f"direction = [{x}, {y}]",
                  f'natural_frequency = {{ value = "{f} Hz", sd = "{f * SD["natural_frequency"]} Hz" }}',
                  f'damping_ratio = {{ value = {zeta}, sd = {zeta * SD["damping_ratio"]} }}',
                  f'stiffness = {{ value = "{k} N/m", sd = "{k * SD["stiffness"]} N/m" }}']
    return "\n".join(lines) + "\n"


def lobes(milling, K):
    text = ["schema = 1", 'name = "cut"', 'title = "cut"', f'process = "{"milling" if milling else "turning"}"',
            'structure = "known.toml"']
    if milling:
        text += ["[cutter]", "teeth = 3", 'diameter = "16 mm"', "[engagement]", "immersion = 0.5", 'direction = "down"',
                 "[force]", f'tangential = "{K / 1e6} MPa"', f'radial = "{0.3 * K / 1e6} MPa"']
    else:
        text += ["[cut]", f'cutting_coefficient = "{K / 1e6} MPa"', 'diameter = "40 mm"']
    text += ["[chart]", 'spindle_speed = ["3000 rpm", "9000 rpm"]', 'depth_of_cut = ["0 mm", "3 mm"]', "columns = 40", "rows = 20"]
    return "\n".join(text) + "\n"


def limit_frequency(cut):
    """Frequency (Hz) of the least limit of turning: the neutral vibration with the least width."""
    w, loop = cut.w, cut.loop
    change = np.flatnonzero((loop.imag[1:] > 0) != (loop.imag[:-1] > 0))
    share = loop.imag[change] / (loop.imag[change] - loop.imag[change + 1])
    real = loop.real[change] + share * (loop.real[change + 1] - loop.real[change])
    least = np.argmin(real)
    return (w[change] + share * (w[change + 1] - w[change]))[least] / (2 * np.pi)


def shop(number, options, folder):
    """Whether each interval holds the truth: (constant, holds) a constant."""
    draw = np.random.default_rng([options.seed, number])
    milling, heard = number % 3 == 2, number % 3 == 1
    known = [(1, 0, 600.0, 0.03, 10e6)] + ([(0, 1, 700.0, 0.03, 12e6)] if milling else [])
    K = 8e8 if milling else 15e8
    scatter = lambda value, name: value * np.exp(SD[name] * draw.standard_normal())
    truth = [(x, y, scatter(f, "natural_frequency"), scatter(zeta, "damping_ratio"), scatter(k, "stiffness"))
             for x, y, f, zeta, k in known]
    true_K = scatter(K, "coefficient")
    base = {"modes": truth, "damping": 0.0, "D": 0.04, "K": true_K, "angle": 0.0, "Kt": true_K, "Kn": 0.3 * true_K,
            "teeth": 3, "immersion": 0.5, "up": False, "helix": 0.0, "pitch": None}
    rows = ["spindle_speed [rpm],depth_of_cut [mm],chatter,chatter_frequency [Hz]"]
    for _ in range(options.cuts):
        speed, depth = draw.uniform(3400, 8000), draw.uniform(0.3, 0.9) * (4.0 if milling else 1.0)
        frequency = 0.0
        if milling:
            chatters = Milled(base | {"D": 0.016}, speed).radius(depth * 1e-3) > 1
        else:
            cut = Turned(base, speed)
            chatters = cut.unstable(depth * 1e-3) > 0
            if chatters and heard:
                frequency = limit_frequency(cut) * (1 + FREQUENCY * draw.standard_normal())
        if draw.uniform() < WRONG:
            chatters, frequency = not chatters, 0.0
        rows.append(f"{speed},{depth},{int(chatters)},{frequency}")
    (folder / "known.toml").write_text(structure(known))
    (folder / "cut.toml").write_text(lobes(milling, K))
    (folder / "cuts.csv").write_text("\n".join(rows) + "\n")
    command = [options.program, "modes", "update", "known.toml", "--cuts", "cuts.csv", "--lobes", "cut.toml", "--out", f"new{number}.toml", "--json",
               "--coefficients", str(SD["coefficient"])]
    told = json.loads(subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout)
    held = []

    def judge(name, entry, value):
        spread = NORMAL * np.sqrt(np.log1p((entry["sd"] / entry["value"]) ** 2))
        middle = np.log(entry["value"]) - 0.5 * np.log1p((entry["sd"] / entry["value"]) ** 2)
        held.append((name, abs(np.log(value) - middle) <= spread))

    for mode, (_, _, f, zeta, k) in zip(told["modes"], truth):
        judge("natural_frequency", mode["natural_frequency [Hz]"], f)
        judge("damping_ratio", mode["damping_ratio"], zeta)
        judge("stiffness", mode["stiffness [N/um]"], k / 1e6)
    judge("coefficient", told["coefficient_factor"], true_K / K)
    return held


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shops", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="number of the first shop")
    parser.add_argument("--cuts", type=int, default=12, help="cuts of each shop")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("program", nargs="?", default=str(ROOT / "target/release/toolroom"))
    options = parser.parse_args()
    counts = {}
    with tempfile.TemporaryDirectory(prefix="modes-coverage-") as folder:
        for number in range(options.first, options.first + options.shops):
            for name, holds in shop(number, options, pathlib.Path(folder)):
                count = counts.setdefault(name, [0, 0])
                count[0] += 1
                count[1] += holds
    outside = False
    for name, (count, holds) in counts.items():
        share = holds / count
        outside |= name != "coefficient" and not 0.85 <= share <= 0.95
        print(f"{name}: {holds} of {count} intervals of 90 % hold the truth, {share:.1%} ± {np.sqrt(share * (1 - share) / count):.1%}", flush=True)
    return int(outside)


if __name__ == "__main__":
    sys.exit(main())
