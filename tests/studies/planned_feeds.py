"""Whether planned feeds break a limit between the samples of the plan: random programs, judged by an independent count.

    python tests/studies/planned_feeds.py PROGRAM [--programs 200] [--seed 1] [--step 0.1] [--keep FOLDER]

Every program mills a block at one height along random lines and arcs, crossing its own way. `toolroom program --objective time`
plans its feeds inside a limit of power or of chip thickness and writes them. The written program is read here, by nothing of
toolroom: every `step` mm the rim of the cutter is looked at in steps of 0.5 degrees, and of 0.02 degrees where a limit is nearly used up; a point of it is in material where it lies in the
block and no nearer to the way before than the radius. From that follow the chip thickness, feed a tooth times the greatest cosine of the angle
to the direction of travel, and the power by the coefficients of the set, Kt 2960 N/mm2 and 20.8 N/mm. The greatest ratio to the
limit is printed with its program. Exit code 1 where a ratio is above 1.001.
"""

import argparse
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import numpy as np

BLOCK = (60.0, 40.0)
DEPTH, SPEED, TEETH = 3.0, 3000.0, 4
CUTTING, EDGE = 2960.0, 20.8  # N/mm2 and N/mm, of mill_t15k6_d32
COARSE, FINE = (np.radians(np.arange(-90.0 + 0.5 * part, 90.0, part)) for part in (0.5, 0.02))
CHORD = 0.1  # mm between the places of a way

SETUP = """schema = 1
[stock]
box = [["0 mm", "0 mm", "-20 mm"], ["60 mm", "40 mm", "0 mm"]]
[limits]
highest_feed = "6000 mm/min"
lowest_feed = "1 mm/min"
{limits}
[[tool]]
number = 1
diameter = "{diameter} mm"
teeth = 4
length = "30 mm"
parameter_set = "mill_t15k6_d32"
"""


def program(draw):
    """A program of one height: in from outside, then lines and arcs that stay near the block, and out again."""
    x, y = -12.0, draw.uniform(0.0, BLOCK[1])
    lines = ["G21 G90 G17", "T1 M6", f"S{SPEED:.0f} M3", f"G0 X{x:.3f} Y{y:.3f} Z5", f"G0 Z-{DEPTH}", f"G1 X0 Y{y:.3f} F{draw.uniform(200, 900):.0f}"]
    x = 0.0
    for _ in range(draw.randint(3, 8)):
        to = (draw.uniform(-5.0, BLOCK[0] + 5.0), draw.uniform(-5.0, BLOCK[1] + 5.0))
        reach = math.hypot(to[0] - x, to[1] - y)
        if reach < 1.0:
            continue
        if draw.random() < 0.4:
            radius = 0.5 * reach * draw.uniform(1.02, 3.0)
            lines.append(f"G{draw.choice([2, 3])} X{to[0]:.3f} Y{to[1]:.3f} R{radius:.3f}")
        else:
            lines.append(f"G1 X{to[0]:.3f} Y{to[1]:.3f}")
        x, y = to
    return "\n".join(lines + ["G1 Y60", "G0 Z20", "M30", ""])


def path(text):
    """Ways at feed below the surface: points, direction at each and feed in mm/min, from the words that a post writes."""
    at, feed, absolute = {"X": 0.0, "Y": 0.0, "Z": 100.0}, 0.0, True
    motion = 0
    for line in text.splitlines():
        line = re.sub(r"\(.*?\)", "", line)
        words = {letter: float(value) for letter, value in re.findall(r"([A-Z])(-?[0-9.]+)", line)}
        codes = [int(float(code)) for code in re.findall(r"G([0-9.]+)", line)]
        feed = words.get("F", feed)
        if 91 in codes or 53 in codes or 28 in codes:
            continue
        motion = next((code for code in codes if code in (0, 1, 2, 3)), motion)
        end = {axis: words.get(axis, at[axis]) for axis in at}
        if not any(axis in words for axis in at):
            continue
        start, at = at, end
        if motion == 0 or end["Z"] >= 0.0 or start["Z"] >= 0.0:
            yield None, None, None
            continue
        a, b = np.array([start["X"], start["Y"]]), np.array([end["X"], end["Y"]])
        if motion == 1:
            count = max(2, int(np.hypot(*(b - a)) / CHORD) + 1)
            share = np.linspace(0.0, 1.0, count)[:, None]
            direction = np.repeat([(b - a) / max(np.hypot(*(b - a)), 1e-12)], count, axis=0)
            yield a + share * (b - a), direction, feed
            continue
        if "R" in words:
            raise ValueError("arcs are written by I and J")
        centre = a + np.array([words.get("I", 0.0), words.get("J", 0.0)])
        begin, stop = (math.atan2(*(p - centre)[::-1]) for p in (a, b))
        sign = 1.0 if motion == 3 else -1.0
        turn = (sign * (stop - begin)) % (2.0 * math.pi) or 2.0 * math.pi
        radius = np.hypot(*(a - centre))
        angles = begin + sign * np.linspace(0.0, turn, max(2, int(radius * turn / CHORD) + 1))
        points = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        yield points, sign * np.stack([-np.sin(angles), np.cos(angles)], axis=1), feed


