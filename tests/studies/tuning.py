"""How near the settings that `toolroom compare --tune` finds come to the best ones of a scan.

    python tests/studies/tuning.py PROGRAM scenarios/constant-vs-adaptive.toml constant [--seeds 10] [--budget 600]
        [--scanned 40] [--tuned "VALUE, VALUE; …"] [--failure SHARE] [--grid "LOW HIGH STEPS; …"] [--keep FILE]
        [--set KEY=VALUE …]

Every seed of the tuning finds settings for one policy. A grid around them is run on random numbers that are others than those of
the tuning and of the file, the same for all of its settings. The cost of a part is a quadratic surface through all settings of the
grid that cost at most a few per cent more than the best: where a single mean is known to a per cent, the surface through some
twenty of them is known to a tenth. The loss of tuned settings is what the surface has there above its least; how far the means lie
from the surface is printed as chi square. With --tuned, settings of an earlier run are judged without tuning.

With --failure no more than this share of edges may be lost in cut (the guard of the tuning): the loss is then against the least of
the surface where a surface through the angles asin √share lies within the guard, and the share at the tuned settings is printed.
--grid scans a grid that is given, in the order and the units in which settings are printed, and --keep writes what was scanned to a
file from which the same command goes on, so that two programs are judged by one surface.
`examples/tuning.rs` of toolroom-study does the same by the library, with single means.
"""

import argparse
import csv
import itertools
import json
import math
import pathlib
import re
import subprocess
import tempfile

import numpy as np

JUDGING = 2002
FIRST = 1001
STEPS = 6  # of each setting of the scan
SPREAD = 0.1  # by which the scan goes beyond the tuned settings, relative
# Settings that cost more than this over the best are no part of the surface: a parabola describes the valley, not its walls. The
# first bound is taken with which it describes the means within their errors.
FITTED = (1.06, 1.03, 1.015, 1.008, 1.004)
SPARE = 3  # settings beside the coefficients without which there is no surface


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
        # A comparison is of two policies at least.
        words += ["--policy", others[0]] if others else []
        words += [word for change in args.set for word in ("--set", change)]
        found = json.loads(call(args.program, words))["tuning"]
    return next(rule for rule in found if rule["policy"] == args.policy)


