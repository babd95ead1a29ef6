"""Writes an order table of a size that plants have: 40 machines, 12 operators, 2000 orders in six weeks.

    python examples/order_table.py DIR [--orders 2000] [--weeks 6] [--seed 1]
    toolroom check DIR/shop.toml
    toolroom run DIR/shop.toml --replications 20

With --cut every sixth part is a ring that is turned, milled and ground with edges that wear, as in scenarios/demo.toml, beside
operations of which only a time is known. scenarios/shop/mixed.toml is made by

    python examples/order_table.py scenarios/shop --name mixed --orders 300 --cut

The shop is made up: stations, routings, times and people are assumptions, chosen so that every station has the load that its
line in STATIONS says. The same numbers give the same files. Only the standard library is used.
"""

import argparse
import csv
import datetime
import pathlib
import random

# Name, machines, calendar, mean time of a piece against others (assumption), setup in minutes, load (assumption).
STATIONS = [
    ("saw", 3, "two shifts", 1.0, 10, 0.70),
    ("lathe", 10, "two shifts", 4.0, 20, 0.84),
    ("mill", 9, "two shifts", 5.0, 25, 0.86),
    ("drill", 4, "two shifts", 2.0, 15, 0.75),
    ("grinder", 5, "two shifts", 4.0, 20, 0.80),
    ("deburr", 3, "early", 1.5, 0, 0.70),
    ("wash", 2, "two shifts", 0.5, 0, 0.65),
    ("furnace", 2, "always", 2.0, 0, 0.60),
    ("CMM", 2, "two shifts", 2.0, 5, 0.75),
]
ROUTINGS = [
    ["saw", "lathe", "deburr", "wash", "CMM"],
    ["saw", "lathe", "mill", "deburr", "wash", "CMM"],
    ["saw", "mill", "drill", "deburr", "wash"],
    ["lathe", "furnace", "grinder", "wash", "CMM"],
    ["saw", "lathe", "mill", "furnace", "grinder", "wash", "CMM"],
    ["mill", "drill", "mill", "deburr", "CMM"],
]
PARTS = 30
# What a ring takes where it is cut, minutes a piece with loading, by station (programmed times of scenarios/demo.toml).
CUT = {"lathe": 10.5, "mill": 12.0, "grinder": 4.0}
RINGS = ["saw", "lathe", "mill", "furnace", "grinder", "wash", "CMM"]
HOURS = {"early": 8.0, "two shifts": 16.0, "always": 24.0}
START = datetime.datetime(2026, 3, 30)  # a Monday
HOLIDAYS = [datetime.date(2026, 4, 3), datetime.date(2026, 4, 6)]


def parts(draw, cut):
    """Parts: name, routing, times against others by operation, usual quantity, whether it is a ring that is cut."""
    made = []
    for number in range(PARTS):
        ring = cut and number % 6 == 5
        routing = RINGS if ring else ROUTINGS[number % len(ROUTINGS)]
        mean = {name: time for name, _, _, time, _, _ in STATIONS}
        times = [mean[station] * draw.uniform(0.5, 1.6) for station in routing]
        made.append((f"P{number + 1:02}", routing, times, draw.choice([4, 6, 8] if ring else [5, 10, 15, 20, 30, 40]), ring))
    return made


def working_days(weeks):
    days = [START.date() + datetime.timedelta(days=day) for day in range(7 * weeks)]
    return [day for day in days if day.weekday() < 5 and day not in HOLIDAYS]


# Days from release to due date: of many small orders, and of few large ones (assumptions).
ALLOWANCE, LONG_ALLOWANCE = (5, 12), (9, 18)
# Loads of STATIONS are multiplied by this where few orders are so large that they wait for each other longer (assumption).
LARGE = 0.8


def orders(draw, made, count, weeks, allowance):
    """Orders: a part, a quantity, a release in the first part of the time, a due date with some days of allowance."""
    days = working_days(weeks)
    released = days[: max(1, len(days) - 5)]
    table = []
    for number in range(count):
        name, _, _, usual, _ = part = draw.choice(made)
        quantity = max(1, round(usual * draw.uniform(0.5, 1.5)))
        release = datetime.datetime.combine(draw.choice(released), datetime.time(6 + draw.randrange(8)))
        due = release + datetime.timedelta(days=draw.randint(*allowance))
        customer = draw.choice(["north", "south", "east", "west"])
        table.append((part, [f"A{number + 1:04}", name, quantity, release, due, draw.choice([1, 2, 2, 2, 3]), customer]))
    table.sort(key=lambda row: row[1][3])
    return table


