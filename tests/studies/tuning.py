"""How near the settings that `toolroom compare --tune` finds come to the best ones of a scan.

    python tests/studies/tuning.py PROGRAM scenarios/demo.toml "best cost" [--seeds 10] [--budget 600] [--replications 100]
        [--set KEY=VALUE …]

Every seed of the tuning finds settings for one policy. All of them, and the settings of a scan around them, are judged on the same
random numbers, which are others than those of the tuning and of the file. The scan runs a grid a few times, then the better ones as
often as the judged ones; the least of them is the optimum. It is the least of several noisy means, and therefore a little too good:
the loss of the tuned settings is stated a little too large. `examples/tuning.rs` of toolroom-study does the same by the library.
"""

import argparse
import csv
import itertools
import json
import math
import pathlib
import re
import statistics
import subprocess
import tempfile

JUDGING = 2002
FIRST = 1001
STEPS = 5  # of each setting of the scan
FINAL = 5  # settings of it that are judged as often as the tuned ones
SPREAD = 0.08  # by which the scan goes beyond the tuned settings, relative


def call(program, words):
    done = subprocess.run([program, *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return done.stdout


def tuned(args, seed, others):
    """Settings that one tuning finds, and its changes of the file. The others are neither tuned nor run often."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["compare", args.scenario, "--tune", "--json", "--policy", args.policy, "--replications", "2", "--out",
                 f"{folder}/out", "--threads", str(args.threads), "--set", f"tune.seed={seed}", "--set",
                 f"tune.budget={args.budget}"]
        words += [word for name in others for word in ("--set", f'policy."{name}".tune=false')]
        words += [word for change in args.set for word in ("--set", change)]
        found = json.loads(call(args.program, words))["tuning"]
    return next(rule for rule in found if rule["policy"] == args.policy)


def judged(args, changes, replications):
    """Cost of a part in every replication."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["run", args.scenario, "--policy", args.policy, "--seed", str(JUDGING), "--replications", str(replications),
                 "--out", f"{folder}/out", "--threads", str(args.threads)]
        words += [word for change in [*args.set, *changes] for word in ("--set", change)]
        call(args.program, words)
        with open(f"{folder}/out/kpi.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    wanted = [row for row in rows if row["policy"] == args.policy and row["kpi"] == "cost_per_part" and not row["machine"]]
    return [float(row["value"]) for row in sorted(wanted, key=lambda row: int(row["replication"]))]


def scan(args, rules):
    """Changes of the file for a grid around the tuned settings."""
    number = re.compile(r"([0-9.eE+-]+)( .*)?")
    lists = []
    for key in rules[0]["settings"]:
        values = [number.fullmatch(rule["settings"][key]) for rule in rules]
        low, high = (pick(float(value[1]) for value in values) for pick in (min, max))
        low, high, unit = low * (1 - SPREAD), high * (1 + SPREAD), values[0][2] or ""
        # The change of a tuned rule with another number in it.
        change = next(change for change in rules[0]["set"] if rules[0]["settings"][key] in change)
        shown = rules[0]["settings"][key]
        steps = [f"{low * (high / low) ** (step / (STEPS - 1)):.4g}{unit}" for step in range(STEPS)]
        lists.append([change.replace(shown, step) for step in steps])
    return [list(changes) for changes in itertools.product(*lists)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scenario")
    parser.add_argument("policy")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--budget", type=int, default=600)
    parser.add_argument("--replications", type=int, default=100)
    parser.add_argument("--scanned", type=int, default=16, help="replications of every setting of the scan")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--set", action="append", default=[])
    args = parser.parse_args()
    program = pathlib.Path(args.program)
    args.program = str(program.resolve())
    text = pathlib.Path(args.scenario).read_text()
    names = re.findall(r'^\[\[policy\]\][^\[]*?^name = "([^"]+)"', text, re.MULTILINE)
    others = [name for name in names if name != args.policy]

    rules = []
    for seed in range(FIRST, FIRST + args.seeds):
        rules.append(tuned(args, seed, others))
        print(f"seed {seed}: {', '.join(f'{key} {value}' for key, value in rules[-1]['settings'].items())}, tuned "
              f"{rules[-1]['tuned']:.4g}", flush=True)
    costs = [judged(args, rule["set"], args.replications) for rule in rules]
    rough = [(statistics.fmean(judged(args, changes, args.scanned)), changes) for changes in scan(args, rules)]
    rough.sort(key=lambda pair: pair[0])
    final = [(judged(args, changes, args.replications), changes) for _, changes in rough[:FINAL]]
    best, changes = min(final + [(cost, rule["set"]) for cost, rule in zip(costs, rules)], key=lambda pair: statistics.fmean(pair[0]))
    least = statistics.fmean(best)
    print(f"optimum of the scan: {least:.4g} at {', '.join(changes)}")
    losses = []
    for rule, cost in zip(rules, costs):
        differences = [100.0 * (a - b) / least for a, b in zip(cost, best)]
        error = statistics.stdev(differences) / math.sqrt(len(differences))
        losses.append(statistics.fmean(differences))
        print(f"  {', '.join(rule['settings'].values())}: {statistics.fmean(cost):.4g}, {losses[-1]:+.2f} % ± {error:.2f}")
    for bound in (0.3, 1.0):
        print(f"within {bound:g} % of the optimum: {sum(loss <= bound for loss in losses)} of {len(losses)}")


if __name__ == "__main__":
    main()
