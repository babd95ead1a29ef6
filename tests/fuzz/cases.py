"""What tests/fuzz/mutate.py spoils: every verb and every kind of file, with an input that the verb takes as it is.

Inputs that only the program can write (units, snapshots, plans, parts, diagnoses) are made by it before the first mutation.
"""

import math
import pathlib
import re
import struct
import subprocess
import tempfile
import wave

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENARIOS = ROOT / "scenarios"
SHORT = ["--replications", "1", "--set", 'shop.horizon="1 h"', "--set", 'shop.warm_up="0 h"']
# Kinds whose samples in scenarios/new are not the only ones worth spoiling have further cases of their own.
DONE = ["run.json", "study.json", "summary.json", "kpi.csv"]  # what report and diff read of a finished run
EFFECTS = b"""schema = 1
[[effect]]
id = "my.crater"
title = "crater weakens the edge in fast cuts"
process = ["turning"]
size = { unit = "1", ordinary = 0.1, range = [0.0, 2.0] }
shape = { reference_speed = { value = "200 m/min", range = ["60 m/min", "400 m/min"], fit = true } }
changes = [{ term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm) * (cutting_speed / reference_speed)^1.5" }]
"""
BALL = (
    b"G21 G90\nT1 M6\nS8000 M3\nG0 X-10. Y20. Z5.\nZ-2.\nG1 X70. F800.\nG3 X60. Y30. I-10. Z-1.\nG0 Z50.\nM30\n",
    b"""schema = 1
[stock]
box = [["0 mm", "0 mm", "-20 mm"], ["60 mm", "40 mm", "0 mm"]]
resolution = "0.5 mm"
[[tool]]
number = 1
diameter = "10 mm"
teeth = 2
length = "40 mm"
parameter_set = "mill_t15k6_d32"
shape = "bull"
corner_radius = "2 mm"
""",
)
NASA = b"""case,run,VB,time,DOC,feed,material,cut_no
1,1,0.1,2,1.5,0.5,1,0
1,2,,4,1.5,0.5,1,1
2,1,0.3,3,0.75,0.25,2,2
"""
CUTS = b"""spindle_speed [rpm],depth_of_cut [mm],chatter
5000,0.3,0
5000,1.5,1
8000,0.4,0
8000,2.0,1
"""


def drawing():
    """The outline of a plate of four lines, as DXF."""
    def line(x, y, to_x, to_y):
        pairs = ((10, x), (20, y), (11, to_x), (21, to_y))
        return "0\nLINE\n8\nWALL\n" + "".join(f"{code}\n{value}\n" for code, value in pairs)
    sides = [line(0, 0, 120, 0), line(120, 0, 120, 80), line(120, 80, 0, 80), line(0, 80, 0, 0)]
    return ("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
            + "".join(sides) + "0\nENDSEC\n0\nEOF\n").encode()


def runs():
    """A table of runs as the test bed of NIST publishes it."""
    rows = ["machine,day,hour,prog,mode,act,nom,hold,tc,nhold"]
    rows += [f"M1,2017-05-{1 + i % 28:02},8,103,AUTOMATIC,{600 + i},590,0,3,0" for i in range(40)]
    return "\n".join(rows).encode()


def universal():
    """A frequency response as a universal file, dataset 58."""
    values = []
    for line in range(320):
        f = 300.0 + 2.0 * line
        h = 1.0 / (20.0e6 * (1 - (f / 612.0) ** 2 + 2j * 0.03 * f / 612.0))
        values += [h.real, h.imag]
    lines = ["    -1", "    58", "frf", "NONE", "01-Jan-26 00:00:00", "NONE", "NONE",
             "    4         0    0         0 tip                 1   1 tip                 1   1",
             "         5       320         1  3.00000e+02  2.00000e+00  0.00000e+00",
             "        18    0    0    0 Frequency            Hz                  ",
             "         8    0    0    0 Displacement         m                   ",
             "        13    0    0    0 Force                N                   ",
             "         0    0    0    0 NONE                 NONE                "]
    lines += ["".join(f"{value:13.5e}" for value in values[i:i + 6]) for i in range(0, len(values), 6)]
    return ("\n".join([*lines, "    -1"]) + "\n").encode()