def judged(args, changes, replications):
    """Cost of a part and share of edges that were lost in cut, in every replication."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["run", args.scenario, "--policy", args.policy, "--seed", str(JUDGING), "--replications", str(replications),
                 "--out", f"{folder}/out", "--threads", str(args.threads)]
        words += [word for change in [*args.set, *changes] for word in ("--set", change)]
        call(args.program, words)
        with open(f"{folder}/out/kpi.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    def figure(name):
        wanted = [row for row in rows if row["policy"] == args.policy and row["kpi"] == name and not row["machine"]]
        return [float(row["value"]) for row in sorted(wanted, key=lambda row: int(row["replication"]))]

    # A replication in which no edge ended has lost none.
    lost = [0.0 if math.isnan(share) else share for share in figure("edge_failure_share")]
    return {"costs": figure("cost_per_part"), "lost": lost}


def kept(args, changes):
    """What the settings cost, from the file of an earlier scan where it holds them."""
    file = pathlib.Path(args.keep) if args.keep else None
    scanned = json.loads(file.read_text()) if file and file.exists() else {}
    of_shop = [change for change in args.set if not change.startswith("tune.")]
    name = " ".join([args.scenario, args.policy, *of_shop, *changes, str(args.scanned)])
    if name not in scanned:
        scanned[name] = judged(args, changes, args.scanned)
        if file:
            file.write_text(json.dumps(scanned))
    return scanned[name]


def numbers(settings):
    """Values of settings without their units."""
    return [float(re.fullmatch(r"([0-9.eE+-]+)( .*)?", shown)[1]) for shown in settings]


def scan(args, rules):
    """A grid around the tuned settings: changes of the file and values of the settings."""
    lists = []
    for place, (key, shown) in enumerate(rules[0]["settings"].items()):
        values = [numbers(rule["settings"].values())[place] for rule in rules]
        low, high = min(values) * (1 - SPREAD), max(values) * (1 + SPREAD)
        unit = shown[len(shown.split(" ")[0]):]
        # The change of a tuned rule with another number in it.
        change = next(change for change in rules[0]["set"] if shown in change)
        count = STEPS
        if args.grid:
            low, high, count = map(float, args.grid.split(";")[place].split())
        steps = [f"{low * (high / low) ** (step / (count - 1)):.4g}" for step in range(int(count))]
        lists.append([(change.replace(shown, step + unit), float(step)) for step in steps])
    grid = [list(pairs) for pairs in itertools.product(*lists)]
    return [[change for change, _ in pairs] for pairs in grid], np.array([[value for _, value in pairs] for pairs in grid])


def row(values, centre):
    """Products of the logarithms of settings up to the second order."""
    x = np.log(np.atleast_2d(values) / centre)
    pairs = itertools.combinations_with_replacement(range(x.shape[1]), 2)
    return np.column_stack([np.ones(len(x)), x, *(x[:, i] * x[:, j] for i, j in pairs)])


class Surface:
    """A quadratic surface through the cheaper settings of a scan: `costs` has a row a setting and a column a replication. Where
    `lost` has the share of lost edges in the same order, its least is sought where no more than `failure` are lost."""

    def __init__(self, values, costs, lost, failure):
        self.failure = failure
        means = costs.mean(axis=1)
        allowed = lost.mean(axis=1) <= failure
        if not allowed.any():
            raise SystemExit(f"every setting of the scan loses more than {failure:g} of its edges")
        for bound in FITTED:
            # Settings that the guard excludes tell the surface on its other side.
            used = means <= bound * means[allowed].min()
            if used.sum() < row(values, 1.0).shape[1] + SPARE:
                break
            self.fit(values, costs, lost, used)
            if self.chi_square < 2 * self.free:
                break

    def fit(self, values, costs, lost, used):
        means = costs.mean(axis=1)
        self.values, means, costs = values[used], means[used], costs[used]
        self.centre = np.exp(np.log(self.values).mean(axis=0))
        # What a replication costs everybody says nothing of the settings.
        own = costs - costs.mean(axis=0) - means[:, None]
        own += costs.mean()
        count, replications = costs.shape
        self.error = math.sqrt((own**2).sum() / ((count - 1) * (replications - 1)) / replications)
        design = row(self.values, self.centre)
        self.coefficients = np.linalg.lstsq(design, means, rcond=None)[0]
        self.angles = np.linalg.lstsq(design, np.arcsin(np.sqrt(lost[used].mean(axis=1))), rcond=None)[0]
        self.covariance = np.linalg.inv(design.T @ design) * self.error**2
        left = means - design @ self.coefficients
        self.chi_square, self.free = float((left**2).sum() / self.error**2), count - design.shape[1]
        # The least within the settings that were fitted.
        axes = [np.linspace(column.min(), column.max(), 121) for column in self.values.T]
        grid = np.array(list(itertools.product(*axes)))
        grid = grid[self.share(grid) <= self.failure]
        heights = row(grid, self.centre) @ self.coefficients
        self.best, self.least = grid[heights.argmin()], float(heights.min())

    def share(self, values):
        """Share of edges that are lost."""
        return np.sin(np.maximum(row(values, self.centre) @ self.angles, 0.0)) ** 2

    def loss(self, values):
        """Per cent above the least, and the standard error."""
        apart = row(values, self.centre)[0] - row(self.best, self.centre)[0]
        error = math.sqrt(float(apart @ self.covariance @ apart))
        return 100 * float(apart @ self.coefficients) / self.least, 100 * error / self.least


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scenario")
    parser.add_argument("policy")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--budget", type=int, default=600)
    parser.add_argument("--scanned", type=int, default=40, help="replications of every setting of the scan")
    parser.add_argument("--tuned", help="settings of every seed as they were printed, with semicolons between seeds")
    parser.add_argument("--failure", type=float, default=1.0, help="greatest share of edges that may be lost in cut")
    parser.add_argument("--grid", help="least, greatest and number of values of every setting, with semicolons between settings")
    parser.add_argument("--keep", help="file that holds what was scanned")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--set", action="append", default=[])
    args = parser.parse_args()
    args.program = str(pathlib.Path(args.program).resolve())
    if args.failure < 1.0:
        args.set.append(f'tune.guard={{ collapse = "2 %", failure = "{100 * args.failure:g} %" }}')
    text = pathlib.Path(args.scenario).read_text()
    names = re.findall(r'^\[\[policy\]\][^\[]*?^name = "([^"]+)"', text, re.MULTILINE)
    others = [name for name in names if name != args.policy]

    rules = []
    for seed in range(FIRST, FIRST + args.seeds):
        if args.tuned and rules:
            break
        # Where settings are given, the first tuning only says which keys of the file they are.
        rules.append(tuned(args, seed, others))
        if not args.tuned:
            shown = ", ".join(f"{key} {value}" for key, value in rules[-1]["settings"].items())
            print(f"seed {seed}: {shown}, tuned {rules[-1]['tuned']:.4g}", flush=True)
    if args.tuned:
        first = rules[0]
        given = [[value.strip() for value in settings.split(",")] for settings in args.tuned.split(";")]
        rules = [{**first, "settings": dict(zip(first["settings"], values))} for values in given]
        rules[0]["set"] = [change for change in first["set"]]
        for old, new in zip(first["settings"].values(), given[0]):
            rules[0]["set"] = [change.replace(old, new) for change in rules[0]["set"]]
    changes, values = scan(args, rules)
    scanned = [kept(args, own) for own in changes]
    costs, lost = (np.array([found[key] for found in scanned]) for key in ("costs", "lost"))
    surface = Surface(values, costs, lost, args.failure)
    best = ", ".join(f"{value:.4g}" for value in surface.best)
    print(f"least of the surface {surface.least:.4g} at {best}; a mean is known to {100 * surface.error / surface.least:.2f} %, "
          f"chi square {surface.chi_square:.1f} of {surface.free}")
    losses = []
    for rule in rules:
        loss, error = surface.loss(numbers(rule["settings"].values()))
        losses.append(loss)
        share = float(surface.share(np.array([numbers(rule["settings"].values())]))[0])
        guard = f", {100 * share:.2f} % of edges lost" if args.failure < 1.0 else ""
        print(f"  {', '.join(rule['settings'].values())}: {loss:+.2f} % ± {error:.2f}{guard}")
    for bound in (0.3, 1.0):
        print(f"within {bound:g} % of the optimum: {sum(loss <= bound for loss in losses)} of {len(losses)}")


if __name__ == "__main__":
    main()