def scales(table, weeks, share):
    """Factors on the times of each station that give it its load."""
    setup = {name: minutes for name, _, _, _, minutes, _ in STATIONS}
    work, setups, cut = {}, {}, {}
    for (_, routing, times, _, ring), row in table:
        for station, time in zip(routing, times):
            if ring and station in CUT:
                cut[station] = cut.get(station, 0.0) + row[2] * CUT[station]
            else:
                work[station] = work.get(station, 0.0) + row[2] * time
            # Every second order finds its machine set up (assumption).
            setups[station] = setups.get(station, 0.0) + 0.5 * setup[station]
    factors = {}
    for name, machines, calendar, _, _, load in STATIONS:
        days = 7 * weeks if calendar == "always" else len(working_days(weeks))
        capacity = machines * days * HOURS[calendar] * 60
        factors[name] = max(0.1, (share * load * capacity - setups.get(name, 0.0) - cut.get(name, 0.0)) / work[name])
    return factors


# Machines, tools and operations of the rings: constants of scenarios/demo.toml, where each has its source.
PROCESSES = {
    "lathe": """process = "turning"
rate = "70 EUR/h"
load_time = "1 min"
unload_time = "30 s"
tool_change_time = "2 min"
speed_range = ["15 m/min", "80 m/min"]
""",
    "mill": """process = "milling"
rate = "80 EUR/h"
load_time = "1 min"
unload_time = "30 s"
tool_change_time = "1 min"
speed_range = ["10 m/min", "300 m/min"]
""",
    "grinder": """process = "infeed"
rate = "75 EUR/h"
load_time = "1 min"
unload_time = "50 s"
""",
}
TOOLS = """[[tool]]
name = "insert"
process = "turning"
parameter_set = "ni_vk6om"
edge_cost = "6 EUR"

[[tool]]
name = "slot cutter"
process = "milling"
parameter_set = "c45_endmill_d12"
parameters = { life = { reference_speed = "30 m/min", reference_life = "40 min", reference_depth = "6 mm" }, force = { tangential_cutting = "4060 N/mm2", radial_cutting = "1640 N/mm2" } }
edge_cost = "20 EUR"

[[tool]]
name = "wheel"
process = "infeed"
parameter_set = "zb153u_40kh"
parameters = { infeed = { work_diameter = "120 mm", width = "24 mm", dulling_rate = "0.000667 mm/mm3" } }
edge_cost = "2.5 EUR"
dressing_time = "1.5 min"

"""
PASSES = {
    "lathe": """tool = "insert"
passes = 8
cutting_speed = "40 m/min"
feed_per_rev = "0.12 mm/rev"
depth_of_cut = "0.75 mm"
diameter = "120 mm"
length = "12 mm"
size_tolerance = "150 um"
scrap_on_tool_failure = 0.2
""",
    "mill": """tool = "slot cutter"
passes = 8
cutting_speed = "30 m/min"
feed_per_tooth = "0.05 mm/tooth"
depth_of_cut = "6 mm"
width_of_cut = "3 mm"
path_length = "100 mm"
size_tolerance = "250 um"
scrap_on_tool_failure = 0.3
""",
    "grinder": """tool = "wheel"
work_rotation_speed = "120 rpm"
phase = [{ infeed_per_rev = "3.5 um/rev", revolutions = 24 }, { infeed_per_rev = "1.3 um/rev", revolutions = 5 }, { infeed_per_rev = "0 um/rev", revolutions = 4 }]
size_tolerance = "5 um"
""",
}


