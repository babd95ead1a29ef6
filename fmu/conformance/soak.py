"""A long comparison of policies, watched while it runs: memory, time a replication, and one digest for one and two threads.

    toolroom fmu export turning --fmi 3
    python3 fmu/conformance/soak.py --toolroom target/release/toolroom --replications 10000 scenarios/fmu-lathe.toml

Prints, for each number of threads, the resident memory of toolroom and of its workers after the hundredth replication and the most
after it, and the processor time a replication in the first and the last third, which other programs on the machine change less than
the time of day. Exit code 1 where memory grows by more than 5 MB, where the time a replication changes by more than a tenth, where the
digests differ, or where a process is left behind. Linux only.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MOST = 5.0  # MB
CHANGE = 0.1  # of the processor time a replication
TICK = os.sysconf("SC_CLK_TCK")


def resident(pid):
    """Resident memory of a process, MB; none where it is gone."""
    try:
        text = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return None
    found = [line for line in text.splitlines() if line.startswith("VmRSS:")]
    return int(found[0].split()[1]) / 1024 if found else None


def processor_time(pid):
    """Processor time of a process so far, s; none where it is gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / TICK


def children(pid):
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid:
            found.append(int(status.parent.name))
    return found


class Journal:
    """The runs that are finished: a line each of a file that grows, after its head."""

    def __init__(self, folder):
        self.path, self.place, self.lines = Path(folder) / ".toolroom-journal" / "runs", 0, 0

    def runs(self):
        try:
            with open(self.path, "rb") as file:
                file.seek(self.place)
                text = file.read()
        except OSError:  # not there yet, or gone with the end
            return max(self.lines - 1, 0)
        self.place += len(text)
        self.lines += text.count(b"\n")
        return max(self.lines - 1, 0)


def watched(arguments, threads, folder):
    """Rows of seconds, replications, own memory and that of the workers, processor time of all; the digest; the workers that there were."""
    out = Path(folder) / f"threads-{threads}"
    command = [arguments.toolroom, "compare", arguments.scenario, "--replications", arguments.replications]
    command += ["--threads", threads, "--out", out, "--logged", 0, *arguments.option]
    rows, workers, begun, journal = [], set(), time.monotonic(), Journal(out)
    with subprocess.Popen([str(part) for part in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as run:
        while run.poll() is None:
            own = children(run.pid)
            workers.update(own)
            memory = resident(run.pid)
            if memory:
                spent = sum(map(processor_time, [run.pid, *own]))
                rows.append((time.monotonic() - begun, journal.runs(), memory, sum(filter(None, map(resident, own))), spent))
            time.sleep(arguments.every)
        if run.returncode:
            sys.exit(run.stderr.read().decode())
    summary = json.loads((out / "run.json").read_text())
    return rows, summary["digest"], len(summary["policies"]), workers


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--toolroom", required=True)
    parser.add_argument("--replications", type=int, default=10000)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--every", type=float, default=1.0, help="seconds between two looks")
    parser.add_argument("--option", action="append", default=[], help="handed to toolroom, such as --option=--set=KEY=VALUE")
    parser.add_argument("scenario")
    arguments = parser.parse_args()
    faults, digests = [], {}
    for threads in arguments.threads:
        with tempfile.TemporaryDirectory() as folder:
            rows, digests[threads], policies, workers = watched(arguments, threads, folder)
        rows = [(at, runs / policies, own, others, spent) for at, runs, own, others, spent in rows]
        for wanted in (100, 1000, 10000):
            reached = next((row for row in rows if row[1] >= wanted), None)
            if reached:
                at, runs, own, others, spent = reached
                print(
                    f"{threads} thread(s), replication {runs:.0f}: {own:.1f} MB, workers {others:.1f} MB, "
                    f"{spent:.1f} s of processor time, {at:.1f} s"
                )
        after = [row for row in rows if row[1] >= 100]
        if len(after) < 3:
            sys.exit("too short to be watched: more replications, or --every less")
        hundredth, end = after[0], after[-1]
        growth = [max(row[i] for row in after) - hundredth[i] for i in (2, 3)]
        third = (end[1] - hundredth[1]) / 3
        near = lambda wanted: min(after, key=lambda row: abs(row[1] - wanted))
        one, two = near(hundredth[1] + third), near(end[1] - third)
        first = (one[4] - hundredth[4]) / (one[1] - hundredth[1])
        last = (end[4] - two[4]) / (end[1] - two[1])
        print(
            f"{threads} threads, {arguments.replications} replications in {rows[-1][0]:.0f} s: toolroom {hundredth[2]:.1f} MB after"
            f" {hundredth[1]:.0f} replications, at most {growth[0]:.1f} MB more; workers {hundredth[3]:.1f} MB, at most"
            f" {growth[1]:.1f} MB more; {1e3 * first:.2f} ms of processor time a replication in the first third, {1e3 * last:.2f} ms in the last;"
            f" digest {digests[threads]}",
            flush=True,
        )
        faults += [f"{threads} threads: memory grows by {each:.1f} MB" for each in growth if each > MOST]
        faults += [f"worker {pid} is left" for pid in workers if resident(pid)]
        if abs(last - first) > CHANGE * first:
            faults.append(f"{threads} threads: {1e3 * first:.2f} ms a replication at first, {1e3 * last:.2f} ms at last")
    if len(set(digests.values())) > 1:
        faults.append(f"digests differ: {digests}")
    for each in faults:
        print(f"failed: {each}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
