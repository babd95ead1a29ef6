#!/usr/bin/env python3
"""Mutated inputs over every verb and kind of file: the program refuses or works, and never panics, hangs or spoils a file.

    python3 tests/fuzz/mutate.py target/debug/toolroom                        # 200 mutations, as CI does
    python3 tests/fuzz/mutate.py target/release/toolroom --count 10000        # the whole, an hour or two on two cores
    python3 tests/fuzz/mutate.py target/debug/toolroom --seed 7 --from 123 --count 1 --keep out/fuzz   # one again, kept
    python3 tests/fuzz/mutate.py target/release/toolroom --floods 300000     --count 2000   # 300 kB of the same

Floods look for readers whose time grows with the square of what is wrong: a text gets BYTES of one of FLOODS, in the middle of a
line or as lines of their own. Every text, flood and place is tried once, in an order that the seed draws; there are some 8700.

Mutation I of seed S is always the same. For each the input files of a command are copied, one is changed (bytes, lines, numbers,
units, keys, encodings, nesting, tables), or one of the arguments is, and the command runs. It is a fault when

- it ends with another exit code than 0, 1, 2 or 3, or says that it panicked,
- it takes more than 60 s of processor time (--longest), computes nothing for five minutes, or takes more memory than --memory allows,
- it ends with 0 and says `error:`, or with 1 or 2 and says nothing,
- it changes, removes or replaces a file that was there before.
"""

import argparse
import collections
import concurrent.futures
import hashlib
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile

from cases import cases, left_out

HANGS = 300  # s by the clock: nothing is computed any more
NUMBER = re.compile(rb"[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?")
STRANGE = [b"0", b"-1", b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"-inf", b"99999999999999999999", b"4294967296",
           b"1e9", b"1e-9", b"0.1.2", b"1,5", b"", b"\xd9\xa3", b"0x10", b"1_000", b"9" * 400]
FLOODS = [b",", b"[", b"]", b"[]", b"{", b"}", b'"', b"'", b"=", b"(", b";", b" ", b"\n", b"\r", b"\\", b"<a>", b"&lt;", b'"a":', b"a.", b"1,",
          b"0 ", b"-1\n", b",\n", b"[[a]]\n", b"[machine]\n", b"a = 1\n", b"a1 = 1, ", b"G1 X1\n", b"0\nLINE\n"]
UNITS = [b"mm", b"um", b"m", b"in", b"m/min", b"m/s", b"rpm", b"Hz", b"s", b"min", b"h", b"day", b"EUR", b"EUR/h", b"1/h", b"N",
         b"kN", b"K", b"degC", b"mm/rev", b"%", b"MPa", b"kg", b"", b"\xc2\xb5m", b"furlong"]


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


def ended(process):
    """Exit code and output of a process; the code is none where it computed nothing for HANGS seconds."""
    used = 0.0
    while True:
        try:
            out, said = process.communicate(timeout=HANGS)
            return process.returncode, out, said
        except subprocess.TimeoutExpired:
            # Where a machine has more to do than it can, a process that waits for its turn does not hang.
            computed = processor_time(process.pid)
            if computed is None or computed < used + 1.0:
                process.kill()
                out, said = process.communicate()
                return None, out, said
            used = computed


