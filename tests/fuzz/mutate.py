#!/usr/bin/env python3
"""Mutated inputs over every verb and kind of file: the program refuses or works, and never panics, hangs or spoils a file.

    python3 tests/fuzz/mutate.py target/debug/toolroom                        # 200 mutations, as CI does
    python3 tests/fuzz/mutate.py target/release/toolroom --count 10000        # the whole, an hour or two on two cores
    python3 tests/fuzz/mutate.py target/debug/toolroom --seed 7 --from 123 --count 1 --keep out/fuzz   # one again, kept

Mutation I of seed S is always the same. For each the input files of a command are copied, one is changed (bytes, lines, numbers,
units, keys, encodings, nesting, tables), or one of the arguments is, and the command runs. It is a fault when

- it ends with another exit code than 0, 1, 2 or 3, or says that it panicked,
- it takes more than 60 s of processor time, five minutes by the clock, or more memory than --memory allows,
- it ends with 0 and says `error:`, or with 1 or 2 and says nothing,
- it changes, removes or replaces a file that was there before.
"""

import argparse
import collections
import concurrent.futures
import hashlib
import math
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import wave

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENARIOS = ROOT / "scenarios"
LONGEST = 60  # s of processor time
HANGS = 300  # s by the clock: nothing is computed any more
SHORT = ["--replications", "1", "--set", 'shop.horizon="1 h"', "--set", 'shop.warm_up="0 h"']
NUMBER = re.compile(rb"[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?")
STRANGE = [b"0", b"-1", b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"-inf", b"99999999999999999999", b"4294967296",
           b"1e9", b"1e-9", b"0.1.2", b"1,5", b"", b"\xd9\xa3", b"0x10", b"1_000", b"9" * 400]
UNITS = [b"mm", b"um", b"m", b"in", b"m/min", b"m/s", b"rpm", b"Hz", b"s", b"min", b"h", b"day", b"EUR", b"EUR/h", b"1/h", b"N",
         b"kN", b"K", b"degC", b"mm/rev", b"%", b"MPa", b"kg", b"", b"\xc2\xb5m", b"furlong"]


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


def sound():
    """A second of a tone with its harmonics, as WAV."""
    with tempfile.NamedTemporaryFile(suffix=".wav") as file:
        with wave.open(file.name, "wb") as out:
            out.setparams((1, 2, 8000, 0, "NONE", ""))
            out.writeframes(b"".join(
                struct.pack("<h", int(6000 * math.sin(2 * math.pi * 500 * i / 8000) + 3000 * math.sin(2 * math.pi * 811 * i / 8000)))
                for i in range(8000)))
        return pathlib.Path(file.name).read_bytes()


def adapter():
    """A few lines of a machine's log."""
    lines = []
    for second in range(60):
        state = "ACTIVE" if second % 20 > 3 else "READY"
        lines.append(f"2026-01-05T08:{second // 60:02}:{second % 60:02}.000Z|execution|{state}|program|O1001|line|{second % 12}")
    return "\n".join(lines).encode()