def scenario(made, factors, weeks, name, cut):
    holidays = ", ".join(f'"{day}"' for day in HOLIDAYS)
    how = "python examples/order_table.py scenarios/shop --name mixed --orders 300 --cut" if cut else "examples/order_table.py"
    table = f"{name}.csv" if cut else "orders.csv"
    title = "A job shop with an order table, plain operations and parts that are cut" if cut else "A job shop with an order table"
    text = f"""# Made by {how}: {sum(station[1] for station in STATIONS)} machines, 12 operators.
schema = 1

[shop]
name = "{"mixed-shop" if cut else "order-table"}"
title = "{title}"
start = "{START:%Y-%m-%d %H:%M}"
horizon = "{weeks} week"
replications = {4 if cut else 20}

[tables]
orders = "{table}"

[dispatch]
rule = ["priority", "edd"]

[[calendar]]
name = "early"
week = {{ mon-fri = ["06:00-14:00"] }}
holidays = [{holidays}]

[[calendar]]
name = "late"
week = {{ mon-fri = ["14:00-22:00"] }}
holidays = [{holidays}]

[[calendar]]
name = "two shifts"
week = {{ mon-fri = ["06:00-14:00", "14:00-22:00"] }}
holidays = [{holidays}]

"""
    people = [
        ("early setter", 4, ["setup"], "early"),
        ("late setter", 4, ["setup"], "late"),
        ("early inspector", 2, ["measure"], "early"),
        ("late inspector", 2, ["measure"], "late"),
    ]
    for name, count, skills, calendar in people:
        listed = ", ".join(f'"{skill}"' for skill in skills)
        text += f'[[operator]]\nname = "{name}"\ncount = {count}\nskills = [{listed}]\ncalendar = "{calendar}"\n\n'
    for name, count, calendar, _, setup, _ in STATIONS:
        process = PROCESSES[name] if cut and name in PROCESSES else 'process = "plain"\n'
        text += f'[[machine]]\nname = "{name}"\ncount = {count}\n{process}setup_time = "{setup} min"\n'
        if calendar != "always":
            text += f'calendar = "{calendar}"\n'
        text += "\n"
    if cut:
        text += TOOLS
    for number, (name, routing, times, _, ring) in enumerate(made):
        text += f'[[part]]\nname = "{name}"\n'
        if ring:
            text += 'material_cost = "180 EUR"\nreplenish = "new_order"\nreplenish_priority = -1\n'
        for place, (station, time) in enumerate(zip(routing, times), 1):
            mean = time * factors[station]
            text += f'[[part.operation]]\nname = "{10 * place} {station}"\nmachines = "{station}"\n'
            if ring and station in PASSES:
                text += PASSES[station]
            else:
                text += f'work = {{ distribution = "lognormal", mean = "{mean:.3f} min", cv = 0.3 }}\n'
            text += f'setup_group = "{station} {number % 6}"\n'
            if station in ("lathe", "mill", "grinder"):
                text += 'operator = { setup = "setup" }\n'
            elif station == "CMM":
                text += 'operator = { run = { skill = "measure", share = 0.5 } }\n'
        text += "\n"
    return text


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("directory", type=pathlib.Path)
    options.add_argument("--orders", type=int, default=2000)
    options.add_argument("--weeks", type=int, default=6)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--name", help="name of the files with --cut")
    options.add_argument("--cut", action="store_true", help="some parts are turned, milled and ground")
    given = options.parse_args()
    if given.cut != bool(given.name):
        options.error("--cut and --name belong together")
    draw = random.Random(given.seed)
    made = parts(draw, given.cut)
    table = orders(draw, made, given.orders, given.weeks, LONG_ALLOWANCE if given.cut else ALLOWANCE)
    given.directory.mkdir(parents=True, exist_ok=True)
    with open(given.directory / (f"{given.name}.csv" if given.cut else "orders.csv"), "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["id", "part", "quantity", "release", "due", "priority", "customer"])
        for _, row in table:
            rows.writerow(row[:3] + [f"{row[3]:%Y-%m-%d %H:%M}", f"{row[4]:%Y-%m-%d %H:%M}"] + row[5:])
    text = scenario(made, scales(table, given.weeks, LARGE if given.cut else 1.0), given.weeks, given.name, given.cut)
    file = given.directory / (f"{given.name}.toml" if given.cut else "shop.toml")
    file.write_text(text, encoding="utf-8")
    print(f"{file}: {len(table)} orders")


if __name__ == "__main__":
    main()
