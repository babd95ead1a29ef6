"""Plain shops in SimPy and in toolroom: processor time and resident memory of the same model, end to end.

    python benches/peer/shop.py TOOLROOM [queue|jobshop|turning|waiting|memory]        (pip install simpy)

`queue` is M/M/1 at 80 % load; `jobshop` has 100 machines, orders of ten operations on distinct machines in random order,
exponential times, Poisson arrivals, 80 % load. SimPy runs a quarter of the work, without any monitor but the mean stay. toolroom
runs one replication without logs and report pictures of it, parsing and start included: `run --logged 0 --threads 1`.
`turning` is `jobshop` with a turning pass of a minute in the place of each exponential time: an edge wears in every pass and is
changed when it is worn. Its peer is the `jobshop` of SimPy, in which nothing wears. `waiting` has 40 000 jobs that wait at one machine
at once and go to one of four others from there, under every rule, and no peer. `memory` has runs of `jobshop` of three lengths.
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


def routings(parts):
    """Machines of the ten operations of each part. Ten parts share out all machines, so that all are loaded alike."""
    draw = random.Random(1)
    orders = [draw.sample(range(100), 100) for _ in range(parts // 10)]
    return [order[10 * part : 10 * part + 10] for order in orders for part in range(10)]


def jobshop(operations, parts=200):
    """100 machines; each of `parts` parts has ten operations."""
    work = '{ distribution = "exponential", mean = "1 min" }'
    text = [head("jobshop", operations / 80.0)]
    text += [f'[[machine]]\nname = "M{number}"\nprocess = "plain"\n' for number in range(100)]
    for part, routing in enumerate(routings(parts)):
        text.append(f'[[part]]\nname = "P{part}"\noperation = [\n')
        for step, machine in enumerate(routing):
            text.append(f'  {{ name = "{step}", machines = "M{machine}", work = {work} }},\n')
        text.append(']\n[[arrivals]]\npattern = "poisson"\n')
        text.append(f'part = "P{part}"\nrate = "{8 * 60 / parts} 1/h"\n')  # 8 orders of 10 min a minute: 80 % of 100 machines
    return "".join(text)


def turning(operations, parts=200):
    """The job shop in which every operation is a pass of one edge for a minute at 180 m/min, at 60 % load of cutting alone."""
    text = [head("turning", operations / 60.0)]
    for number in range(100):
        text.append(
            f'[[machine]]\nname = "M{number}"\nprocess = "turning"\nrate = "60 EUR/h"\nload_time = "0 min"\nunload_time = "0 min"\n'
            'tool_change_time = "1 min"\nmagazine = 100000\nspeed_range = ["60 m/min", "400 m/min"]\n'
        )
    text.append('[[tool]]\nname = "insert"\nprocess = "turning"\nparameter_set = "c45_t15k6"\nedge_cost = "6 EUR"\n')
    cut = (
        'cutting_speed = "180 m/min", feed_per_rev = "0.3 mm/rev", depth_of_cut = "1.5 mm", path_length = "180 m", '
        'size_tolerance = "1 mm"'
    )
    for part, routing in enumerate(routings(parts)):
        text.append(f'[[part]]\nname = "P{part}"\noperation = [\n')
        for step, machine in enumerate(routing):
            text.append(f'  {{ name = "{step}", machines = "M{machine}", tool = "insert", passes = 1, {cut} }},\n')
        text.append(']\n[[arrivals]]\npattern = "poisson"\n')
        text.append(f'part = "P{part}"\nrate = "{6 * 60 / parts} 1/h"\n')
    return "".join(text)


#: Rules of `waiting`, the first one the measure of the others.
RULES = ["fifo", "edd", "spt", "mdd", "covert", "s_ro", "cr", "atc", "pt_winq"]


def waiting(rule, jobs=40_000, replications=10):
    """So many jobs at one machine at the start, of four parts, each with another machine for its second operation."""
    work = '{ distribution = "exponential", mean = "1 min" }'
    text = [head("waiting", 2 * jobs).replace("replications = 1", f"replications = {replications}")]
    text.append(f'[dispatch]\nrule = "{rule}"\n')
    text += [f'[[machine]]\nname = "M{number}"\nprocess = "plain"\n' for number in range(5)]
    for part in range(1, 5):
        text.append(
            f'[[part]]\nname = "P{part}"\noperation = [\n  {{ name = "first", machines = "M0", work = {work} }},\n'
            f'  {{ name = "second", machines = "M{part}", work = {work} }},\n]\n[[arrivals]]\npart = "P{part}"\n'
            f'pattern = "schedule"\ndue = {{ rule = "TWK", k = {jobs // 4} }}\n'
            f'lot = [{{ time = "0 h", size = {jobs // 4} }}]\n'
        )
    return "".join(text)


def toolroom(program, text, folder):
    file = Path(folder) / "shop.toml"
    file.write_text(text)
    out = str(Path(folder) / "out")
    return median([program, "run", str(file), "--logged", "0", "--threads", "1", "--json", "--force", "--out", out])


#: What can be measured: the model in toolroom, the peer in SimPy, how much work, and of how much SimPy does a part.
MODELS = {
    "queue": (queue, "queue", 4_000_000, "customer"),
    "jobshop": (jobshop, "jobshop", 4_000_000, "operation"),
    "turning": (turning, "jobshop", 400_000, "operation"),
}


def main():
    program, what = sys.argv[1], sys.argv[2:] or [*MODELS, "waiting", "memory"]
    with tempfile.TemporaryDirectory() as folder:
        for model in [model for model in MODELS if model in what]:
            made, peer_model, many, unit = MODELS[model]
            part = many // 4 if many > 1_000_000 else many
            own, memory, _ = toolroom(program, made(many), folder)
            peer, _, stay = median([sys.executable, str(SIMPY), peer_model, str(part)])
            own, peer = own / many, peer / part
            print(f"{model}: toolroom {own * 1e6:.3f} us a {unit}, {memory:.0f} MB; SimPy {peer * 1e6:.3f} us; "
                  f"{peer / own:.1f} x; mean stay in SimPy {stay.strip()} min")
        if "waiting" in what:
            times = {rule: toolroom(program, waiting(rule), folder)[0] / 10 for rule in RULES}
            for rule, time in times.items():
                print(f"waiting, {rule}: {time * 1e3:.0f} ms a replication, {time / times[RULES[0]]:.1f} of {RULES[0]}")
        if "memory" in what:
            for many in (100_000, 1_000_000, 10_000_000):
                _, memory, _ = toolroom(program, jobshop(many), folder)
                print(f"jobshop of {many} operations: {memory:.1f} MB")


if __name__ == "__main__":
    main()
