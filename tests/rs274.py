#!/usr/bin/env python3
"""Random LinuxCNC programs through the interpreter of LinuxCNC and through `toolroom program`: the same motions, times and ends.

    python3 tests/rs274.py target/debug/toolroom                # 60 programs
    python3 tests/rs274.py target/debug/toolroom --count 500    # the whole gate
    python3 tests/rs274.py target/debug/toolroom --posts DIR    # posts of the programs in DIR, accepted and alike

`rs274` comes with the package linuxcnc-uspace (`--rs274 PATH` where it is not on the path). Without it the script says so and
ends well. Every program is interpreted twice: as it was written, and as `--post linuxcnc` writes it after reading; the canonical
motions of both must be the same, so reader and post are held against the interpreter at once. Feed time and end come from the
JSON of `toolroom program`.
"""
import argparse, json, math, os, pathlib, random, re, shutil, subprocess, sys, tempfile

TOLERANCE = 2.5e-4  # mm: canonical motions and posts are written with four decimals

# Where programs start, and the tools whose radius they compensate.
TOLD = ["--start", "0,0,0 mm", "--tool", "D1=10 mm", "--tool", "D2=6 mm"]


def canonical(rs274, path, folder, splines=()):
    """Motions of a program: (kind, end, length mm, time s), and the sum of dwells. Of a spline the interpreter tells that it accepted
    it; `splines` holds end and length of each, in units of the program, in order."""
    splines = iter(splines)
    # Lengths of the table are inches where no machine says otherwise. The interpreter keeps it in the home folder.
    tools = [(number, 6 if number == 2 else 10) for number in range(1, 100)]
    (folder / "tool.tbl").write_text("".join(f"T{number} P{number} D{diameter / 25.4} Z0\n" for number, diameter in tools))
    (folder / "none.var").write_text("")
    done = subprocess.run([rs274, "-g", "-t", str(folder / "tool.tbl"), "-v", str(folder / "none.var"), str(path)],
                          capture_output=True, text=True, timeout=60, env={**os.environ, "HOME": str(folder)})
    text = done.stdout + done.stderr
    calls = re.findall(r"^\s*\d+ N\S+\s+([A-Z0-9_]+)\((.*)\)\s*$", done.stdout, re.M)
    if done.returncode or not calls or calls[-1][0] not in ("PROGRAM_END", "ON_RESET"):
        raise ValueError(" / ".join(line for line in text.strip().splitlines() if not re.match(r"\s*\d+ N|executing", line)) or "no answer")
    at, offset, axis_offset, turn = [0.0] * 6, [0.0] * 6, [0.0] * 6, 0.0
    scale, plane, feed, mode, speed, motions, dwell = 1.0, 0, 0.0, 0, 0.0, [], 0.0

    def place(values):
        local = [value * (scale if i < 3 else 1.0) + axis_offset[i] for i, value in enumerate(values)]
        sin, cos = math.sin(math.radians(turn)), math.cos(math.radians(turn))
        x, y = local[0] * cos - local[1] * sin, local[0] * sin + local[1] * cos
        return [a + b for a, b in zip([x, y] + local[2:], offset)]

    def took(length, rotary):
        rate = feed * (1.0 if rotary else scale)
        return 60 * length / (rate * (speed if mode else 1.0))

    for name, rest in calls:
        numbers = [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", rest)]
        if name == "USE_LENGTH_UNITS":
            scale = 25.4 if "INCH" in rest else 1.0
        elif name == "SELECT_PLANE":
            plane = ["XY", "YZ", "XZ"].index(re.search("XY|YZ|XZ", rest).group())
        elif name == "SET_FEED_RATE":
            feed = numbers[0]
        elif name == "SET_FEED_MODE":
            mode = int(numbers[-1])
        elif name == "SET_SPINDLE_SPEED":
            speed = numbers[-1]
        elif name == "SET_G5X_OFFSET":
            offset = [value * (scale if i < 3 else 1.0) for i, value in enumerate(numbers[1:7])]
        elif name == "SET_G92_OFFSET":
            axis_offset = [value * (scale if i < 3 else 1.0) for i, value in enumerate(numbers[:6])]
        elif name == "SET_XY_ROTATION":
            turn = numbers[0]
        elif name == "DWELL":
            dwell += numbers[0]
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            end = place(numbers[:6])
            span = math.dist(end[:3], at[:3])
            rotary = span == 0 and end != at
            length = max(abs(a - b) for a, b in zip(end[3:], at[3:])) if rotary else span
            rapid = name == "STRAIGHT_TRAVERSE"
            motions.append(("rapid" if rapid else "line", end, length, 0.0 if rapid or not length else took(length, rotary)))
            at = end
        elif name == "NURBS_FEED":
            x, y, span = next(splines)
            end, span = [x * scale, y * scale] + at[2:], span * scale
            motions.append(("spline", end, span, took(span, False)))
            at = end
        elif name == "ARC_FEED":
            first, second, middle, other, turns, across = numbers[:6]
            axes = [(0, 1, 2), (1, 2, 0), (2, 0, 1)][plane]
            target, centre = [0.0] * 6, [0.0] * 6
            # Ends and centres of the plane, in program coordinates; the rest as it was.
            for values, (a, b, c) in ((target, (first, second, across)), (centre, (middle, other, across))):
                values[axes[0]], values[axes[1]], values[axes[2]] = a, b, c
            target[3:] = numbers[6:9]
            end, middle = place(target), place(centre)
            arm = [[point[axis] - middle[axis] for axis in axes[:2]] for point in (at, end)]
            radius = math.hypot(*arm[0])
            angle = math.atan2(arm[1][1], arm[1][0]) - math.atan2(arm[0][1], arm[0][0])
            angle = angle % (2 * math.pi) if turns > 0 else (-angle) % (2 * math.pi)
            if angle < 1e-5 * max(1.0, 1 / max(radius, 1e-6)):
                angle = 2 * math.pi
            angle += 2 * math.pi * (abs(turns) - 1)
            length = math.hypot(radius * angle, end[axes[2]] - at[axes[2]])
            motions.append(("arc", end, length, took(length, False)))
            at = end
    return motions, dwell, at


class Writer:
    """A random program whose motions stay within a few hundred millimetres."""

    def __init__(self, seed):
        self.pick, self.lines, self.labels, self.splines = random.Random(seed), [], 0, []

    def number(self, low, high):
        return f"{self.pick.uniform(low, high):.3f}"

    def say(self, text):
        self.lines.append(text)

    def cut(self):
        self.say(f"G1 X{self.number(-50, 50)} Y{self.number(-50, 50)} Z{self.number(-5, 5)} F{self.number(100, 900)}")

    def arc(self):
        """A half circle or less by its centre, in one of three planes, with turns and a rise now and then."""
        code, u, v, w, i, j = self.pick.choice([("G17", "X", "Y", "Z", "I", "J"), ("G18", "Z", "X", "Y", "K", "I"),
                                                ("G19", "Y", "Z", "X", "J", "K")])
        radius, start = self.pick.uniform(3, 30), self.pick.uniform(0, 2 * math.pi)
        sweep = self.pick.uniform(0.2, 5.5)
        left = self.pick.random() < 0.5
        stop = start + (sweep if left else -sweep)
        a = radius * math.cos(stop) - radius * math.cos(start)
        b = radius * math.sin(stop) - radius * math.sin(start)
        turns = f" P{self.pick.randint(2, 4)}" if self.pick.random() < 0.3 else ""
        rise = f" {w}{self.number(-3, 3)}" if self.pick.random() < 0.4 else ""
        centre = f"{i}{-radius * math.cos(start):.5f} {j}{-radius * math.sin(start):.5f}"
        if self.pick.random() < 0.25 and not turns:
            centre = f"R{radius if sweep < math.pi else -radius:.5f}"
        self.say(f"{code} G91\n{'G3' if left else 'G2'} {u}{a:.5f} {v}{b:.5f}{rise} {centre}{turns} F{self.number(100, 900)}\nG90 G17")

    def holes(self):
        cycle = self.pick.choice(["G81", "G82", "G83", "G73", "G85", "G89"])
        extra = {"G82": f" P{self.number(0, 1)}", "G89": f" P{self.number(0, 1)}", "G83": f" Q{self.number(0.7, 3)}",
                 "G73": f" Q{self.number(0.7, 3)}"}.get(cycle, "")
        self.say("G0 Z20")
        if self.pick.random() < 0.5:
            self.say(f"{self.pick.choice(['G98', 'G99'])} {cycle} X{self.number(0, 40)} Y{self.number(0, 40)} Z-6 R2{extra} F{self.number(50, 300)}")
            self.say(f"X{self.number(0, 40)}\nY{self.number(0, 40)}\nG80")
        else:
            self.say(f"G91 {cycle} X{self.number(1, 9)} Y{self.number(1, 9)} Z-8 R-15{extra} L{self.pick.randint(1, 4)} F{self.number(50, 300)}\nG80 G90")
        self.say("G0 Z30")

    def loop(self):
        self.labels += 1
        label, kind = 100 + self.labels, self.pick.randrange(3)
        if kind == 0:
            self.say(f"#1=0\no{label} while [#1 LT {self.pick.randint(1, 4)}]\nG1 X[10*COS[#1*40]] Y[5+#1] F500\n#1=[#1+1]\no{label} endwhile")
        elif kind == 1:
            self.say(f"o{label} repeat [{self.pick.randint(1, 4)}]\nG91 G1 X{self.number(1, 5)} F400\nG90\no{label} endrepeat")
        else:
            self.say(f"o{label} if [{self.pick.randint(0, 1)} EQ 1]\nG1 X1 Y1 F300\no{label} else\nG1 X2 Y3 F300\no{label} endif")

    def call(self):
        self.labels += 1
        label = 100 + self.labels
        self.lines.insert(0, f"o{label} sub\nG1 X#1 Y[#2/2] F#3\no{label} endsub")
        self.say(f"o{label} call [{self.number(-9, 9)}] [{self.number(-9, 9)}] [{self.number(100, 900)}]")

    def feeds(self):
        if self.pick.random() < 0.5:
            self.say(f"G93 G1 X{self.number(-20, 20)} F{self.number(1, 9)}\nG1 Y{self.number(-20, 20)} F{self.number(1, 9)}\nG94 F300")
        else:
            self.say(f"S{self.pick.randint(300, 2000)} M3\nG95 G1 X{self.number(-20, 20)} F{self.number(0.05, 0.5)}\nG94 F300")

    def offset(self):
        kind = self.pick.randrange(3)
        if kind == 0:
            self.say(f"G92 X{self.number(-9, 9)} Y{self.number(-9, 9)}")
            self.cut()
            self.say("G92.1\nG0 X0 Y0")
        elif kind == 1:
            self.say(f"G10 L2 P1 R{self.number(-90, 90)}\nG0 X0 Y0")
            self.cut()
            self.say("G10 L2 P1 R0\nG0 X0 Y0")
        else:
            self.say(f"G52 X{self.number(-9, 9)}\nG0 X0 Y0")
            self.cut()
            self.say("G52 X0\nG0 X0 Y0")

    def compensated(self):
        """Around a convex polygon, left or right of it."""
        self.say("G0 X-60 Y-60 Z5\nG0 Z-1")
        corners = sorted(self.pick.uniform(0, 2 * math.pi) for _ in range(self.pick.randint(3, 5)))
        if max(b - a for a, b in zip(corners, corners[1:] + [corners[0] + 2 * math.pi])) > 2.6:
            corners = [0.3, 1.9, 3.4, 4.8]
        side = self.pick.choice(["G41", "G42"])
        points = [(35 * math.cos(angle), 35 * math.sin(angle)) for angle in (corners[::-1] if side == "G41" else corners)]
        # In along the first edge, so that no corner stands where the cutter comes to the contour.
        dx, dy = points[1][0] - points[0][0], points[1][1] - points[0][1]
        far, near = [way / math.hypot(dx, dy) for way in (45, 15)]
        self.say(f"G0 X{points[0][0] - far * dx:.4f} Y{points[0][1] - far * dy:.4f}")
        self.say(f"{side} D1 G1 X{points[0][0] - near * dx:.4f} Y{points[0][1] - near * dy:.4f} F500")
        for x, y in points + points[:1]:
            self.say(f"G1 X{x:.4f} Y{y:.4f}")
        self.say("G40 G0 Z30")

    def rotary(self):
        self.say(f"G1 A{self.number(-90, 90)} F{self.number(300, 2000)}\nG1 X{self.number(-9, 9)} A0 F400")

    def bezier(self, points):
        """End and length of a spline by its control points: the speed along it, by Simpson's rule."""
        degree, count = len(points) - 1, 2000
        steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, points[1:])]

        def speed(u):
            level = steps
            while len(level) > 1:
                level = [((1 - u) * a[0] + u * b[0], (1 - u) * a[1] + u * b[1]) for a, b in zip(level, level[1:])]
            return degree * math.hypot(*level[0])

        weights = [1 if k in (0, count) else 4 if k % 2 else 2 for k in range(count + 1)]
        span = sum(weight * speed(k / count) for k, weight in enumerate(weights)) / (3 * count)
        self.splines.append((*points[-1], span))

    def spline(self):
        """Cubic splines in a row, the later ones with or without a first control point of their own, and a quadratic one."""
        draw = lambda low, high: round(self.pick.uniform(low, high), 3)
        at, back = (draw(-20, 20), draw(-20, 20)), None
        self.say(f"G17 G0 X{at[0]} Y{at[1]}")
        for _ in range(self.pick.randint(1, 3)):
            end, first, last = (at[0] + draw(20, 40), at[1] + draw(-20, 20)), (draw(2, 15), draw(-15, 15)), (draw(-15, -2), draw(-15, 15))
            end = tuple(round(value, 3) for value in end)
            words = f"I{first[0]} J{first[1]} "
            if back and self.pick.random() < 0.6:
                first, words = back, ""
            self.say(f"G5 {words}P{last[0]} Q{last[1]} X{end[0]} Y{end[1]} F{self.number(100, 900)}")
            self.bezier([at, (at[0] + first[0], at[1] + first[1]), (end[0] + last[0], end[1] + last[1]), end])
            at, back = end, (-last[0], -last[1])
        end, first = (round(at[0] + draw(-40, -20), 3), round(at[1] + draw(10, 20), 3)), (draw(-15, 15), draw(-9, 9))
        self.say(f"G5.1 I{first[0]} J{first[1]} X{end[0]} Y{end[1]} F{self.number(100, 900)}")
        self.bezier([at, (at[0] + first[0], at[1] + first[1]), end])

    def program(self):
        self.say(self.pick.choice(["G21", "G21", "G20"]) + " G17 G90 G94 G40 G64\nT1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z10")
        self.inch = "G20" in self.lines[-1]
        parts = [self.cut, self.arc, self.arc, self.holes, self.loop, self.call, self.feeds, self.offset, self.rotary, self.spline]
        if not self.inch:
            parts.append(self.compensated)
        for _ in range(self.pick.randint(3, 9)):
            self.pick.choice(parts)()
            if self.pick.random() < 0.15:
                self.say(f"G4 P{self.number(0, 2)}")
        self.say("M2")
        return "\n".join(self.lines) + "\n"


