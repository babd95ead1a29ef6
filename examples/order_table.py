"""Writes an order table of a size that plants have: 40 machines, 12 operators, 2000 orders in six weeks.

    python examples/order_table.py DIR [--orders 2000] [--weeks 6] [--seed 1]
    toolroom check DIR/shop.toml
    toolroom run DIR/shop.toml --replications 20

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
HOURS = {"early": 8.0, "two shifts": 16.0, "always": 24.0}
START = datetime.datetime(2026, 3, 30)  # a Monday
HOLIDAYS = [datetime.date(2026, 4, 3), datetime.date(2026, 4, 6)]


def parts(draw):
    """Parts: name, routing, times against others by operation, usual quantity."""
    made = []
    for number in range(PARTS):
        routing = ROUTINGS[number % len(ROUTINGS)]
        mean = {name: time for name, _, _, time, _, _ in STATIONS}
        times = [mean[station] * draw.uniform(0.5, 1.6) for station in routing]
        made.append((f"P{number + 1:02}", routing, times, draw.choice([5, 10, 15, 20, 30, 40])))
    return made


def working_days(weeks):
    days = [START.date() + datetime.timedelta(days=day) for day in range(7 * weeks)]
    return [day for day in days if day.weekday() < 5 and day not in HOLIDAYS]


def orders(draw, made, count, weeks):
    """Orders: a part, a quantity, a release in the first part of the time, a due date with 5 to 12 days of allowance."""
    days = working_days(weeks)
    released = days[: max(1, len(days) - 5)]
    table = []
    for number in range(count):
        name, _, _, usual = part = draw.choice(made)
        quantity = max(1, round(usual * draw.uniform(0.5, 1.5)))
        release = datetime.datetime.combine(draw.choice(released), datetime.time(6 + draw.randrange(8)))
        due = release + datetime.timedelta(days=draw.randint(5, 12))
        customer = draw.choice(["north", "south", "east", "west"])
        table.append((part, [f"A{number + 1:04}", name, quantity, release, due, draw.choice([1, 2, 2, 2, 3]), customer]))
    table.sort(key=lambda row: row[1][3])
    return table


def scales(table, weeks):
    """Factors on the times of each station that give it its load."""
    setup = {name: minutes for name, _, _, _, minutes, _ in STATIONS}
    work, setups = {}, {}
    for (_, routing, times, _), row in table:
        for station, time in zip(routing, times):
            work[station] = work.get(station, 0.0) + row[2] * time
            # Every second order finds its machine set up (assumption).
            setups[station] = setups.get(station, 0.0) + 0.5 * setup[station]
    factors = {}
    for name, machines, calendar, _, _, load in STATIONS:
        days = 7 * weeks if calendar == "always" else len(working_days(weeks))
        capacity = machines * days * HOURS[calendar] * 60
        factors[name] = max(0.1, (load * capacity - setups.get(name, 0.0)) / work[name])
    return factors


def scenario(made, factors, weeks):
    holidays = ", ".join(f'"{day}"' for day in HOLIDAYS)
    text = f"""# Made by examples/order_table.py: {sum(station[1] for station in STATIONS)} machines, 12 operators.
schema = 1

[shop]
name = "order-table"
title = "A job shop with an order table"
start = "{START:%Y-%m-%d %H:%M}"
horizon = "{weeks} week"
replications = 20

[tables]
orders = "orders.csv"

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
        text += f'[[machine]]\nname = "{name}"\ncount = {count}\nprocess = "plain"\nsetup_time = "{setup} min"\n'
        if calendar != "always":
            text += f'calendar = "{calendar}"\n'
        text += "\n"
    for number, (name, routing, times, _) in enumerate(made):
        text += f'[[part]]\nname = "{name}"\n'
        for place, (station, time) in enumerate(zip(routing, times), 1):
            mean = time * factors[station]
            text += (
                f'[[part.operation]]\nname = "{10 * place} {station}"\nmachines = "{station}"\n'
                f'work = {{ distribution = "lognormal", mean = "{mean:.3f} min", cv = 0.3 }}\n'
                f'setup_group = "{station} {number % 6}"\n'
            )
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
    given = options.parse_args()
    draw = random.Random(given.seed)
    made = parts(draw)
    table = orders(draw, made, given.orders, given.weeks)
    given.directory.mkdir(parents=True, exist_ok=True)
    with open(given.directory / "orders.csv", "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["id", "part", "quantity", "release", "due", "priority", "customer"])
        for _, row in table:
            rows.writerow(row[:3] + [f"{row[3]:%Y-%m-%d %H:%M}", f"{row[4]:%Y-%m-%d %H:%M}"] + row[5:])
    text = scenario(made, scales(table, given.weeks), given.weeks)
    (given.directory / "shop.toml").write_text(text, encoding="utf-8")
    print(f"{given.directory / 'shop.toml'}: {len(table)} orders")


if __name__ == "__main__":
    main()
