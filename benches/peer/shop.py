"""Plain shops in SimPy and in toolroom: processor time and resident memory of the same model, end to end.

    python benches/peer/shop.py TOOLROOM [queue|jobshop|memory]        (pip install simpy)

`queue` is M/M/1 at 80 % load; `jobshop` has 100 machines, orders of ten operations on distinct machines in random order,
exponential times, Poisson arrivals, 80 % load. SimPy runs a quarter of the work, without any monitor but the mean stay. toolroom
runs one replication without logs and report pictures of it, parsing and start included: `run --logged 0 --threads 1`.
Processor seconds of the child processes, median of three runs.
"""

import os
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

SIMPY = Path(__file__).with_name("shop_simpy.py")


def measured(command):
    """Processor time in s and the greatest resident memory in MB of a command, from what the kernel says of the child."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    output = process.stdout.read().decode()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command}: {status}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, output


def median(command):
    runs = [measured(command) for _ in range(3)]
    return statistics.median(time for time, _, _ in runs), max(memory for _, memory, _ in runs), runs[0][2]


def head(name, minutes):
    return f'schema = 1\n[shop]\nname = "{name}"\nhorizon = "{minutes} min"\nreplications = 1\n'


def queue(customers):
    """M/M/1 with so many customers, one minute each on average."""
    work = '{ distribution = "exponential", mean = "1 min" }'
    return head("queue", customers / 0.8) + (
        '[[machine]]\nname = "server"\nprocess = "plain"\n[[part]]\nname = "job"\n'
        f'operation = [{{ name = "serve", machines = "server", work = {work} }}]\n'
        '[[arrivals]]\npart = "job"\npattern = "poisson"\nrate = "48 1/h"\n'
    )


def jobshop(operations, parts=200):
    """100 machines; each of `parts` parts has ten operations. Ten parts share out all machines, so that all are loaded alike."""
    draw = random.Random(1)
    routings = []
    for _ in range(parts // 10):
        order = draw.sample(range(100), 100)
        routings += [order[10 * part : 10 * part + 10] for part in range(10)]
    work = '{ distribution = "exponential", mean = "1 min" }'
    text = [head("jobshop", operations / 80.0)]
    text += [f'[[machine]]\nname = "M{number}"\nprocess = "plain"\n' for number in range(100)]
    for part, routing in enumerate(routings):
        text.append(f'[[part]]\nname = "P{part}"\noperation = [\n')
        for step, machine in enumerate(routing):
            text.append(f'  {{ name = "{step}", machines = "M{machine}", work = {work} }},\n')
        text.append(']\n[[arrivals]]\npattern = "poisson"\n')
        text.append(f'part = "P{part}"\nrate = "{8 * 60 / parts} 1/h"\n')  # 8 orders of 10 min a minute: 80 % of 100 machines
    return "".join(text)


def toolroom(program, text, folder):
    file = Path(folder) / "shop.toml"
    file.write_text(text)
    out = str(Path(folder) / "out")
    return median([program, "run", str(file), "--logged", "0", "--threads", "1", "--json", "--force", "--out", out])


def main():
    program, what = sys.argv[1], sys.argv[2:] or ["queue", "jobshop", "memory"]
    with tempfile.TemporaryDirectory() as folder:
        for model, made, unit in [("queue", queue, "customer"), ("jobshop", jobshop, "operation")]:
            if model in what:
                many = 4_000_000
                own, memory, _ = toolroom(program, made(many), folder)
                peer, _, stay = median([sys.executable, str(SIMPY), model, str(many // 4)])
                own, peer = own / many, peer / (many // 4)
                print(f"{model}: toolroom {own * 1e6:.3f} us a {unit}, {memory:.0f} MB; SimPy {peer * 1e6:.3f} us; "
                      f"{peer / own:.1f} x; mean stay in SimPy {stay.strip()} min")
        if "memory" in what:
            for many in (100_000, 1_000_000, 10_000_000):
                _, memory, _ = toolroom(program, jobshop(many), folder)
                print(f"jobshop of {many} operations: {memory:.1f} MB")


if __name__ == "__main__":
    main()