CASES = [
    case("check-scenario", ["check", "s.toml"], ("s.toml", "template.toml")),
    case("check-orders", ["check", "o.toml"], ("o.toml", "shop/orders.toml"), ("orders.csv", "shop/orders.csv")),
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
    case("compare-orders", ["compare", "o.toml", "--out", "out", "--replications", "1"],
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
    case("gap-apply", ["gap", "apply", "--model", "g.toml", "--diagnosis", "d.json", "--out", "o.toml"],
         ("g.toml", "gap/turning.toml"), ("d.json", b'{"schema": 1, "verdict": "no_gap", "process": "turning", "effects": []}')),
    case("diff", ["diff", "a", "b"], ("a/run.json", b'{"schema": 1, "complete": true}'), ("b/kpi.csv", b"policy,kpi\n")),
    case("report", ["report", "a"], ("a/run.json", b'{"schema": 1, "complete": true, "files": []}')),
    case("merge", ["merge", "parts"], ("parts/plan.json", b'{"schema": 1, "kind": "life"}')),
    case("shard", ["shard", "plan.json", "0", "--out", "parts"], ("plan.json", b'{"schema": 1, "kind": "life"}')),
    case("fmu-info", ["fmu", "info", "u.fmu"], ("u.fmu", b"PK\x05\x06" + b"\0" * 18)),
    case("ssp-info", ["ssp", "info", "u.ssp"], ("u.ssp", b"PK\x05\x06" + b"\0" * 18)),
    case("new", ["new", "gap", "there"]),
    case("explain", ["explain", "quantity"]),
    case("schema", ["schema", "life"]),
]


def mutated(text, draw):
    """A text with one to three changes, and what they are."""
    done = []
    for _ in range(draw.choice([1, 1, 1, 2, 3])):
        text, what = one(text, draw)
        done.append(what)
    return text, "+".join(done)


def one(text, draw):
    lines = text.split(b"\n")
    at = draw.randrange(len(lines))
    what = draw.choice(["number", "number", "number", "unit", "line-gone", "line-twice", "lines-swapped", "cut-off", "byte", "bytes",
                        "word", "key", "quote", "nest", "long", "encoding", "cell", "empty", "deep"])
    if what == "number":
        found = list(NUMBER.finditer(text))
        if found:
            own = draw.choice(found)
            return text[:own.start()] + draw.choice(STRANGE) + text[own.end():], what
    elif what == "unit":
        found = list(re.finditer(rb'(?<=\d )[A-Za-z/%]+(?=")', text))
        if found:
            own = draw.choice(found)
            return text[:own.start()] + draw.choice(UNITS) + text[own.end():], what
    elif what == "line-gone":
        del lines[at]
    elif what == "line-twice":
        lines[at:at] = [lines[at]] * draw.choice([1, 1, 2, 200])
    elif what == "lines-swapped":
        other = draw.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    elif what == "cut-off":
        return text[:draw.randrange(len(text) + 1)], what
    elif what in ("byte", "bytes"):
        data = bytearray(text)
        for _ in range(1 if what == "byte" else draw.randrange(2, 60)):
            if data:
                data[draw.randrange(len(data))] = draw.randrange(256)
        return bytes(data), what
    elif what in ("word", "key"):
        words = re.findall(rb"[A-Za-z_]{3,}", text)
        pattern = rb"(?m)^[a-z_]+(?= =)" if what == "key" else rb"[A-Za-z_]{3,}"
        found = list(re.finditer(pattern, text))
        if found and words:
            own, other = draw.choice(found), draw.choice(words)
            return text[:own.start()] + other + text[own.end():], what
    elif what == "quote":
        found = [i for i, own in enumerate(text) if own in b"\"'[]{}=;,|"]
        if found:
            i = draw.choice(found)
            return text[:i] + draw.choice([b"", b'"', b"'", b"[", b"]", b"{", b"}", b"=", b",", b"\n"]) + text[i + 1:], what
    elif what == "nest":
        lines[at] = lines[at] + draw.choice([b" = ", b""]) + b"[" * draw.choice([3, 100, 20000])
    elif what == "deep":
        lines[at] = b".".join([b"a"] * draw.choice([3, 100, 5000])) + b" = 1"
    elif what == "long":
        lines[at] = lines[at] + draw.choice([b"a", b"9", b" ", b"\xe2\x80\xae", b",", b"["]) * draw.choice([10, 1000, 300000])
    elif what == "encoding":
        return draw.choice([b"\xff\xfe" + text.decode("latin1").encode("utf-16-le"), b"\xef\xbb\xbf" + text,
                            text.replace(b"\n", b"\r\n"), text.replace(b"\n", b"\r"), text + b"\0", text.replace(b" ", b"\xa0")]), what
    elif what == "cell":
        cells = re.split(rb"([,;|])", lines[at])
        cells[draw.randrange(len(cells))] = draw.choice(STRANGE)
        lines[at] = b"".join(cells)
    elif what == "empty":
        return draw.choice([b"", b"\n", b"\n" * 5000, b"#", lines[0], lines[0] + b"\n"]), what
    return b"\n".join(lines), what


def hashes(folder):
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


def tried(program, number, options):
    """Runs one mutation; what was found, and its name."""
    draw = random.Random(f"{options.seed}-{number}")
    name, files, arguments = CASES[number % len(CASES)]
    arguments = list(arguments)
    with tempfile.TemporaryDirectory(prefix="toolroom-fuzz-") as place:
        folder = pathlib.Path(place)
        texts = [(to, of if isinstance(of, bytes) else of.read_bytes()) for to, of in files]
        if texts and draw.random() < 0.9:
            which = draw.randrange(len(texts))
            text, what = mutated(texts[which][1], draw)
            texts[which] = (texts[which][0], text)
            what = f"{texts[which][0]} {what}"
        else:
            # Options stay, so that nobody asks for the whole machine; a NUL cannot be an argument.
            which = draw.choice([i for i, own in enumerate(arguments) if i > 0 and not own.startswith("--")] or [0])
            text, what = one(arguments[which].encode(), draw)
            arguments[which] = text[:2000].decode("utf-8", "replace").replace("\0", "")
            what = f"argument {which} {what}"
        for to, text in texts:
            (folder / to).parent.mkdir(parents=True, exist_ok=True)
            (folder / to).write_bytes(text)
        # A user's own files beside the results.
        for mine in ("out/mine.txt", "notes.txt"):
            (folder / mine).parent.mkdir(exist_ok=True)
            (folder / mine).write_text("mine")
        before = hashes(folder)

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (options.memory << 20, options.memory << 20))
            resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 5))

        environment = {**os.environ, "RAYON_NUM_THREADS": "1", "RUST_BACKTRACE": "0", "NO_COLOR": "1"}
        try:
            done = subprocess.run([program, *arguments], cwd=folder, capture_output=True, timeout=HANGS, preexec_fn=limit,
                                  env=environment, stdin=subprocess.DEVNULL, check=False)
            code, out, said = done.returncode, done.stdout, done.stderr.decode("utf-8", "replace")
        except subprocess.TimeoutExpired as late:
            code, out, said = None, b"", (late.stderr or b"").decode("utf-8", "replace")
        after = hashes(folder)
        found = []
        if code is None:
            found.append(f"hangs for {HANGS} s")
        elif code == -signal.SIGXCPU:
            found.append(f"takes more than {LONGEST} s of processor time")
        elif code not in (0, 1, 2, 3):
            found.append(f"ends with {code}")
        if "panicked at" in said or "stack overflow" in said:
            found.append("panics")
        if code == 0 and re.search(r"(?m)^error:", said):
            found.append("ends with 0 and says error")
        if code in (1, 2) and not said.strip():
            found.append(f"ends with {code} and says nothing")
        changed = [own for own, hash in before.items() if after.get(own) != hash]
        if changed:
            found.append(f"changes {', '.join(changed)}")
        label = f"{number} {name} ({what})"
        if found and options.keep:
            kept = options.keep / f"{options.seed}-{number}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(folder, kept)
            (kept / "command.txt").write_text(f"{arguments}\n{label}: {found}\n{said}", encoding="utf-8")
        tail = next((line for line in said.splitlines() if "panicked" in line), said.strip()[-300:])
        return label, found, tail, code, name


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--from", type=int, default=0, dest="first", help="number of the first mutation")
    parser.add_argument("--memory", type=int, default=4096, help="MiB of address space")
    parser.add_argument("--jobs", type=int, default=min(2, os.cpu_count() or 1))
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the inputs of faults")
    parser.add_argument("--only", help="cases whose name has this")
    options = parser.parse_args()
    program, faults, codes = options.program.resolve(), 0, collections.Counter()
    numbers = [i for i in range(options.first, options.first + options.count)
               if not options.only or options.only in CASES[i % len(CASES)][0]]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for label, found, tail, code, _ in pool.map(lambda number: tried(program, number, options), numbers):
            codes[code] += 1
            if found:
                faults += 1
                print(f"{label}: {'; '.join(found)}\n    {tail}", flush=True)
    summary = ", ".join(f"{count} × exit {code}" for code, count in sorted(codes.items(), key=str))
    print(f"{len(numbers)} mutations of {len(CASES)} commands, seed {options.seed}: {summary}; {faults} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
