"""How often intervals of `toolroom calibrate` hold the truth, and how often its choice of a law is right.

    python tests/studies/calibration.py PROGRAM coverage extended_taylor [--sets 100] [--edges 12] [--spread 1] [--wandering]
    python tests/studies/calibration.py PROGRAM choice [--sets 40] [--speeds 1]
    python tests/studies/calibration.py PROGRAM force [--sets 100] [--exact] [--mean]

Tables of wear are made here, by equations that share no code with the program: each law is integrated over the land, edges
scatter, readings have an error, and with `--wandering` the wear rate wanders within lives. The program is what a user calls:
a CSV goes in, JSON comes out. `examples/gates.rs` of toolroom-calibrate counts the same by the library.

Truths are drawn around the mean of the prior, `--spread` of its standard deviations. With 1 they are drawn from the prior itself,
and a right inference holds the truth in 90 % of its 90 % intervals whatever the data tell (simulation-based calibration: S. Talts
and others, arXiv 1804.06788). `force` has a cutting force beside every reading of wear, `F = C·a·f^y·v^n·k + τ·b·h`, with truths of all
its parameters from their priors; with `--exact` wear is read almost without error, so that only the forces leave anything open, and
with `--mean` the force is the mean over the cut before the reading, as `run --records` writes it. Needs NumPy.
"""

import argparse
import collections
import concurrent.futures
import json
import math
import pathlib
import subprocess
import tempfile

import numpy as np

# Set c45_t15k6: contact temperature and land (scenarios/parameters/turning/c45_t15k6.toml), in m/min, mm, K.
AMBIENT, CHIP, SPEED, FEED, DEPTH, FLANK, OFFSET = 293.15, 92.0, 0.4, 0.24, 0.1, 18.0, 0.02
REFERENCE_T, RUN_IN, RUN_IN_OFFSET, HEATED, PLATEAU, GAS = 1140.8, 0.08, 0.02, 1.0, 4.0, 8.314462618e-3
REFERENCE = (180.0, 0.3, 1.5)
LIMIT = 0.3  # mm
CORRELATION = 5.0  # min, of a rate that wanders

# Working coordinates of each law: name, mean and standard deviation of the prior; ln of positive values, logit of the contrast.
EDGES = [("edge_scatter", math.log(0.20), 0.6), ("reading_noise", math.log(0.011), 0.5)]
PRIORS = {
    "extended_taylor": [
        ("extended_taylor.reference_life", math.log(60.0), 0.7),
        ("extended_taylor.speed_exponent", math.log(5.0), 0.3),
        ("extended_taylor.feed_exponent", 1.5, 0.6),
        ("extended_taylor.depth_exponent", 0.75, 0.3),
        ("extended_taylor.stage_contrast", math.log(0.6 / 0.35), 1.0),
    ],
    "energy_balance": [
        ("energy_balance.mechanical_wear_per_path", math.log(0.0143), 0.7),
        ("energy_balance.thermal_wear_rate", math.log(1.2981), 0.7),
        ("energy_balance.mechanical_activation_energy", math.log(102.9), 0.25),
        ("energy_balance.thermal_activation_energy", math.log(231.6), 0.25),
    ],
    "takeyama_murata": [
        ("takeyama_murata.abrasive_wear", math.log(0.0143), 0.7),
        ("takeyama_murata.diffusion_wear_at_reference", math.log(1.2981), 0.7),
        ("takeyama_murata.activation_energy", math.log(231.6), 0.25),
    ],
    "usui": [("usui.wear_at_reference", math.log(0.02002), 0.7), ("usui.activation_temperature", math.log(21950.0), 0.25)],
}
# Those of cutting forces: N, exponents, MPa, scatter of edges and relative error of a reading.
FORCE = [
    ("force.specific_force", math.log(3000.0), 0.3),
    ("force.feed_exponent", 0.75, 0.1),
    ("force.speed_exponent", -0.15, 0.1),
    ("force.flank_shear_stress", math.log(250.0), 0.5),
    ("force_scatter", math.log(0.02), 0.5),
    ("force_noise", math.log(0.02), 0.5),
]
CUTTING_EDGE_ANGLE = math.radians(45.0)
# The land from a new edge to far beyond the limit, mm: finer where the edge runs in.
LAND = 2.0 * (np.arange(2001) / 2000.0) ** 2