def processor_time(pid):
    """Seconds that a process has computed, where the system tells them in /proc."""
    try:
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return None
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def floods(found, size, seed):
    """The number of a case, which of its files, where and what, for everything that --floods tries, in the order of a seed."""
    def flooded(of):
        return b"\0" not in (of if isinstance(of, bytes) else of.read_bytes())
    every = [(number, which, inside, flood * (size // len(flood))) for number, (_, files, _) in enumerate(found)
             for which, (_, of) in enumerate(files) if flooded(of) for flood in FLOODS for inside in (True, False)]
    random.Random(f"floods-{seed}").shuffle(every)
    return every


def with_flood(text, inside, flood):
    """A text with a flood in the middle of its middle line, or as lines of its own before it."""
    lines = text.split(b"\n")
    at = len(lines) // 2
    # A line that is empty or a comment has no value to be spoilt.
    at = next((i for i in range(at, len(lines)) if b"=" in lines[i] or b"," in lines[i]), at)
    if inside:
        middle = lines[at].find(b"=") + 2 if b"=" in lines[at] else len(lines[at]) // 2
        lines[at] = lines[at][:middle] + flood + lines[at][middle:]
    else:
        lines.insert(at, flood)
    return b"\n".join(lines)


def tried(program, number, options):
    """Runs one mutation or flood; what was found, and its name."""
    draw = random.Random(f"{options.seed}-{number}")
    case, flood = (options.flooded[number][0], options.flooded[number][1:]) if options.floods else (number % len(options.cases), None)
    name, files, arguments = options.cases[case]
    arguments, spoilt = list(arguments), set()
    with tempfile.TemporaryDirectory(prefix="toolroom-fuzz-") as place:
        folder = pathlib.Path(place)
        texts = [(to, of if isinstance(of, bytes) else of.read_bytes()) for to, of in files]
        if flood or texts and draw.random() < 0.9:
            which = flood[0] if flood else draw.randrange(len(texts))
            if flood:
                text, what = with_flood(texts[which][1], *flood[1:]), f"flood {flood[2][:12]} {'inside' if flood[1] else 'as lines'}"
            else:
                text, what = mutated(texts[which][1], draw)
            spoilt = {texts[which][0]} if text != texts[which][1] else set()
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
            resource.setrlimit(resource.RLIMIT_CPU, (options.longest, options.longest + 5))

        environment = {**os.environ, "RAYON_NUM_THREADS": "1", "RUST_BACKTRACE": "0", "NO_COLOR": "1"}
        started = subprocess.Popen([program, *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=limit, env=environment)
        code, out, said = ended(started)
        said = said.decode("utf-8", "replace")
        after = hashes(folder)
        found = []
        if code is None:
            found.append(f"hangs for {HANGS} s")
        elif code == -signal.SIGXCPU:
            found.append(f"takes more than {options.longest} s of processor time")
        elif code not in (0, 1, 2, 3):
            found.append(f"ends with {code}")
        if "panicked at" in said or "stack overflow" in said:
            found.append("panics")
        if code == 0 and re.search(r"(?m)^error:", said):
            found.append("ends with 0 and says error")
        if code in (1, 2) and not said.strip():
            found.append(f"ends with {code} and says nothing")
        # A state goes on with every look, if it is what the program has written.
        states = {arguments[i + 1] for i, own in enumerate(arguments[:-1]) if own == "--state"} - spoilt
        changed = [own for own, hash in before.items() if after.get(own) != hash and own not in states]
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
    parser.add_argument("--longest", type=int, default=60, help="s of processor time")
    parser.add_argument("--floods", type=int, metavar="BYTES", help="floods of BYTES instead of mutations")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the inputs of faults")
    parser.add_argument("--only", help="cases whose name has this")
    options = parser.parse_args()
    program, faults, codes = options.program.resolve(), 0, collections.Counter()
    options.cases = cases(program)
    verbs, kinds = left_out(program, options.cases)
    if verbs or kinds:
        # A case is missing, or an input as shipped is refused: neither is a fault of the program under test.
        sys.exit(f"no case for {', '.join([*verbs, *(f'files of the kind {kind}' for kind in kinds)])}: see tests/fuzz/cases.py")
    options.flooded = floods(options.cases, options.floods, options.seed) if options.floods else []

    def case_of(number):
        return options.flooded[number][0] if options.floods else number % len(options.cases)
    last = options.first + options.count
    numbers = [i for i in range(options.first, min(last, len(options.flooded)) if options.floods else last)
               if not options.only or options.only in options.cases[case_of(i)][0]]
    pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
    try:
        for label, found, tail, code, _ in pool.map(lambda number: tried(program, number, options), numbers):
            codes[code] += 1
            if found:
                faults += 1
                print(f"{label}: {'; '.join(found)}\n    {tail}", flush=True)
    except KeyboardInterrupt:
        print("interrupted")
    pool.shutdown(cancel_futures=True)
    done = sum(codes.values())
    rest = f", --from {numbers[done]} goes on" if done < len(numbers) else ""
    summary = ", ".join(f"{count} × exit {code}" for code, count in sorted(codes.items(), key=str))
    what = f"{done} floods" if options.floods else f"{done} mutations"
    print(f"{what} of {len(options.cases)} commands, seed {options.seed}: {summary}; {faults} faults{rest}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