def moved(motions, tolerance):
    """Motions that go anywhere."""
    kept, at = [], [0.0] * 6
    for motion in motions:
        if math.dist(motion[1], at) > tolerance or (motion[0] == "arc" and motion[2] > tolerance):
            kept.append(motion)
        at = motion[1]
    return kept


def told(toolroom, path, *more):
    done = subprocess.run([toolroom, "--quiet", "program", str(path), "--json", *TOLD, *more], capture_output=True, text=True, timeout=120)
    if done.returncode:
        raise ValueError(done.stderr.strip())
    return json.loads(done.stdout)


def compare(one, other, tolerance):
    """What differs between two lists of motions."""
    one, other = moved(one, tolerance), moved(other, tolerance)
    # A spline is written as short lines: those up to its end are one motion again.
    whole, rest = [], list(other)
    for motion in one:
        if motion[0] == "spline" and rest:
            way, count = 0.0, 0
            while count < len(rest) and rest[count][0] == "line":
                way, count = way + rest[count][2], count + 1
                if math.dist(rest[count - 1][1], motion[1]) < 4 * tolerance:
                    break
            whole.append(("spline", rest[count - 1][1], way, 0.0))
            rest = rest[count:]
        else:
            whole += rest[:1]
            rest = rest[1:]
    other = whole + rest
    if len(one) != len(other):
        return [f"{len(one)} motions and {len(other)}"]
    wrong = []
    for index, (a, b) in enumerate(zip(one, other)):
        gap = math.dist(a[1], b[1])
        if a[0] != b[0] or gap > 4 * tolerance or abs(a[2] - b[2]) > 8 * tolerance + 1e-4 * a[2]:
            wrong.append(f"motion {index}: {a[0]} to {a[1]} over {a[2]:.4f}, and {b[0]} to {b[1]} over {b[2]:.4f}")
    return wrong[:3]


