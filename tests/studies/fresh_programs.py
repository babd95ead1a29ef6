"""Fresh part programs in six languages, timed by a second account of their moves.

    python tests/studies/fresh_programs.py TOOLROOM [--programs 10] [--seed 1]

Every program is a random series of moves, cycles, subprograms, loops and transformations. The account beside it follows the same series
by itself, from the definitions of the words and nothing of toolroom: time at feed, rapid time of the longest axis at 30 m/min, dwells,
way at feed, holes, and the end. Prints every program that differs, and ends with 1 where one does.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

RAPID = 500.0  # mm/s


class Account:
    """What a program has done up to now, in the coordinates of the workpiece, mm and s."""

    def __init__(self):
        self.at = [0.0, 0.0, 100.0]
        self.feed = self.rapid = self.dwell = self.way = 0.0
        self.holes = 0
        self.f = None
        self.lines = []

    def say(self, text):
        self.lines.append(text)

    def go(self, x=None, y=None, z=None):
        to = [a if b is None else b for a, b in zip(self.at, (x, y, z))]
        self.rapid += max(abs(a - b) for a, b in zip(to, self.at)) / RAPID
        self.at = to

    def cut(self, x=None, y=None, z=None, f=None):
        to = [a if b is None else b for a, b in zip(self.at, (x, y, z))]
        self.move(math.dist(to, self.at), f)
        self.at = to

    def move(self, way, f=None):
        self.feed += 60.0 * way / (f or self.f)
        self.way += way

    def arc(self, centre, turn, z=None):
        """A turn in degrees about a centre, positive to the left, down to z."""
        radius = math.hypot(self.at[0] - centre[0], self.at[1] - centre[1])
        angle = math.atan2(self.at[1] - centre[1], self.at[0] - centre[0]) + math.radians(turn)
        rise = 0.0 if z is None else z - self.at[2]
        self.move(math.hypot(radius * math.radians(abs(turn)), rise))
        self.at = [centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle), self.at[2] + rise]

    def hole(self, x, y, r, bottom, kind="drill", level=None, dwell=0.0, peck=None, clear=1.0):
        """A hole from the plane r, back to a level."""
        self.go(x, y)
        self.go(z=r)
        if kind == "peck":
            depth, done = r - bottom, 0.0
            while done < depth - 1e-9:
                step = min(peck, depth - done)
                if done > 0.0:
                    self.go(z=r)
                    self.go(z=r - done + clear)
                done += step
                self.cut(z=r - done)
            self.dwell += dwell
        else:
            self.cut(z=bottom)
            self.dwell += dwell
        if kind == "ream":
            self.cut(z=r)
        self.go(z=level if level is not None else r)
        self.holes += 1


def number(r, low, high, digits=2):
    return round(r.uniform(low, high), digits)


# --- moves that the languages of G codes share; `k` holds what differs


def lines(p, r, k):
    p.f = r.choice([200, 350, 600, 1000])
    for i in range(r.randint(1, 4)):
        x, y = number(r, -80, 80), number(r, -80, 80)
        p.cut(x, y)
        p.say(f"G1 X{x:.2f} Y{y:.2f}" + (f" F{p.f}" if i == 0 else ""))


def arc(p, r, k):
    radius, begin, turn = number(r, 3, 20), r.choice([0, 90, 180, 270]), r.choice([90, 180, 270, 360, -90, -180, -270, -360])
    centre = [p.at[0] - radius * math.cos(math.radians(begin)), p.at[1] - radius * math.sin(math.radians(begin))]
    i, j = centre[0] - p.at[0], centre[1] - p.at[1]
    p.f = p.f or 400
    z = None
    word = ""
    if r.random() < 0.4:
        z = round(p.at[2] - number(r, 0.5, 3), 3)
        word = f" Z{z:.3f}"
    p.arc(centre, turn, z)
    p.say(f"G{3 if turn > 0 else 2} X{p.at[0]:.6f} Y{p.at[1]:.6f}{word} {k['i'](i, j)} F{p.f}")


def radius_arc(p, r, k):
    """A quarter or three quarters by the radius."""
    radius, turn = number(r, 5, 25), r.choice([90, -90, 270, -270])
    begin = r.choice([0, 90, 180, 270])
    centre = [p.at[0] - radius * math.cos(math.radians(begin)), p.at[1] - radius * math.sin(math.radians(begin))]
    p.f = p.f or 400
    p.arc(centre, turn)
    size = radius if abs(turn) < 180 else -radius
    p.say(f"G{3 if turn > 0 else 2} X{p.at[0]:.6f} Y{p.at[1]:.6f} {k['r'](size)} F{p.f}")


def helix(p, r, k):
    radius, turns = number(r, 3, 12), r.randint(2, 5)
    z = round(p.at[2] - number(r, 2, 8), 3)
    centre = [p.at[0] - radius, p.at[1]]
    p.f = p.f or 300
    p.arc(centre, 360 * turns, z)
    p.say(f"G3 X{p.at[0]:.6f} Y{p.at[1]:.6f} Z{z:.3f} {k['i'](-radius, 0)} {k['turns'](turns)} F{p.f}")


def steps(p, r, k):
    p.f = r.choice([300, 500])
    p.say("G91")
    for _ in range(r.randint(1, 3)):
        x, y, z = number(r, -9, 9), number(r, -9, 9), number(r, -1, 1)
        p.cut(p.at[0] + x, p.at[1] + y, p.at[2] + z)
        p.say(f"G1 X{x:.2f} Y{y:.2f} Z{z:.2f} F{p.f}")
    p.say("G90")


def dwell(p, r, k):
    time = number(r, 0.1, 4)
    p.dwell += time
    p.say(k["dwell"](time))


def per_revolution(p, r, k):
    speed, f = r.choice([500, 800, 1200]), r.choice([0.1, 0.25])
    x = number(r, -60, 60)
    p.say(f"S{speed} M3")
    p.cut(x, f=speed * f)
    p.say(f"G95 G1 X{x:.2f} F{f}")
    p.f = 250
    p.say("G94 F250")


def holes(p, r, k):
    level = p.at[2]
    ref, bottom, f = round(number(r, 1, 5), 1), -number(r, 3, 30), r.choice([80, 120, 200])
    kind = r.choice(["drill", "peck", "ream"])
    # Above the plane of the cycle, as programs do.
    level = 40.0
    p.go(z=level)
    p.say(f"G0 Z{level}")
    p.f = f
    back = r.choice([98, 99])
    to = level if back == 98 else ref
    word = {"drill": 81, "peck": 83, "ream": 85}[kind]
    peck = number(r, 1, 6)
    first = True
    for _ in range(r.randint(1, 4)):
        x, y = number(r, -50, 50), number(r, -50, 50)
        if kind == "ream":
            p.go(x, y)
            p.go(z=ref)
            p.cut(z=bottom)
            p.cut(z=ref)
            p.go(z=to)
            p.holes += 1
        else:
            p.hole(x, y, ref, bottom, kind, to, peck=peck, clear=k["clear"])
        if first:
            p.say(f"G{back} G{word} X{x:.2f} Y{y:.2f} Z{bottom:.2f} R{ref:.1f}" + (f" Q{peck:.2f}" if kind == "peck" else "") + f" F{f}")
        else:
            p.say(f"X{x:.2f} Y{y:.2f}")
        first = False
    p.say("G80")
    p.go(z=60.0)
    p.say("G0 Z60.")


def turned(p, r, k):
    """Lines in coordinates that are turned about the origin."""
    angle = r.choice([30, 45, 90, -60])
    sin, cos = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    p.say(k["turn"](angle))
    p.f = 400
    for _ in range(2):
        x, y = number(r, -40, 40), number(r, -40, 40)
        p.cut(x * cos - y * sin, x * sin + y * cos)
        p.say(f"G1 X{x:.2f} Y{y:.2f} F400")
    p.say(k["straight"])
    # Both axes are named again, as controls ask for behind a turn.
    x, y = number(r, -40, 40), number(r, -40, 40)
    p.cut(x, y)
    p.say(f"G1 X{x:.2f} Y{y:.2f}")


def fanuc_loop(p, r, k):
    count, step = r.randint(2, 6), number(r, 1, 5)
    p.f = 500
    p.say(f"#1=0\nWHILE [#1 LT {count}] DO1\n#1=#1+1\nG91 G1 X{step:.2f} F500\nG90\nEND1")
    for _ in range(count):
        p.cut(p.at[0] + step)


def fanuc_macro(p, r, k):
    count, a = r.randint(2, 5), number(r, 2, 6)
    p.f = 300
    p.say(f"M98 P9{k['sub']} L{count}" if k["name"] == "haas" else f"M98 P{count:03d}09{k['sub']}")
    k["subs"].append(f"O09{k['sub']}\nG91 G1 Y{a:.2f} F300\nX-{a:.2f}\nG90 M99")
    k["sub"] += 1
    for _ in range(count):
        p.cut(p.at[0], p.at[1] + a)
        p.cut(p.at[0] - a)


def linux_loop(p, r, k):
    count, step = r.randint(2, 6), number(r, 1, 5)
    p.f = 500
    n = k["sub"]
    k["sub"] += 1
    p.say(f"#<n> = 0\no{n} while [#<n> LT {count}]\n#<n> = [#<n> + 1]\nG91 G1 X{step:.2f} F500\nG90\no{n} endwhile")
    for _ in range(count):
        p.cut(p.at[0] + step)


def siemens_loop(p, r, k):
    count, step = r.randint(2, 6), number(r, 1, 5)
    p.f = 500
    p.say(f"R1=0\nWHILE R1<{count}\nR1=R1+1\nG1 X=IC({step:.2f}) F500\nENDWHILE")
    for _ in range(count):
        p.cut(p.at[0] + step)


def siemens_holes(p, r, k):
    rfp, sdis, bottom, dwell = 0, number(r, 1, 4, 1), -number(r, 5, 20), number(r, 0.2, 1.5)
    p.f = 150
    p.say(f"F150\nMCALL CYCLE82(30,{rfp},{sdis},{bottom:.2f},,{dwell:.2f})")
    p.go(z=60.0)
    p.lines.insert(len(p.lines) - 1, "G0 Z60")
    for _ in range(r.randint(1, 4)):
        x, y = number(r, -50, 50), number(r, -50, 50)
        p.go(x, y)
        p.go(z=rfp + sdis)
        p.cut(z=bottom)
        p.dwell += dwell
        p.go(z=30.0)
        p.holes += 1
        p.say(f"G0 X{x:.2f} Y{y:.2f}")
    p.say("MCALL")


MILL = [lines, arc, radius_arc, helix, steps, dwell, per_revolution]


def iso(r, name):
    p = Account()
    k = {"name": name, "sub": 10, "subs": [], "clear": 0.254 if name == "linuxcnc" else 1.0}
    k["i"] = lambda i, j: f"I{i:.6f} J{j:.6f}"
    k["r"] = lambda radius: f"R{radius:.2f}"
    k["turns"] = lambda n: f"{'L' if name == 'fanuc' else 'P'}{n}"
    k["dwell"] = lambda t: f"G4 P{round(1000 * t)}" if name != "linuxcnc" else f"G4 P{t:.2f}"
    kinds = MILL + [holes, holes]
    if name == "linuxcnc":
        kinds += [linux_loop]
        p.say("#<n> = 0")
        p.say("G21 G90 G17 G94")
    else:
        k["turn"], k["straight"] = lambda a: f"G68 X0 Y0 R{a}.", "G69"
        kinds += [fanuc_loop, fanuc_macro, turned]
        p.say("%\nO00100" if name == "haas" else "%\nO0100")
        p.say("G21 G90 G17 G94")
    p.say("T1 M6\nS1000 M3\nG0 X0 Y0 Z60.")
    p.go(0.0, 0.0, 60.0)
    for kind in r.sample(kinds, 6):
        kind(p, r, k)
    if name == "haas":
        x = number(r, 1, 9)
        p.say("M97 P900 L2\nM30\nN900 G91 G1 X%.2f F300\nG90\nM99" % x)
        for _ in range(2):
            p.cut(p.at[0] + x, f=300)
        p.lines += k["subs"]
    else:
        p.say("M2" if name == "linuxcnc" else "M30")
        p.lines += k["subs"]
    if name != "linuxcnc":
        p.say("%")
    return p, {"fanuc": ".nc", "haas": ".nc", "linuxcnc": ".ngc"}[name]


def siemens(r):
    p = Account()
    k = {"sub": 1, "clear": 1.0}
    k["i"] = lambda i, j: f"I{i:.6f} J{j:.6f}"
    k["r"] = lambda radius: f"CR={radius:.2f}"
    k["turns"] = lambda n: f"TURN={n - 1}"
    k["dwell"] = lambda t: f"G4 F{t:.2f}"
    k["turn"], k["straight"] = lambda a: f"ROT RPL={a}", "ROT"
    p.say("G71 G90 G17 G94\nR1=0\nT1 D1\nM6\nS1000 M3\nG0 X0 Y0 Z60")
    p.go(0.0, 0.0, 60.0)
    for kind in r.sample(MILL + [siemens_loop, siemens_holes, turned, siemens_loop], 6):
        kind(p, r, k)
    p.say("M30")
    return p, ".mpf"


def heidenhain(r):
    p = Account()
    p.say("BEGIN PGM TEST MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+60 R0 FMAX M3")
    p.go(0.0, 0.0, 60.0)
    w = lambda v: f"{v:+.6f}"
    tail = []

    def line():
        p.f = r.choice([300, 700])
        x, y = number(r, -60, 60), number(r, -60, 60)
        p.cut(x, y)
        p.say(f"L X{w(x)} Y{w(y)} F{p.f}")

    def step():
        p.f = r.choice([300, 700])
        x, z = number(r, -20, 20), number(r, -3, 3)
        p.cut(p.at[0] + x, None, p.at[2] + z)
        p.say(f"L IX{w(x)} IZ{w(z)} F{p.f}")

    def circle():
        p.f = p.f or 500
        radius, turn = number(r, 4, 20), r.choice([90, 180, 270, -90, -180, -270])
        centre = [p.at[0] - radius, p.at[1]]
        p.arc(centre, turn)
        p.say(f"CC X{w(centre[0])} Y{w(centre[1])}\nC X{w(p.at[0])} Y{w(p.at[1])} DR{'+' if turn > 0 else '-'} F{p.f}")

    def by_radius():
        p.f = p.f or 500
        radius, turn = number(r, 4, 20), r.choice([90, 270, -90, -270])
        p.arc([p.at[0] - radius, p.at[1]], turn)
        size = radius if abs(turn) < 180 else -radius
        p.say(f"CR X{w(p.at[0])} Y{w(p.at[1])} R{w(size)} DR{'+' if turn > 0 else '-'} F{p.f}")

    def helix_polar():
        p.f = p.f or 500
        radius, turn, z = number(r, 3, 12), r.choice([720, 900, 1080, -720]), -number(r, 2, 9)
        centre = [p.at[0] - radius, p.at[1]]
        p.arc(centre, turn, p.at[2] + z)
        p.say(f"CC X{w(centre[0])} Y{w(centre[1])}\nCP IPA{turn:+d} IZ{w(z)} DR{'+' if turn > 0 else '-'} F{p.f}")

    def drill():
        ref, depth, dwell, second = number(r, 1, 3, 1), number(r, 4, 20), number(r, 0, 1), 30
        p.go(z=60.0)
        p.say("L Z+60 FMAX")
        p.say(f"CYCL DEF 200 DRILLING Q200={ref} Q201=-{depth} Q206=150 Q202={depth} Q210=0 Q203=+0 Q204={second} Q211={dwell}")
        for _ in range(r.randint(1, 3)):
            x, y = number(r, -50, 50), number(r, -50, 50)
            p.go(x, y)
            p.say(f"L X{w(x)} Y{w(y)} R0 FMAX M99")
            p.go(z=ref)
            p.cut(z=-depth, f=150)
            p.dwell += dwell
            p.go(z=max(ref, second))
            p.holes += 1

    def repeat():
        n, count, x = len(tail) + 1, r.randint(1, 4), number(r, 1, 8)
        tail.append(n)
        p.f = 400
        p.say(f"LBL {n}\nL IX{w(x)} F400\nCALL LBL {n} REP {count}")
        for _ in range(count + 1):
            p.cut(p.at[0] + x)

    def q_loop():
        n, count, y = len(tail) + 1, r.randint(2, 5), number(r, 1, 8)
        tail.append(n)
        p.f = 400
        p.say(f"Q1 = 0\nLBL {n}\nQ1 = Q1 + 1\nL IY{w(y)} F400\nFN 12: IF +Q1 LT +{count} GOTO LBL {n}")
        for _ in range(count):
            p.cut(None, p.at[1] + y)

    def wait():
        time = number(r, 0.2, 3)
        p.dwell += time
        p.say(f"CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL {time}")

    for kind in r.sample([line, step, circle, by_radius, helix_polar, drill, repeat, q_loop, wait], 6):
        kind()
    p.say("M30\nEND PGM TEST MM")
    return p, ".h"


def lathe(r):
    """X is a diameter in the program and a radius in the account."""
    p = Account()
    p.at = [0.0, 0.0, 100.0]
    p.say("%\nO0100\nG21 G18 G99 G40\nG50 S3000\nT0101\nG0 X100. Z5.")
    p.go(50.0, None, 5.0)
    state = {"surface": None, "speed": 800.0}
    p.say("G97 S800 M3")

    def spin(r0, r1, way, f):
        """Time of a straight way at the speed in force."""
        if state["surface"] is None:
            return 60.0 * way / (f * state["speed"])
        v, top = 1000.0 * state["surface"], 3000.0
        bound = v / (2 * math.pi * top)
        low, high = min(r0, r1), max(r0, r1)
        if high <= bound:
            return 60.0 * way / (f * top)
        if low >= bound or high == low:
            return 60.0 * 2 * math.pi * 0.5 * (low + high) * way / (f * v)
        share = (high - bound) / (high - low)
        return 60.0 * (2 * math.pi * 0.5 * (bound + high) * share * way / (f * v) + (1 - share) * way / (f * top))

    def cut(x, z, f):
        to = [p.at[0] if x is None else x, 0.0, p.at[2] if z is None else z]
        way = math.dist(to, p.at)
        p.feed += spin(p.at[0], to[0], way, f)
        p.way += way
        p.at = to

    def turn():
        x, f, z = number(r, 20, 45), r.choice([0.1, 0.2, 0.3]), -number(r, 10, 60)
        p.go(x, None, 3.0)
        p.say(f"G0 X{2 * x:.2f} Z3.")
        cut(None, z, f)
        p.say(f"G1 Z{z:.2f} F{f}")
        cut(x + 2.0, None, f)
        p.say("U4.")

    def face():
        f = r.choice([0.1, 0.25])
        x = number(r, 15, 40)
        p.go(x, None, 0.0)
        p.say(f"G0 X{2 * x:.2f} Z0")
        cut(1.0, None, f)
        p.say(f"G1 X2. F{f}")
        p.go(None, None, 4.0)
        p.say("G0 W4.")

    def cone():
        f, x, w = r.choice([0.1, 0.2]), number(r, 2, 8), number(r, 5, 20)
        cut(p.at[0] + x, p.at[2] - w, f)
        p.say(f"G1 U{2 * x:.2f} W{-w:.2f} F{f}")

    def constant():
        state["surface"] = r.choice([120, 180, 220])
        p.say(f"G96 S{state['surface']}")

    def fixed():
        state["surface"], state["speed"] = None, r.choice([600.0, 900.0])
        p.say(f"G97 S{state['speed']:.0f}")

    def box():
        """G90: in at rapid, along, out, back."""
        f, z = r.choice([0.15, 0.3]), -number(r, 10, 40)
        p.go(45.0, None, 2.0)
        p.say("G0 X90. Z2.")
        for i, x in enumerate((44.0, 42.5, 41.0)[: r.randint(1, 3)]):
            p.go(x)
            cut(None, z, f)
            cut(45.0, None, f)
            p.go(None, None, 2.0)
            p.say(f"G90 X{2 * x:.1f} Z{z:.2f} F{f}" if i == 0 else f"X{2 * x:.1f}")
        p.say("G0 X92.")
        p.go(46.0)

    def wait():
        time = number(r, 0.2, 2)
        p.dwell += time
        p.say(f"G4 U{time:.2f}")

    def per_minute():
        f = r.choice([100, 240])
        z = p.at[2] - 5.0
        p.say(f"G98 G1 W-5. F{f}")
        p.move(5.0, f)
        p.at[2] = z
        p.say("G99")

    for kind in r.sample([turn, face, cone, constant, fixed, box, wait, per_minute, turn, face], 7):
        kind()
    p.say("M30\n%")
    p.at[0] *= 2.0
    return p, ".nc"


DIALECTS = {
    "fanuc": lambda r: iso(r, "fanuc"), "haas": lambda r: iso(r, "haas"), "linuxcnc": lambda r: iso(r, "linuxcnc"),
    "siemens": siemens, "heidenhain": heidenhain, "fanuc-lathe": lathe,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("toolroom")
    parser.add_argument("--programs", type=int, default=10, help="of each language")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    wrong = total = 0
    with tempfile.TemporaryDirectory() as folder:
        for dialect, make in DIALECTS.items():
            for index in range(args.programs):
                p, ending = make(random.Random(f"{dialect} {args.seed} {index}"))
                path = pathlib.Path(folder) / f"{dialect}-{index}{ending}"
                path.write_text("\n".join(p.lines) + "\n")
                ran = subprocess.run([args.toolroom, "program", path, "--dialect", dialect, "--start", "0,0,100 mm", "--json"], capture_output=True, text=True)
                told = json.loads(ran.stdout or "{}")
                total += 1
                pairs = {"feed_time [s]": p.feed, "rapid_time [s]": p.rapid, "dwell [s]": p.dwell, "feed_length [mm]": p.way, "holes": p.holes}
                off = [f"{key} {told.get(key)} for {value:.6f}" for key, value in pairs.items() if abs(told.get(key, math.inf) - value) > 1e-5 * max(1.0, abs(value))]
                end = told.get("end [mm]") or [math.inf] * 3
                if max(abs(a - b) for a, b in zip(end, p.at)) > 1e-4:
                    off.append(f"end {end} for {p.at}")
                if off:
                    wrong += 1
                    print(f"{dialect} {index}: {'; '.join(off)}\n{ran.stderr.strip()[:600]}\n{path.read_text()}")
    print(f"{total} programs, {wrong} differ")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