def made(program, folder):
    """Inputs that the program writes itself, as bytes by name; what it could not make is left out, and reported by its name."""
    def run(*arguments):
        done = subprocess.run([program, *map(str, arguments), "--quiet"], cwd=folder, capture_output=True, check=False)
        return done.returncode == 0
    shop = SCENARIOS / "template.toml"
    wear = SCENARIOS / "new/wear.csv"
    run("fmu", "export", "turning", "--fmi", "3", "--out", "turning.fmu")
    run("ssp", "export", SCENARIOS / "lathe-cell.toml", "--machine", "L", "--out", "cell.ssp")
    run("run", shop, *SHORT, "--snapshot-at", "0.5 h", "--snapshot", "s.trs")
    run("compare", shop, "--replications", "2", *SHORT[2:], "--plan", "plan.json", "--shards", "2")
    run("shard", "plan.json", "0", "--out", "parts")
    run("shard", "plan.json", "1", "--out", "parts")
    (folder / "frf.csv").write_bytes(responses())
    run("modes", "frf.csv", "--averages", "5", "--out", "spindle.toml")
    run("life", SCENARIOS / "life/constant.toml", "--lives", "20", "--plan", "life.json", "--shards", "2")
    run("lobes", SCENARIOS / "chatter/turning-bar.toml", "--set", "chart.columns=6", "--set", "chart.rows=4", "--plan",
        "lobes.json", "--shards", "2")
    run("new", "gap", "gap")
    run("import", "csv", "gap/log.csv", "--map", "gap/map.toml", "--out", "gap/records")
    run("gap", "diagnose", "--model", "gap/turning.toml", "--data", "gap/records", "--out", "gap/found")
    run("gap", "watch", "--model", SCENARIOS / "gap/turning.toml", "--data", wear, "--state", "watch.json")
    run("run", shop, *SHORT, "--out", "done")
    run("run", SCENARIOS / "gap/shop.toml", *SHORT[:2], "--set", 'shop.horizon="24 h"', "--out", "out", "--records", "rec")
    names = ["turning.fmu", "cell.ssp", "s.trs", "plan.json", "parts/part-000000.json", "parts/part-000001.json", "spindle.toml", "life.json", "lobes.json",
             "gap/records/operations.csv", "gap/found/diagnosis.json", "watch.json", "done/run.json", "done/study.json", "done/summary.json",
             "done/kpi.csv", "rec/events.csv"]
    there = {name: (folder / name).read_bytes() for name in names if (folder / name).is_file()}
    for name in names:
        if name not in there:
            print(f"left out: cases of {name}, which the program did not write")
    return there


def case(name, arguments, *files):
    return name, [(pathlib.PurePath(to), SCENARIOS / of if isinstance(of, str) else of) for to, of in files], arguments


def responses():
    """Frequency responses of one mode, as a table."""
    rows = ["frequency [Hz],real [um/N],imag [um/N],coherence"]
    for line in range(150):
        f = 300.0 + 4.0 * line
        h = 1.0 / (20.0 * (1 - (f / 612.0) ** 2 + 2j * 0.03 * f / 612.0))
        rows.append(f"{f},{h.real:.6g},{h.imag:.6g},0.99")
    return "\n".join(rows).encode()


def taps():
    """Taps on a blank at two points, of one mode, as a table."""
    rows = ["frequency [Hz],11.real [um/N],11.imag [um/N],11.coherence,21.real [um/N],21.imag [um/N],21.coherence"]
    for line in range(150):
        f = 300.0 + 4.0 * line
        h = 1.0 / (20.0 * (1 - (f / 612.0) ** 2 + 2j * 0.03 * f / 612.0))
        rows.append(f"{f},{h.real:.6g},{h.imag:.6g},0.99,{0.8 * h.real:.6g},{0.8 * h.imag:.6g},0.99")
    return "\n".join(rows).encode()


def sound():
    """A second of a tone with its harmonics, as WAV."""
    with tempfile.NamedTemporaryFile(suffix=".wav") as file:
        with wave.open(file.name, "wb") as out:
            out.setparams((1, 2, 8000, 0, "NONE", ""))
            out.writeframes(b"".join(
                struct.pack("<h", int(sum(size * math.sin(2 * math.pi * f * i / 8000) for size, f in
                                          ((500, 125), (6000, 500), (3000, 1000), (1500, 1500), (3000, 811)))))
                for i in range(8000)))
        return pathlib.Path(file.name).read_bytes()