def rate(law, u, cut, land):
    """Wear rate at a land, mm/min."""
    speed, feed, depth = cut
    if law == "extended_taylor":
        life = math.exp(u[0]) * (speed / REFERENCE[0]) ** -math.exp(u[1]) * (feed / REFERENCE[1]) ** -u[2]
        life *= (depth / REFERENCE[2]) ** -u[3]
        contrast = 0.95 / (1.0 + math.exp(-u[4]))
        x = np.minimum(land / LIMIT, 1.0)
        # The share of the life that a step of the land takes is the reciprocal of the rate.
        return LIMIT / (life * (1.0 + contrast * (6.0 * x * (1.0 - x) - 1.0)))
    heat = CHIP * speed**SPEED * (feed / REFERENCE[1]) ** FEED * (depth / REFERENCE[2]) ** DEPTH
    theta = AMBIENT + heat + FLANK * np.sqrt(speed * (land + OFFSET))
    cold = 1.0 / theta - 1.0 / REFERENCE_T
    run_in = 1.0 + RUN_IN / (land + RUN_IN_OFFSET)
    if law == "energy_balance":
        mechanical, thermal, energy_m, energy_t = (math.exp(value) for value in u[:4])
        phi = 1.0 / (1.0 / PLATEAU + (1.0 - 1.0 / PLATEAU) * np.exp(-energy_m / GAS * cold))
        wear = speed * mechanical * run_in * phi + thermal * (1.0 + (land / HEATED) ** 2) * np.exp(-energy_t / GAS * cold)
    elif law == "takeyama_murata":
        abrasive, diffusion, energy = (math.exp(value) for value in u[:3])
        wear = abrasive * run_in * speed + diffusion * np.exp(-energy / GAS * cold)
    else:
        wear = math.exp(u[0]) * run_in * speed * np.exp(-math.exp(u[1]) * cold)
    return 1e-3 * wear


def clock(law, u, cut):
    """Time at which an edge of median level has each land, min: Simpson's rule between the nodes."""
    middle = 0.5 * (LAND[1:] + LAND[:-1])
    slow = [1.0 / rate(law, u, cut, land) for land in (LAND[:-1], middle, LAND[1:])]
    return np.concatenate([[0.0], np.cumsum(np.diff(LAND) * (slow[0] + 4.0 * slow[1] + slow[2]) / 6.0)])


def life(law, u, cut):
    return float(np.interp(LIMIT, LAND, clock(law, u, cut)))


def draw(law, spread, random, known):
    """A truth of which lives at 180 and 320 m/min are those of an edge."""
    priors = PRIORS[law] + EDGES
    while True:
        u = [mean + spread * deviation * random.standard_normal() for _, mean, deviation in priors]
        if known:
            u[-2:] = [math.log(value) for value in known]
        if all(0.5 < life(law, u, (speed, 0.3, 1.5)) < 2000.0 for speed in (180.0, 320.0)):
            return {name: value for (name, _, _), value in zip(priors, u)}, u


def cutting_force(u, cut, land, level):
    """Force of an edge of a level, N, without the error of its reading."""
    speed, feed, depth = cut
    sharp = math.exp(u[0]) * depth * feed ** u[1] * speed ** u[2]
    return sharp * level + math.exp(u[3]) * depth / math.sin(CUTTING_EDGE_ANGLE) * land