def check(rs274, toolroom, path, folder, tolerance=TOLERANCE, source=None, splines=()):
    """A program in LinuxCNC's words against what is read of it; `source` is what a post was written from."""
    wrong = []
    motions, dwell, end = canonical(rs274, path, folder, splines)
    written = folder / "written.ngc"
    known = told(toolroom, path, "--dialect", "linuxcnc", "--post", "linuxcnc", "--out", str(written))
    wrong += compare(motions, canonical(rs274, written, folder)[0], tolerance)
    feed = sum(motion[3] for motion in motions)
    # Canonical feeds have four decimals, and so have ends.
    if abs(known["feed_time [s]"] - feed) > 1e-3 + 1e-3 * feed:
        wrong.append(f"feed time {known['feed_time [s]']:.5f} s, {feed:.5f} s")
    if abs(known["dwell [s]"] - dwell) > 1e-3:
        wrong.append(f"dwell {known['dwell [s]']} s, {dwell} s")
    ends = [known["end [mm]"][axis] for axis in range(3)]
    wrong += [f"end {ends}, {end[:3]}" for _ in [0] if any(a is not None and abs(a - b) > 12 * tolerance for a, b in zip(ends, end))]
    if source:
        there = told(toolroom, source)
        if abs(there["feed_time [s]"] - feed) > 1e-3 + 1e-3 * feed:
            wrong.append(f"feed time {there['feed_time [s]']:.5f} s before, {feed:.5f} s posted")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("toolroom")
    parser.add_argument("--rs274", default=shutil.which("rs274"))
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--posts", type=pathlib.Path, help="folder of programs whose posts are tried instead")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for programs that are read otherwise")
    given = parser.parse_args()
    if not given.rs274 or not os.path.exists(given.rs274):
        print("left out: rs274 of LinuxCNC is not here (package linuxcnc-uspace)")
        return 0
    toolroom, bad, tried = os.path.abspath(given.toolroom), 0, 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if given.posts:
            cases = sorted(path for path in given.posts.iterdir() if path.suffix in (".nc", ".ngc", ".mpf", ".h"))
        else:
            cases = range(given.count)
        for case in cases:
            path, tolerance, source, splines = folder / "program.ngc", TOLERANCE, None, ()
            try:
                if given.posts:
                    done = subprocess.run([toolroom, "--quiet", "program", str(case), *TOLD, "--post", "linuxcnc", "--out", str(path)], capture_output=True, text=True, timeout=120)
                    if done.returncode:
                        print(f"{case.name}: not posted: {done.stderr.strip().splitlines()[0]}")
                        continue
                    source = case
                else:
                    writer = Writer(1000 * given.seed + case)
                    path.write_text(writer.program())
                    splines = writer.splines
                    tolerance *= 25.4 if writer.inch else 1.0
                wrong = check(given.rs274, toolroom, path, folder, tolerance, source, splines)
            except (ValueError, subprocess.TimeoutExpired) as error:
                wrong = [str(error)]
            tried += 1
            if wrong:
                bad += 1
                print(f"{case}: " + "; ".join(wrong))
                if given.keep:
                    given.keep.mkdir(parents=True, exist_ok=True)
                    shutil.copy(path, given.keep / f"{case if not given.posts else case.stem}.ngc")
    print(f"{tried} programs, {bad} read otherwise than by the interpreter of LinuxCNC")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