def adapter():
    """A few lines of a machine's log."""
    lines = []
    for second in range(60):
        state = "ACTIVE" if second % 20 > 3 else "READY"
        lines.append(f"2026-01-05T08:{second // 60:02}:{second % 60:02}.000Z|execution|{state}|program|O1001|line|{second % 12}")
    return "\n".join(lines).encode()


SHIPPED = [
    case("check-scenario", ["check", "s.toml"], ("s.toml", "template.toml")),
    case("check-orders", ["check", "o.toml"], ("o.toml", "shop/orders.toml"), ("orders.csv", "shop/orders.csv")),
    case("check-several", ["check", "c.toml", "l.toml", "m.toml", "--json"], ("c.toml", "grinding/cycle.toml"),
         ("l.toml", "chatter/milling-slot.toml"), ("m.toml", "new/map.toml")),
    case("check-cell", ["check", "o.toml", "--json"], ("o.toml", "shop/cell.toml")),
    case("check-line", ["check", "o.toml"], ("o.toml", "shop/line.toml")),
    case("check-lobes", ["check", "c.toml", "--json"], ("c.toml", "chatter/milling-slot.toml")),
    case("check-chuck", ["check", "c.toml"], ("c.toml", "chuck-fig3.toml")),
    case("check-structure", ["check", "c.toml"], ("c.toml", "chatter/spindle.toml")),
    case("check-tool", ["check", "c.toml"], ("c.toml", "chatter/endmill12.toml")),
    case("check-life", ["check", "l.toml"], ("l.toml", "life/policies.toml")),
    case("check-cycle", ["check", "c.toml"], ("c.toml", "grinding/cycle.toml")),
    case("check-contour", ["check", "c.toml"], ("c.toml", "contour/cam.toml")),
    case("check-setup", ["check", "c.toml"], ("c.toml", "new/setup.toml")),
    case("check-mapping", ["check", "m.toml", "--json"], ("m.toml", "new/map.toml")),
    case("check-gap", ["check", "g.toml", "--kind", "gap"], ("g.toml", "gap/turning.toml")),
    case("check-program-model", ["check", "g.toml"], ("g.toml", "gap/program.toml")),
    case("check-set", ["check", "p.toml"], ("p.toml", "parameters/own/our-42crmo4.toml")),
    case("compare", ["compare", "s.toml", "--out", "out", *SHORT], ("s.toml", "template.toml")),
    case("run-orders", ["run", "o.toml", "--out", "out", "--replications", "1"],
         ("o.toml", "shop/orders.toml"), ("orders.csv", "shop/orders.csv")),
    case("run", ["run", "s.toml", "--out", "out", "--records", "rec", *SHORT], ("s.toml", "demo.toml")),
    case("run-line", ["run", "s.toml", "--out", "out", "--replications", "1"], ("s.toml", "shop/line.toml")),
    case("run-queue", ["run", "s.toml", "--out", "out", *SHORT], ("s.toml", "shop/queue.toml")),
    case("life", ["life", "l.toml", "--out", "out", "--lives", "20"], ("l.toml", "life/constant.toml")),
    case("life-fit", ["life", "--fit", "lives.csv", "--out", "out", "--bootstrap", "20", "--goodness", "19"],
         ("lives.csv", b"life [min],censored,group\n" + b"\n".join(b"%d,%d,a" % (20 + i % 7, i % 5 == 0) for i in range(20)))),
    case("lobes-at", ["lobes", "c.toml", "--at", "5000 rpm", "0.5 mm"], ("c.toml", "chatter/milling-slot.toml")),
    case("lobes", ["lobes", "c.toml", "--out", "out", "--set", "chart.columns=6", "--set", "chart.rows=4"],
         ("c.toml", "chatter/turning-bar.toml")),
    case("swap", ["swap", "b.toml", "--tool", "t.toml", "--out", "o.toml", "--range", "400 Hz", "900 Hz"],
         ("b.toml", "chatter/spindle.toml"), ("t.toml", "chatter/endmill12.toml")),
    case("swap-blank", ["swap", "taps.csv", "--blank", "steel d=16 mm L=40 mm", "--second", "25 mm", "--tool", "t.toml",
                        "--measured", "frf.csv", "--fit-joint", "--accept-refused", "--out", "o.toml"],
         ("taps.csv", taps()), ("t.toml", "chatter/endmill12.toml"), ("frf.csv", responses())),
    case("modes", ["modes", "frf.csv", "--out", "o.toml"], ("frf.csv", responses())),
    case("listen", ["listen", "cut.wav", "--teeth", "4", "--speed", "7500 rpm"], ("cut.wav", sound())),
    case("grind", ["grind", "c.toml", "--out", "out"], ("c.toml", "grinding/cycle.toml")),
    case("contour", ["contour", "c.toml", "--out", "out", "--draws", "2"], ("c.toml", "contour/cam.toml")),
    case("contour-gcode", ["contour", "c.toml", "--gcode", "p.nc", "--out", "out", "--draws", "2"],
         ("c.toml", "new/setup.toml"), ("p.nc", "new/part.nc")),
    case("program", ["program", "p.nc", "--blocks", "b.csv"], ("p.nc", "gap/programs/plate.nc")),
    case("identify", ["identify", "t.csv", "--out", "out"], ("t.csv", "data/zb153u_trials.csv")),
    case("calibrate-life", ["calibrate", "turning", "--life", "15 min", "--at", "200 m/min", "--out", "o.toml"]),
    case("calibrate-data", ["calibrate", "turning", "--model", "c45_t15k6", "--data", "w.csv", "--limit", "0.3 mm", "--law",
                            "extended_taylor", "--out", "o.toml"], ("w.csv", "new/wear.csv")),
    case("point", ["point", "turning", "--tool", "./p.toml", "--set", "cutting_speed=200 m/min", "--json"],
         ("p.toml", "parameters/own/our-42crmo4.toml")),
    case("point-milling", ["point", "milling", "--set", "cutting_speed=200 m/min", "--advance", "10 s"]),
    case("point-infeed", ["point", "infeed", "--set", "infeed_per_rev=4.43 um/rev", "--advance", "3 s"]),
    case("import-csv", ["import", "csv", "log.csv", "--map", "map.toml", "--out", "out"],
         ("log.csv", "new/log.csv"), ("map.toml", "new/map.toml")),
    case("import-shop", ["import", "shop", "--map", "map.toml", "--out", "shop.toml", "--check"],
         *((name, f"new/shop/{name}") for name in ("map.toml", "base.toml", "orders.csv", "routings.csv", "machines.csv", "people.csv"))),
    case("import-mtconnect", ["import", "mtconnect", "m.shdr", "--out", "out"], ("m.shdr", adapter())),
    case("gap-diagnose", ["gap", "diagnose", "--model", "g.toml", "--data", "w.csv", "--out", "out"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-empirical", ["gap", "diagnose", "--model", "g.toml", "--data", "w.csv", "--json"],
         ("g.toml", b"schema = 1\n[gap]\nprocess = \"empirical\"\n"), ("w.csv", "new/wear.csv")),
    case("new", ["new", "gap", "there"]),
    case("explain", ["explain", "quantity"]),
    case("schema", ["schema", "life"]),
    case("check-effects", ["check", "e.toml"], ("e.toml", EFFECTS)),
    case("check-machine", ["check", "m.toml"], ("m.toml", "machines/vmc.toml")),
    case("check-stock", ["check", "p.toml"], ("p.toml", "programs/plate-setup.toml")),
    case("check-coefficients", ["check", "a.toml"], ("a.toml", "chatter/al7075.toml")),
    case("check-shop-mapping", ["check", "m.toml"], ("m.toml", "new/shop/map.toml")),
    case("check-flexible", ["check", "s.toml"], ("s.toml", "shop/flexible-cell.toml")),
    case("demo", ["demo", "--out", "out", *SHORT, "--policy", "productivity"]),
    case("sweep", ["compare", "s.toml", *SHORT, "-P", "machine.L.load_time", "30 s", "60 s", "30 s"], ("s.toml", "template.toml")),
    case("tune", ["compare", "s.toml", "--out", "out", *SHORT, "--tune", "--set", "tune.budget=100"], ("s.toml", "template.toml")),
    case("plan", ["compare", "s.toml", *SHORT, "--plan", "out/p.json", "--shards", "2"], ("s.toml", "template.toml")),
    case("variants", ["compare", "o.toml", "--out", "out", "--replications", "2"], ("o.toml", "shop/lots.toml")),
    case("plan-variants", ["compare", "o.toml", "--replications", "2", "--plan", "out/p.json", "--shards", "2"], ("o.toml", "shop/lots.toml")),
    case("run-cell", ["run", "s.toml", "--out", "out", "--replications", "1"], ("s.toml", "shop/flexible-cell.toml")),
    case("run-job-shop", ["run", "s.toml", "--out", "out", "--replications", "1"], ("s.toml", "shop/ft06.toml")),
    case("run-furnace", ["run", "s.toml", "--out", "out", *SHORT], ("s.toml", "shop/furnace.toml")),
    case("run-chatter", ["run", "s.toml", "--out", "out", *SHORT], ("s.toml", "chatter-policies.toml"), ("chatter/endmill.toml", "chatter/endmill.toml"),
         ("chatter/shaft.toml", "chatter/shaft.toml")),
    case("run-contour", ["run", "s.toml", "--out", "out", *SHORT], ("s.toml", "grinder-bottleneck.toml")),
    case("trace", ["run", "s.toml", "--out", "out", *SHORT, "--trace", "0 h", "0.2 h"], ("s.toml", "template.toml")),
    case("snapshot", ["run", "s.toml", *SHORT, "--snapshot-at", "0.5 h", "--snapshot", "out/s.trs"], ("s.toml", "template.toml")),
    case("life-plan", ["life", "l.toml", "--lives", "20", "--plan", "out/p.json", "--shards", "2"], ("l.toml", "life/early.toml")),
    case("lobes-best", ["lobes", "c.toml", "--best", "--show", "power", "--out", "out", "--set", "chart.columns=6", "--set", "chart.rows=4"],
         ("c.toml", "chatter/side-milling.toml"), ("al7075.toml", "chatter/al7075.toml")),
    case("lobes-robust", ["lobes", "c.toml", "--robust", "0.5 mm", "--out", "out", "--set", "chart.columns=4", "--set", "chart.rows=3"],
         ("c.toml", "chatter/milling-slot.toml")),
    case("import-frf", ["import", "frf", "frf.csv", "--coherence", "c.csv", "--out", "o.csv"], ("frf.csv", responses()),
         ("c.csv", b"frequency [Hz],coherence\n" + b"".join(b"%d,0.9\n" % (300 + 4 * i) for i in range(150)))),
    case("lobes-helix", ["lobes", "c.toml", "--helix", "9000 rpm", "9100 rpm", "--set", "chart.rows=4"],
         ("c.toml", "chatter/milling-slot.toml")),
    case("modes-uff", ["modes", "t.uff", "--out", "o.toml"], ("t.uff", universal())),
    case("coefficients", ["coefficients", "f.csv", "--teeth", "2", "--depth", "2 mm", "--out", "o.toml"],
         ("f.csv", "data/slot-al7075.csv")),
    case("coefficients-group", ["coefficients", "--group", "6", "--chip-thickness", "0.08 mm", "--out", "o.toml"]),
    case("contour-dxf", ["contour", "c.toml", "--dxf", "p.dxf", "--out", "out", "--draws", "2"],
         ("c.toml", "new/setup.toml"), ("p.dxf", drawing())),
    case("contour-lobed", ["contour", "c.toml", "--out", "out", "--draws", "2"], ("c.toml", "contour/rk3.toml")),
    case("program-drives", ["program", "p.nc", "--drives", "m.toml"], ("p.nc", "programs/plate.nc"), ("m.toml", "machines/vmc.toml")),
    case("program-stock", ["program", "p.nc", "--setup", "s.toml"], ("p.nc", "programs/plate.nc"), ("s.toml", "programs/plate-setup.toml")),
    case("program-feeds", ["program", "p.nc", "--setup", "s.toml", "--objective", "cost", "--post", "haas", "--out", "o.nc"],
         ("p.nc", "programs/plate.nc"), ("s.toml", "programs/plate-setup.toml")),
    case("program-report", ["program", "p.nc", "--setup", "s.toml", "--objective", "time", "--speeds", "--report", "r.html", "--drawing", "d.dxf"],
         ("p.nc", "programs/plate.nc"), ("s.toml", "programs/plate-setup.toml")),
    case("program-ball", ["program", "p.nc", "--setup", "s.toml"], ("p.nc", BALL[0]), ("s.toml", BALL[1])),
    case("program-several", ["program", "p.nc", "q.nc", "--json"], ("p.nc", "programs/plate.nc"), ("q.nc", "programs/housing.nc")),
    case("program-post", ["program", "p.nc", "--post", "siemens", "--out", "o.mpf"], ("p.nc", "programs/plate.nc")),
    case("effects", ["effects", "--effects", "e.toml"], ("e.toml", EFFECTS)),
    case("point-effects", ["point", "turning", "--effects", "e.toml", "--effect", "my.crater=0.1"], ("e.toml", EFFECTS)),
    case("fmu-export", ["fmu", "export", "infeed", "--fmi", "3", "--out", "out/u.fmu"]),
    case("ssp-export", ["ssp", "export", "s.toml", "--machine", "L", "--out", "out/cell.ssp"], ("s.toml", "lathe-cell.toml")),
    case("reference", ["reference", "out/pages"]),
    case("completions", ["completions", "bash"]),
    case("import-nasa-mill", ["import", "nasa-mill", "m.csv", "--out", "out"], ("m.csv", NASA)),
    case("import-nist-runs", ["import", "nist-runs", "m.csv", "--out", "out"], ("m.csv", runs())),
    case("gap-identifiability", ["gap", "identifiability", "--model", "g.toml", "--data", "w.csv"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-plan", ["gap", "plan", "--model", "g.toml", "--data", "w.csv", "--out", "out"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-predict", ["gap", "predict", "--model", "g.toml", "--data", "w.csv", "--out", "out"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-loop", ["gap", "loop", "--model", "g.toml", "--data", "w.csv", "--rounds", "1", "--out", "out/loop"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-watch", ["gap", "watch", "--model", "g.toml", "--data", "w.csv", "--state", "out/watch.json"],
         ("g.toml", "gap/turning.toml"), ("w.csv", "new/wear.csv")),
    case("gap-grinding", ["gap", "predict", "--model", "g.toml", "--data", "t.csv"],
         ("g.toml", "gap/grinding.toml"), ("t.csv", "data/zb153u_trials.csv")),
    case("gap-recovery", ["gap", "recovery", "--model", "g.toml", "--truth", "t.toml", "--logs", "1", "--out", "out"],
         ("g.toml", "gap/turning.toml"), ("t.toml", "gap/turning.toml")),
    case("gap-blind", ["gap", "blind", "--cases", "smoke", "--process", "turning", "--part", "1/9", "--only", "null"]),
]


def cases(program):
    """Every case: those of shipped files and those of files that the program writes first."""
    with tempfile.TemporaryDirectory(prefix="toolroom-fuzz-made-") as place:
        there = made(program, pathlib.Path(place))
    own = [
        ("fmu-info", ["fmu", "info", "u.fmu", "--json"], ["u.fmu", "turning.fmu"]),
        ("fmu-check", ["fmu", "check", "u.fmu"], ["u.fmu", "turning.fmu"]),
        ("fmu-sim", ["fmu", "sim", "u.fmu", "--stop", "1 s"], ["u.fmu", "turning.fmu"]),
        ("ssp-package", ["ssp", "info", "u.ssp"], ["u.ssp", "cell.ssp"]),
        ("ssp-sim", ["ssp", "sim", "u.ssp", "--stop", "1 s"], ["u.ssp", "cell.ssp"]),
        ("run-from", ["run", "--from", "s.trs", "--out", "out"], ["s.trs", "s.trs"]),
        ("compare-from", ["compare", "--from", "s.trs", "--out", "out"], ["s.trs", "s.trs"]),
        ("modes-cuts", ["modes", "s.toml", "--cuts", "c.csv", "--lobes", "l.toml", "--out", "o.toml", "--particles", "64"],
         ["s.toml", "spindle.toml"], ["c.csv", CUTS], ["l.toml", SCENARIOS / "chatter/milling-slot.toml"]),
        ("modes-update", ["modes", "update", "s.toml", "--cuts", "c.csv", "--lobes", "l.toml", "--out", "o.toml", "--particles", "64"],
         ["s.toml", "spindle.toml"], ["c.csv", CUTS], ["l.toml", SCENARIOS / "chatter/milling-slot.toml"]),
        ("check-plan", ["check", "plan.json"], ["plan.json", "plan.json"]),
        ("shard-plan", ["shard", "plan.json", "1", "--out", "parts"], ["plan.json", "plan.json"]),
        ("merge-parts", ["merge", "parts", "--out", "out"], ["parts/plan.json", "plan.json"],
         ["parts/part-000000.json", "parts/part-000000.json"], ["parts/part-000001.json", "parts/part-000001.json"]),
        ("life-run", ["life", "--run", "plan.json", "--shard", "0", "--out", "parts"], ["plan.json", "life.json"]),
        ("lobes-run", ["lobes", "--run", "plan.json", "--shard", "0", "--out", "parts"], ["plan.json", "lobes.json"]),
        ("check-diagnosis", ["check", "d.json"], ["d.json", "gap/found/diagnosis.json"]),
        ("check-records", ["check", "operations.csv"], ["operations.csv", "gap/records/operations.csv"]),
        ("apply-found", ["gap", "apply", "--model", "g.toml", "--diagnosis", "d.json", "--out", "o.toml", "--diff"],
         ["g.toml", SCENARIOS / "gap/turning.toml"], ["d.json", "gap/found/diagnosis.json"]),
        ("watch-again", ["gap", "watch", "--model", "g.toml", "--data", "w.csv", "--state", "watch.json"],
         ["g.toml", SCENARIOS / "gap/turning.toml"], ["w.csv", SCENARIOS / "new/wear.csv"], ["watch.json", "watch.json"]),
        ("diagnose-records", ["gap", "diagnose", "--model", "g.toml", "--data", "r.csv", "--json"],
         ["g.toml", SCENARIOS / "gap/turning.toml"], ["r.csv", "gap/records/operations.csv"]),
        ("diagnose-events", ["gap", "diagnose", "--model", "s.toml", "--data", "rec"],
         ["s.toml", SCENARIOS / "gap/shop.toml"], ["rec/events.csv", "rec/events.csv"]),
        ("report-done", ["report", "done"], *[[f"done/{own}", f"done/{own}"] for own in DONE]),
        ("diff-done", ["diff", "one", "two"], *[[f"{run}/{own}", f"done/{own}"] for run in ("one", "two") for own in DONE]),
    ]
    found = list(SHIPPED)
    for name, arguments, *files in own:
        if all(not isinstance(of, str) or of in there for _, of in files):
            found.append(case(name, arguments, *((to, there[of] if isinstance(of, str) else of) for to, of in files)))
    return found


def left_out(program, found):
    """Verbs of the program that no case calls, and kinds of files that no `check` reads, by its own reference."""
    with tempfile.TemporaryDirectory(prefix="toolroom-fuzz-reference-") as place:
        folder = pathlib.Path(place)
        subprocess.run([program, "reference", str(folder), "--quiet"], check=True)
        verbs = re.findall(r"(?m)^## toolroom (.+)$", (folder / "commands.md").read_text(encoding="utf-8"))
        kinds = [path.stem.removeprefix("file-") for path in folder.glob("file-*.md")]
    called = [" ".join(arguments) + " " for _, _, arguments in found]
    # `validate` has no input but its options. A program without the library of units cannot make one, which was reported.
    never = ["validate"] if "fmu-info" in [name for name, _, _ in found] else ["validate", "fmu info", "fmu check", "fmu sim", "ssp info",
                                                                           "ssp sim"]
    unseen = [verb for verb in verbs if verb not in never and not any(line.startswith(verb + " ") for line in called)]
    # A kind is told from its content, so the program itself says what a checked file is.
    seen = set()
    for _, files, arguments in found:
        if arguments[0] != "check":
            continue
        with tempfile.TemporaryDirectory(prefix="toolroom-fuzz-kind-") as place:
            folder = pathlib.Path(place)
            for to, of in files:
                (folder / to).parent.mkdir(parents=True, exist_ok=True)
                (folder / to).write_bytes(of if isinstance(of, bytes) else of.read_bytes())
            answer = subprocess.run([program, *[own for own in arguments if own != "--json"], "--json"], cwd=folder,
                                   capture_output=True, text=True, check=False)
            seen.update(re.findall(r'"kind":\s*"([a-z-]+)"', answer.stdout))
    return unseen, [kind for kind in kinds if kind not in seen]