def table(law, u, edges, speeds, random, wander, readings=10, stop="reading", force=None, mean=False):
    """Records of edges that are read until they are worn out, so many readings in a life of an hour at most. They are worn out by
    what was read (`reading`), as in a shop, or by their true wear, which nobody sees (`truth`). With coordinates of a `force` that is
    read as well, from a stream of its own."""
    rows = ["operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],"
            "cutting_time [min],flank_wear [mm],edge_end" + (",cutting_force [N]" if force else "")]
    forces = np.random.default_rng(random.bit_generator.seed_seq.spawn(1)[0])
    scatter, noise = math.exp(u[-2]), math.exp(u[-1])
    number = 0
    for edge in range(edges):
        cut = (speeds[edge * len(speeds) // edges], (0.2, 0.3)[edge % 2], 1.5)
        times = clock(law, u, cut)
        step = min(1.05 * float(np.interp(LIMIT, LAND, times)), 60.0) / readings
        level = math.exp(scatter * random.standard_normal())
        lived, z = 0.0, random.standard_normal()
        loaded = math.exp(math.exp(force[4]) * forces.standard_normal()) if force else 1.0
        for reading in range(readings):
            # The wandering rate, in pieces of a twentieth of the step.
            before = []
            for _ in range(20):
                piece = step / 20.0
                before.append(float(np.interp(level * (lived + 0.5 * piece), times, LAND)))
                lived += piece * (1.0 + wander * z)
                decay = math.exp(-piece / CORRELATION)
                z = decay * z + math.sqrt(1.0 - decay**2) * random.standard_normal()
            land = float(np.interp(level * lived, times, LAND))
            wear = land + noise * random.standard_normal()
            if wear > 1.0:
                break  # of an edge that has collapsed nothing is left to read
            number += 1
            worn = (wear if stop == "reading" else land) >= LIMIT
            end = "worn" if worn else "stopped" if reading + 1 == readings else ""
            row = f"O{number},L1,E{edge:02},{reading + 1},{cut[0]},{cut[1]},{cut[2]},{step:.6g},{wear:.6g},{end}"
            if force:
                read = 1.0 + math.exp(force[5]) * forces.standard_normal()
                seen = float(np.mean(before)) if mean else land
                row += f",{cutting_force(force, cut, seen, loaded) * read:.6g}"
            rows.append(row)
            if worn:
                break
    return "\n".join(rows) + "\n"


def calibrate(program, text, seed, more):
    """What the program says of a table; None where it refuses it."""
    with tempfile.TemporaryDirectory() as folder:
        data, out = pathlib.Path(folder, "wear.csv"), pathlib.Path(folder, "my.toml")
        data.write_text(text)
        words = [program, "calibrate", "turning", "--model", "c45_t15k6", "--data", str(data), "--limit", f"{LIMIT} mm",
                 "--seed", str(seed), "--out", str(out), "--json", *more]
        done = subprocess.run(words, capture_output=True, text=True)
        return json.loads(done.stdout) if done.returncode == 0 else print(done.stderr[-400:])


def pieces(args, one):
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        return [found for found in pool.map(one, range(args.sets)) if found is not None]


def share(part, whole):
    error = 100.0 * math.sqrt(max(part * (whole - part), 1) / whole**3) if whole else float("nan")
    return f"{100.0 * part / max(whole, 1):5.1f} % ± {error:.1f} ({part} of {whole})"


def coverage(args):
    low = collections.Counter()  # truths below their intervals

    def one(number):
        random = np.random.default_rng([2026, number])
        truth, u = draw(args.law, args.spread, random, None)
        text = table(args.law, u, args.edges, args.speeds, random, 0.10 if args.wandering else 0.0, args.readings,
                     args.stop)
        more = ["--law", args.law, "--draws", "1000"] + (["--life-noise"] if args.wandering and not args.blind else [])
        found = calibrate(args.program, text, number + 1, more)
        if found is None:
            return None
        intervals = {each["name"]: each["coordinate"]["ci90"] for each in found["parameters"]}
        held = {name: intervals[name][0] <= value <= intervals[name][1] for name, value in truth.items()}
        low.update(name for name, value in truth.items() if value < intervals[name][0])
        return held, found["coverage"]["inside90"], found["sampling"]

    found = pieces(args, one)
    held = collections.Counter(name for each, _, _ in found for name, inside in each.items() if inside)
    total = sum(held.values())
    told = [name for name in PRIORS[args.law] + EDGES]
    print(f"{args.law}, {args.edges} edges, {len(found)} of {args.sets} sets, spread {args.spread:g}: "
          f"{share(total, len(found) * len(told))}")
    for name, _, _ in told:
        print(f"  {name:48} {share(held[name], len(found))}, below {low[name]}, above {len(found) - held[name] - low[name]}")
    left_out = [inside for _, inside, _ in found if inside is not None]
    print(f"  readings of edges left out within their 90 % bands: {100.0 * np.mean(left_out):.1f} %")
    methods = collections.Counter(sampling["method"] for _, _, sampling in found)
    print(f"  sampling: {dict(methods)}")


def force(args):
    low = collections.Counter()  # truths below their intervals

    def one(number):
        random = np.random.default_rng([2028, number])
        _, u = draw(args.law, args.spread, random, (0.15, 0.0005) if args.exact else None)
        truth = [mean + args.spread * deviation * random.standard_normal() for _, mean, deviation in FORCE]
        text = table(args.law, u, args.edges, args.speeds, random, 0.0, args.readings, args.stop, truth, args.mean)
        found = calibrate(args.program, text, number + 1, ["--law", args.law, "--draws", "1000"])
        if found is None or found["force"] is None:
            return None
        intervals = {each["name"]: each["coordinate"]["ci90"] for each in found["force"]["parameters"]}
        held = {name: intervals[name][0] <= value <= intervals[name][1] for (name, *_), value in zip(FORCE, truth)}
        low.update(name for (name, *_), value in zip(FORCE, truth) if value < intervals[name][0])
        return held

    found = pieces(args, one)
    print(f"cutting force beside {args.law}, {len(found)} of {args.sets} sets: "
          f"{share(sum(sum(held.values()) for held in found), len(found) * len(FORCE))}")
    for name, *_ in FORCE:
        inside = sum(held[name] for held in found)
        print(f"  {name:48} {share(inside, len(found))}, below {low[name]}, above {len(found) - inside - low[name]}")


def choice(args):
    laws = list(PRIORS)

    def one(number):
        law = laws[number % len(laws)]
        random = np.random.default_rng([2027, number])
        _, u = draw(law, 0.5, random, (0.15, 0.010))
        text = table(law, u, args.edges, args.speeds, random, 0.0)
        found = calibrate(args.program, text, number + 1, ["--draws", "400"])
        return None if found is None else (law, found["choice"]["verdict"], found["law"], found["choice"].get("class"))

    found = pieces(args, one)
    chosen = [(law, picked) for law, verdict, picked, _ in found if verdict == "chosen"]
    right = sum(law == picked for law, picked in chosen)
    print(f"{len(args.speeds)} speed(s), {len(found)} sets: {len(chosen)} chosen, of them right {share(right, len(chosen))}; "
          f"wrong of all {share(len(chosen) - right, len(found))}; cannot tell {len(found) - len(chosen)}")
    for law, verdict, picked, candidates in found:
        if verdict != "chosen" or law != picked:
            print(f"  truth {law}: {verdict} {picked} {candidates}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("study", choices=["coverage", "choice", "force"])
    parser.add_argument("law", nargs="?", default="extended_taylor", choices=list(PRIORS))
    parser.add_argument("--sets", type=int, default=40)
    parser.add_argument("--edges", type=int, default=12)
    parser.add_argument("--speeds", type=int, default=4, choices=[1, 4], help="cutting speeds of the design")
    parser.add_argument("--spread", type=float, default=1.0, help="standard deviations of the prior around which truths lie")
    parser.add_argument("--readings", type=int, default=10, help="readings in the life of an edge of median level")
    parser.add_argument("--stop", choices=["reading", "truth"], default="reading", help="what wears an edge out")
    parser.add_argument("--wandering", action="store_true", help="wear rates wander within lives by 10 %% in 5 min")
    parser.add_argument("--exact", action="store_true", help="wear beside forces is read almost without error")
    parser.add_argument("--mean", action="store_true", help="forces are means over the cut before each reading")
    parser.add_argument("--blind", action="store_true", help="the program is not told that rates wander")
    parser.add_argument("--jobs", type=int, default=1)
    args = parser.parse_args()
    args.speeds = [180.0, 220.0, 260.0, 320.0] if args.speeds == 4 else [220.0]
    {"coverage": coverage, "choice": choice, "force": force}[args.study](args)


if __name__ == "__main__":
    main()
