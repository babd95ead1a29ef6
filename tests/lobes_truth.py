#!/usr/bin/env python3
"""Asks `toolroom lobes` about random cuts and compares its answers with each other and with an independent calculation.

    python3 tests/lobes_truth.py                         # 200 systems, 20 speeds of each and 25 depths at each speed
    python3 tests/lobes_truth.py --systems 8 --seed 3    # a few of other draws
    python3 tests/lobes_truth.py --kind helix --systems 40 --columns 200 --rows 100 --truths 0

Of each system one chart is drawn, with one operating point at a random depth at each speed. Grid, curves, `stable`, the sign
of the margin, the limit and the list of stable intervals have to agree at every point of the grid and at every operating
point. Truth is computed here, with nothing of the program: in turning the number of unstable roots by the argument principle,
in milling the greatest multiplier by dense eigenvalues of a collocation in Chebyshev points. Points nearer than a thousandth
to an end of a stable interval are left out.

Systems are turning (one to four modes close to each other, half of them with process damping) and milling (straight, of low
immersion with a helix of 45 degrees, of unequal pitch, with process damping; one to four modes). Every contradiction is
printed with the file of its system, which is kept. The exit code is 1 where there is one.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
BAND = 1e-3


def turning_system(draw):
    count = draw.integers(1, 5)
    close = draw.uniform() < 0.6
    first = 120.0 * 8.0 ** draw.uniform()
    modes = []
    for i in range(count):
        spread = 1.6 ** draw.uniform(-1, 1) if close else 6.0 ** draw.uniform()
        angle = draw.uniform(-0.6, 0.6)
        modes.append((np.cos(angle), np.sin(angle), first * (spread if i else 1.0),
                      0.01 * 4.0 ** draw.uniform(), 4e6 * 10.0 ** draw.uniform()))
    damping = 3e4 * 30.0 ** draw.uniform() if draw.uniform() < 0.6 else 0.0
    system = {"process": "turning", "modes": modes, "K": 5e8 * 6.0 ** draw.uniform(), "angle": draw.uniform(0, 0.7),
              "damping": damping, "D": 0.04}
    low = 400.0 * 15.0 ** draw.uniform()
    system["speeds"] = (low, 1.5 * low)
    w = np.linspace(0.2, 4.0, 20000) * 2 * np.pi * min(mode[2] for mode in modes)
    least = response(system, w).real.min()
    system["greatest"] = draw.uniform(2.0, 8.0) / (2 * system["K"] * -least)
    return system


def milling_system(draw, kind):
    count = draw.integers(1, 5)
    first = 300.0 * 5.0 ** draw.uniform()
    modes = []
    for i in range(count):
        angle = draw.uniform(0, 2 * np.pi) if count > 2 else (np.pi / 2 * i)
        modes.append((np.cos(angle), np.sin(angle), first * (1.8 ** draw.uniform(-1, 1) if i else 1.0),
                      0.01 * 4.0 ** draw.uniform(), 2e6 * 10.0 ** draw.uniform()))
    teeth = int(draw.integers(2, 5) if kind == "pitch" else draw.integers(1, 6))
    Kt = 6e8 * 3.0 ** draw.uniform()
    immersion = 0.03 * 3.0 ** draw.uniform() if kind == "helix" else 0.03 * 33.0 ** draw.uniform()
    system = {"process": "milling", "modes": modes, "teeth": teeth, "D": draw.uniform(0.006, 0.02), "Kt": Kt,
              "Kn": Kt * draw.uniform(0.1, 0.5), "immersion": immersion, "up": draw.uniform() < 0.5, "helix": 0.0,
              "damping": 1e4 * 10.0 ** draw.uniform() if kind == "damping" else 0.0, "pitch": None}
    if kind == "helix":
        system["helix"] = np.pi / 4 if draw.uniform() < 0.7 else draw.uniform(0.2, 0.8)
    if kind == "pitch":
        shares = 1.0 + 0.25 * draw.uniform(-1, 1, teeth)
        system["pitch"] = list(2 * np.pi * shares / shares.sum())
    fastest = max(mode[2] for mode in modes)
    waves = 0.4 * 20.0 ** draw.uniform()
    low = 60.0 * fastest / (waves * teeth)
    system["speeds"] = (low, 1.4 * low)
    entry, leave = engagement(system)
    together = max(1.0, (leave - entry) * teeth / (2 * np.pi))
    reference = min(2 * mode[4] * mode[3] for mode in modes) / (0.5 * Kt * together)
    duty = min(1.0, (leave - entry) * teeth / (2 * np.pi))
    system["greatest"] = float(min(draw.uniform(2.0, 8.0) * reference / duty, 0.03))
    return system


def toml(system, columns, rows, points):
    lines = ["schema = 1", 'name = "drawn"', 'title = "drawn"', f'process = "{system["process"]}"']
    for i, (x, y, f, zeta, k) in enumerate(system["modes"]):
        lines += ["[[mode]]", f'name = "m{i}"', f"direction = [{x!r}, {y!r}]", f'natural_frequency = "{f!r} Hz"',
                  f"damping_ratio = {zeta!r}", f'stiffness = "{k!r} N/m"']
    if system["process"] == "turning":
        lines += ["[cut]", f'cutting_coefficient = "{system["K"] / 1e6!r} MPa"', f'diameter = "{system["D"] * 1e3!r} mm"',
                  f'force_angle = "{system["angle"]!r} rad"', f'process_damping = "{system["damping"]!r} N/m"']
    else:
        lines += ["[cutter]", f"teeth = {system['teeth']}", f'diameter = "{system["D"] * 1e3!r} mm"']
        if system["helix"]:
            lines.append(f'helix_angle = "{system["helix"]!r} rad"')
        if system["pitch"]:
            lines.append("pitch = [" + ", ".join(f'"{angle!r} rad"' for angle in system["pitch"]) + "]")
        lines += ["[engagement]", f"immersion = {system['immersion']!r}",
                  f'direction = "{"up" if system["up"] else "down"}"', "[force]",
                  f'tangential = "{system["Kt"] / 1e6!r} MPa"', f'radial = "{system["Kn"] / 1e6!r} MPa"',
                  f'process_damping = "{system["damping"]!r} N/m"']
    lines += ["[chart]", 'spindle_speed = ["{!r} rpm", "{!r} rpm"]'.format(*system["speeds"]),
              f'depth_of_cut = ["0 mm", "{system["greatest"] * 1e3!r} mm"]', f"columns = {columns}", f"rows = {rows}"]
    for i, (speed, depth) in enumerate(points):
        lines += ["[[point]]", f'name = "p{i}"', f'spindle_speed = "{speed!r} rpm"', f'depth_of_cut = "{depth * 1e3!r} mm"']
    return "\n".join(lines).replace("np.float64(", "").replace(")", "") + "\n"


# Turning: the argument principle.

def response(system, w):
    """Chip thickness over force (m/N) at the angular frequencies w."""
    total = 0
    for x, y, f, zeta, k in system["modes"]:
        length = np.hypot(x, y)
        x, y, wr = x / length, y / length, 2 * np.pi * f
        share = x * (x * np.cos(system["angle"]) + y * np.sin(system["angle"]))
        total = total + share * wr**2 / k / (wr**2 - w**2 + 2j * zeta * wr * w)
    return total


class Turned:
    """Roots in the right half plane of D(s) = 1 + b G(s) (K (1 - exp(-s tau)) + s C/V), at any width b."""

    def __init__(self, system, rpm):
        self.system, self.tau = system, 60.0 / rpm
        self.rate = system["damping"] / (np.pi * system["D"] * rpm / 60.0)
        fastest = 2 * np.pi * max(mode[2] for mode in system["modes"])
        # Beyond, the loop is less than one: checked at each width.
        self.end = 40 * fastest
        # Forty points a wave up to four times the modes, eight beyond, and each resonance.
        wave = 2 * np.pi / self.tau
        grids = [np.arange(1e-6 * wave, 4 * fastest, wave / 40), np.arange(4 * fastest, self.end, wave / 8)]
        for _, _, f, zeta, _ in system["modes"]:
            grids.append(2 * np.pi * f * (1 + zeta * np.linspace(-20, 20, 801)))
        w = np.unique(np.concatenate(grids))
        self.w = w[w > 0]
        self.loop = self.at(self.w)

    def at(self, w):
        s = 1j * w
        return response(self.system, w) * (self.system["K"] * (1 - np.exp(-s * self.tau)) + s * self.rate)

    def unstable(self, b):
        w, loop = self.w, self.loop
        for _ in range(60):
            turn = np.angle((1 + b * loop[1:]) / (1 + b * loop[:-1]))
            wide = np.flatnonzero((np.abs(turn) > 0.4) & (w[1:] - w[:-1] > 1e-13 * w[1:]))
            if not len(wide):
                break
            more = 0.5 * (w[wide] + w[wide + 1])
            w, loop = np.insert(w, wide + 1, more), np.insert(loop, wide + 1, self.at(more))
        assert abs(b * loop[-1]) < 1.0, "the loop is not small at the last frequency"
        total = turn.sum() + np.angle(1 + b * loop[0]) - np.angle(1 + b * loop[-1])
        count = -total / np.pi
        assert abs(count - round(count)) < 0.01, count
        return round(count)


# Milling: a dense collocation.

def engagement(system):
    a = system["immersion"]
    return (0.0, np.arccos(1 - 2 * a)) if system["up"] else (np.arccos(2 * a - 1), np.pi)


def chebyshev(p):
    """Points from -1 to 1 and the matrix of differentiation (Trefethen)."""
    x = -np.cos(np.pi * np.arange(p + 1) / p)
    c = np.ones(p + 1)
    c[0] = c[-1] = 2
    c *= (-1.0) ** np.arange(p + 1)
    difference = x[:, None] - x[None, :] + np.eye(p + 1)
    matrix = np.outer(c, 1 / c) / difference
    return x, matrix - np.diag(matrix.sum(axis=1))


def barycentric(x, at):
    """Weights of the values at Chebyshev points x for the value at `at`."""
    c = np.ones(len(x))
    c[0] = c[-1] = 0.5
    c *= (-1.0) ** np.arange(len(x))
    gap = at - x
    if np.abs(gap).min() < 1e-13:
        return (np.abs(gap) == np.abs(gap).min()).astype(float)
    weights = c / gap
    return weights / weights.sum()


class Milled:
    def __init__(self, system, rpm, extra=0):
        self.system, self.extra = system, extra
        self.speed = rpm / 60 * 2 * np.pi
        self.entry, self.leave = engagement(system)
        teeth = system["teeth"]
        self.pitch = system["pitch"] or [2 * np.pi / teeth] * teeth
        self.offsets = -np.concatenate([[0.0], np.cumsum(self.pitch[1:])])
        self.regular = system["pitch"] is None
        self.span = 2 * np.pi / teeth if self.regular else 2 * np.pi
        unit = [np.array([x, y]) / np.hypot(x, y) for x, y, *_ in system["modes"]]
        self.shape = np.array(unit).T
        wr = np.array([2 * np.pi * mode[2] for mode in system["modes"]])
        zeta = np.array([mode[3] for mode in system["modes"]])
        inverse_mass = wr**2 / np.array([mode[4] for mode in system["modes"]])
        m, self.scale = len(wr), wr.mean()
        # State: displacements, and rates over the mean frequency.
        self.A = np.zeros((2 * m, 2 * m))
        self.A[:m, m:] = self.scale * np.eye(m)
        self.A[m:, :m] = np.diag(-wr**2 / self.scale)
        self.A[m:, m:] = np.diag(-2 * zeta * wr)
        self.B = np.vstack([np.zeros((m, 2)), (self.shape * inverse_mass).T / self.scale])
        self.C = np.hstack([self.shape, np.zeros((2, m))])
        self.V = np.hstack([np.zeros((2, m)), self.shape * self.scale])
        self.fastest = wr.max()

    def matrices(self, j, angle, lag):
        """Directional matrix and dyad of the radius of tooth j, averaged over the depth."""
        ss = sc = cc = 0.0
        for turn in range(-2, 3):
            lead = angle + self.offsets[j] + 2 * np.pi * turn
            if lag == 0.0:
                if self.entry <= lead <= self.leave:
                    s, c = np.sin(lead), np.cos(lead)
                    ss, sc, cc = ss + s * s, sc + s * c, cc + c * c
                continue
            low, high = max(lead - lag, self.entry), min(lead, self.leave)
            if high > low:
                double = (np.sin(2 * high) - np.sin(2 * low)) / 4
                ss += ((high - low) / 2 - double) / lag
                cc += ((high - low) / 2 + double) / lag
                sc += (np.sin(high) ** 2 - np.sin(low) ** 2) / 2 / lag
        t, n = self.system["Kt"], self.system["Kn"]
        gain = np.array([[t * sc + n * ss, t * cc + n * sc], [n * sc - t * ss, n * cc - t * sc]])
        return gain, np.array([[ss, sc], [sc, cc]])

    def radius(self, depth):
        system, span, teeth = self.system, self.span, self.system["teeth"]
        lag = 2 * np.tan(system["helix"]) * depth / system["D"]
        edges = {0.0, span}
        for j in range(teeth):
            for edge in (self.entry, self.leave):
                for shift in ({0.0, lag}):
                    place = edge + shift - self.offsets[j] - self.entry
                    edges.add(place % span)
                    if not self.regular:
                        edges.update((place + delay) % span for delay in self.pitch)
        edges = sorted(edges)
        edges = [a for a, b in zip(edges, edges[1:] + [2 * span]) if b - a > 1e-10 or a in (0.0,)]
        edges[-1] = span
        longest = 0.45 * min(self.pitch) if not self.regular else span
        cuts = []
        for a, b in zip(edges, edges[1:]):
            parts = max(1, int(np.ceil((b - a) / longest)), int(np.ceil((b - a) / self.speed * self.fastest / (2 * np.pi * 2))))
            cuts += list(a + (b - a) * np.arange(parts) / parts)
        cuts.append(span)
        dwell = system["damping"] / (self.speed * system["D"] / 2)
        pieces, offset, m2 = [], len(self.A), len(self.A)
        for a, b in zip(cuts, cuts[1:]):
            middle = self.entry + 0.5 * (a + b)
            active = [j for j in range(teeth) if np.abs(self.matrices(j, middle, lag)[0]).max() > 0]
            cycles = (b - a) / self.speed * self.fastest / (2 * np.pi)
            p = int(np.ceil(9 + 9 * cycles)) + self.extra
            kept = bool(active) or not self.regular
            pieces.append((a, b, active, p, offset if kept else None))
            offset += 2 * p if kept else 0
        size = offset
        Z = np.hstack([np.eye(m2), np.zeros((m2, size - m2))])
        rows, values = [], []
        for index, (a, b, active, p, place) in enumerate(pieces):
            x, D = chebyshev(p)
            h = (b - a) / self.speed
            M = np.kron(2 / h * D[1:, 1:], np.eye(m2)) - np.kron(np.eye(p), self.A)
            R = -np.kron(2 / h * D[1:, :1], np.eye(m2)) @ Z
            for i in range(1, p + 1):
                here = 0.5 * (a + b) + 0.5 * (b - a) * x[i]
                # One-sided at the ends of the piece: a tooth that enters or leaves there counts as in the middle.
                inside = here + (0.5 * (a + b) - here) * 1e-12
                block = slice((i - 1) * m2, i * m2)
                for j in active:
                    gain, dyad = self.matrices(j, self.entry + inside, lag)
                    force = -depth * (gain @ self.C + dwell * dyad @ self.V)
                    M[block, block] -= self.B @ force
                    if self.regular:
                        earlier = np.zeros((2, size))
                        earlier[:, place + 2 * (i - 1): place + 2 * i] = np.eye(2)
                    else:
                        earlier = self.earlier(here - self.pitch[j], pieces, values, Z, size, span)
                    R[block] += self.B @ (depth * gain @ earlier)
            solved = np.linalg.solve(M, R)
            u = np.array([self.C @ solved[i * m2:(i + 1) * m2] for i in range(p)])
            values.append(np.concatenate([[self.C @ Z], u]))
            Z = solved[-m2:]
            if place is not None:
                rows.append(u.reshape(2 * p, size))
        whole = np.vstack([Z] + rows)
        return np.abs(np.linalg.eigvals(whole)).max()

    def earlier(self, at, pieces, values, Z, size, span):
        """Displacement at an angle before, as rows over the state at the beginning of the span."""
        past = at < -1e-12
        at = at + span if past else max(at, 0.0)
        index = max(i for i, piece in enumerate(pieces) if piece[0] <= at + 1e-12)
        a, b, _, p, place = pieces[index]
        x, _ = chebyshev(p)
        weights = barycentric(x, np.clip((2 * at - a - b) / (b - a), -1, 1))
        if not past:
            return np.tensordot(weights, values[index], axes=1)
        row = np.zeros((2, size))
        for i in range(1, p + 1):
            row[:, place + 2 * (i - 1): place + 2 * i] += weights[i] * np.eye(2)
        if abs(weights[0]) > 0:
            # The first point of a piece is the last of the one before.
            if index == 0:
                # The state at the beginning of the span a revolution earlier is not kept: extrapolate from the others.
                points = x[1:]
                w = np.array([np.prod([(x[0] - q) / (r - q) for q in points if q != r]) for r in points])
                for i in range(1, p + 1):
                    row[:, place + 2 * (i - 1): place + 2 * i] += weights[0] * w[i - 1] * np.eye(2)
            else:
                _, _, _, q, before = pieces[index - 1]
                row[:, before + 2 * (q - 1): before + 2 * q] += weights[0] * np.eye(2)
        return row


def near(intervals, depth):
    ends = [end for pair in intervals for end in pair if end > 0]
    return any(abs(depth / end - 1) < BAND for end in ends)


def within(intervals, depth):
    return any(low <= depth < high for low, high in intervals)


class Books:
    def __init__(self):
        self.points = {"turning": 0, "milling": 0}
        self.compared = {}
        self.wrong = []

    def check(self, what, system, agreed, **where):
        count = self.compared.setdefault(what, [0, 0])
        count[0] += 1
        if not agreed:
            count[1] += 1
            self.wrong.append((what, where, system["file"]))
            print(f"contradiction: {what} at {where} of {system['file']}", flush=True)


def examine(system, folder, number, options, draw, books):
    columns, rows = options.columns, options.rows
    low, high = system["speeds"]
    speeds = [low + (high - low) * i / (columns - 1) for i in range(columns)]
    points = [(speed, float(system["greatest"] * draw.uniform(0.02, 1.0))) for speed in speeds]
    system["file"] = str(folder / f"s{number}.toml")
    pathlib.Path(system["file"]).write_text(toml(system, columns, rows, points))
    out = folder / f"s{number}"
    run = subprocess.run([options.program, "lobes", system["file"], "--out", str(out), "--threads", str(options.threads)],
                         capture_output=True, text=True)
    if run.returncode:
        books.check("the program answers", system, False, message=run.stderr.strip()[:300])
        return
    told = json.loads((out / "lobes.json").read_text())
    with (out / "lobes.csv").open() as file:
        grid = list(csv.DictReader(file))
    kind = system["process"]
    curve = told["boundaries"][0]
    ends = curve["limit"] + curve["further"]
    holes = {round(hole[0], 6) if isinstance(hole, list) else None for hole in curve["holes"]}
    for i, (speed, point) in enumerate(zip(speeds, told["points"])):
        depth = point["depth_of_cut [mm]"]
        if "stable" not in point:
            books.check("the point has a verdict", system, False, speed=speed, depth=depth)
            continue
        searched = system["greatest"] * 1e3
        intervals = [(a, searched * 2 if b == point["searched [mm]"] else b) for a, b in point["stable_intervals [mm]"]]
        here = [end[1] for end in ends if end[1] is not None and abs(end[0] / speed - 1) < 1e-9]
        truth = Turned(system, speed) if kind == "turning" else Milled(system, speed)
        if not near(intervals, depth):
            books.check("single verdict and intervals", system, point["stable"] == within(intervals, depth), speed=speed, depth=depth)
            limit = point.get("stability_limit [mm]")
            first = intervals[0][1] if intervals else 0.0
            bounded = first < searched
            books.check("limit and first interval", system, not bounded or limit is not None and abs(limit / first - 1) < 1e-6,
                        speed=speed, depth=depth)
            if limit is not None and "margin" in point:
                books.check("sign of the margin and limit", system, (point["margin"] > 0) == (depth < limit), speed=speed, depth=depth)
        column = grid[i * rows:(i + 1) * rows]
        sampled = set(draw.integers(0, rows, options.truths).tolist()) if kind == "milling" else set(range(rows))
        asked = [(float(row["depth_of_cut [mm]"]), row["stable"] == "true", row["hole"], j in sampled) for j, row in enumerate(column)]
        asked.append((depth, point["stable"], "", kind == "turning" or options.truths > 0))
        for at, stable, hole, judge in asked:
            if at == 0 or near(intervals, at):
                continue
            if hole:
                books.check("the grid has a verdict", system, False, speed=speed, depth=at)
                continue
            books.points[kind] += 1
            books.check("grid and intervals", system, stable == within(intervals, at), speed=speed, depth=at)
            if round(speed, 6) not in holes:
                side = sum(end < at for end in here) % 2 == 0
                books.check("curve and intervals", system, side == within(intervals, at), speed=speed, depth=at)
            if not judge:
                continue
            if kind == "turning":
                books.check("truth of turning", system, (truth.unstable(at * 1e-3) == 0) == stable, speed=speed, depth=at)
                continue
            right = (truth.radius(at * 1e-3) < 1) == stable
            if not right:
                # What differs is calculated once more with more points before it counts.
                right = (Milled(system, speed, extra=8).radius(at * 1e-3) < 1) == stable
            books.check("truth of milling", system, right, speed=speed, depth=at)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--systems", type=int, default=200)
    parser.add_argument("--columns", type=int, default=20, help="speeds of each system")
    parser.add_argument("--rows", type=int, default=25, help="depths at each speed")
    parser.add_argument("--truths", type=int, default=2, help="points of the grid of milling at each speed that are calculated here")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first system")
    parser.add_argument("--kind", choices=["turning", "straight", "helix", "pitch", "damping"], help="these systems alone")
    parser.add_argument("--threads", type=int, default=0, help="threads of the program")
    parser.add_argument("program", nargs="?", default=str(ROOT / "target/release/toolroom"))
    parser.add_argument("--keep", help="folder of the systems' files; a temporary one if left out")
    options = parser.parse_args()
    folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="lobes-truth-"))
    folder.mkdir(parents=True, exist_ok=True)
    books = Books()
    kinds = ["straight", "helix", "pitch", "damping", "straight", "helix"]
    for number in range(options.first, options.first + options.systems):
        draw = np.random.default_rng([options.seed, number])
        kind = options.kind or ("turning" if number % 2 == 0 else kinds[number // 2 % len(kinds)])
        system = turning_system(draw) if kind == "turning" else milling_system(draw, kind)
        examine(system, folder, number, options, draw, books)
    print(f"{books.points['turning']} points of turning, {books.points['milling']} of milling, {options.systems} systems")
    for what, (count, wrong) in books.compared.items():
        print(f"{what}: {count} compared, {wrong} contradictions")
    return 1 if books.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