def engaged(place, direction, way, radius, angles):
    """The angles of the rim to the direction of travel that are in material."""
    aside = np.array([-direction[1], direction[0]])
    rim = place + radius * (np.cos(angles)[:, None] * direction + np.sin(angles)[:, None] * aside)
    solid = (rim > 0.0).all(axis=1) & (rim < np.array(BLOCK)).all(axis=1)
    left, angles = rim[solid], angles[solid]
    if len(way) and len(left):
        # Between places CHORD apart the distance errs by less than a micrometre.
        gap = np.sqrt(((left[:, None, :] - way[None, :, :]) ** 2).sum(axis=2).min(axis=1))
        angles = angles[gap > radius + 1e-3]
    return angles


def ratio(place, direction, way, radius, feed, limit, rim):
    """Use of the limit at a place."""
    angles = engaged(place, direction, way, radius, rim)
    if len(angles) == 0:
        return 0.0
    tooth = feed / (SPEED * TEETH)
    if limit[0] == "chip_thickness":
        return tooth * np.cos(angles).max() / limit[1]
    force = np.sum(CUTTING * tooth * np.cos(angles) + EDGE) * (rim[1] - rim[0])
    torque = TEETH / (2.0 * math.pi) * DEPTH * force * 1e-3 * radius
    return torque * (SPEED * 2.0 * math.pi / 60.0) / limit[1]


def worst(text, radius, limit, step):
    """Greatest ratio to the limit, and where that is."""
    before = np.zeros((0, 2))
    most, where = 0.0, None
    for points, directions, feed in path(text):
        if points is None:
            continue
        for i in [*range(0, len(points), max(1, int(step / CHORD))), len(points) - 1]:
            # The way of this motion up to here counts as before, but not its end: the rim stands on it.
            way = np.vstack([before, points[:i]])
            way = way[np.hypot(*(way - points[i]).T) < 2.0 * radius + 1e-9]
            at = (points[i], directions[i], way, radius, feed, limit)
            used = ratio(*at, COARSE)
            if used > max(0.985, most):
                used = ratio(*at, FINE)
            if used > most:
                most, where = used, (points[i].round(3).tolist(), feed)
        before = np.vstack([before, points])
    return most, where


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("--programs", type=int, default=200)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--step", type=float, default=0.1)
    arguments.add_argument("--keep")
    given = arguments.parse_args()
    folder = pathlib.Path(given.keep or tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    greatest, broken = (0.0, None), 0
    for seed in range(given.seed, given.seed + given.programs):
        draw = random.Random(seed)
        diameter = draw.choice([6.0, 8.0, 10.0, 12.0])
        limit = draw.choice([("power", draw.uniform(0.15, 0.6) * 1e3), ("chip_thickness", draw.uniform(0.03, 0.12))])
        value = f'{limit[1] / 1e3} kW' if limit[0] == "power" else f"{limit[1]} mm"
        text = program(draw)
        names = [folder / f"{seed}{ending}" for ending in (".nc", ".toml", "-planned.nc")]
        names[0].write_text(text)
        # A limit of the other kind that does not bind.
        other = 'chip_thickness = "0.3 mm"' if limit[0] == "power" else ""
        names[1].write_text(SETUP.format(limits=f'{limit[0]} = "{value}"\n{other}', diameter=diameter))
        command = [given.program, "program", names[0], "--setup", names[1], "--objective", "time", "--limits", limit[0]]
        run = subprocess.run([*command, "--post", "fanuc", "--out", names[2], "--json", "--force", "--start", "0,0,100 mm"], capture_output=True, text=True)
        if run.returncode:
            sys.exit(f"{seed}: {run.stderr}")
        told = {row["limit"]: row["ratio"] for row in json.loads(run.stdout)["planned"]["limits"]}.get(limit[0], 0.0)
        most, where = worst(names[2].read_text(), 0.5 * diameter, limit, given.step)
        if told > 1.001:
            # The slowest feed does not keep the limit, which the plan says.
            print(f"{seed}: no feed keeps {limit[0]}: {told:.3f} told, {most:.3f} counted")
            continue
        if most > 1.001:
            broken += 1
            print(f"{seed}: {limit[0]} of {value} is broken {most:.4f} times at {where}")
        if most > greatest[0]:
            greatest = (most, seed)
    print(f"{given.programs} programs: a limit is used {greatest[0]:.4f} times at most (seed {greatest[1]}), {broken} broken")
    sys.exit(1 if broken else 0)


main()
