#!/usr/bin/env python3
"""Every page that the program writes, laid out by headless Chromium.

    python3 tests/pages.py target/debug/toolroom [--only gap …] [--keep FOLDER]

Each page is laid out at 1400 px, at 700 px, in the dark at 1400 px and at the width of A4 with its print styles. It is a fault when
something is wider than its place and does not scroll in it, when a label of a chart lies on another or leaves its chart, when a text
cannot be told from what is behind it (contrast below 3 : 1), or when the page is taller than 6000 px at 1400 px. --keep leaves a picture
of every page at 1400 px, at 700 px and in the dark, to be looked at. Prints every fault, and ends with 1 where there is one.
"""

import argparse
import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "fuzz"))
import cases  # noqa: E402  (inputs that are not among the scenarios)

SCENARIOS = ROOT / "scenarios"
TALLEST = 6000
SHOPS = {
    "cells": ["demo", "--replications", "3"],
    "job-shop": ["demo", "--shop"],
    "adaptive": ["compare", "constant-vs-adaptive.toml", "--replications", "3"],
    "adverse": ["compare", "adverse.toml", "--replications", "2"],
    "chatter": ["compare", "chatter-policies.toml", "--replications", "2"],
    "grinder": ["compare", "grinder-bottleneck.toml", "--replications", "2"],
    "grinding": ["compare", "grinding-policies.toml", "--replications", "2"],
    "contours": ["compare", "contour-milling.toml", "--replications", "2"],
    "program": ["run", "housing.toml", "--replications", "2"],
    "assembly": ["run", "shop/assembly.toml", "--replications", "2"],
    "cards": ["compare", "shop/cards.toml", "--replications", "3", "--set", "shop.horizon=200 h", "--set", "shop.warm_up=20 h"],
    "crib": ["compare", "shop/crib.toml", "--replications", "4"],
    "flexible": ["compare", "shop/flexible-cell.toml", "--replications", "2"],
    "furnace": ["compare", "shop/furnace.toml", "--replications", "3", "--set", "shop.horizon=200 h", "--set", "shop.warm_up=20 h"],
    "lots": ["compare", "shop/lots.toml", "--replications", "3"],
    "orders": ["run", "shop/orders.toml", "--replications", "5"],
    "rework": ["run", "shop/rework.toml", "--replications", "2"],
    "running": ["compare", "shop/running.toml", "--replications", "2"],
    "tuned-ten": ["compare", "constant-vs-adaptive.toml", "--replications", "3", "--tune", "--set", "tune.budget=100",
                  "--set", "shop.horizon=16 h", "--set", "shop.warm_up=0 h"],
    "tuned": ["compare", "constant-vs-adaptive.toml", "--replications", "4", "--tune", "--set", "tune.budget=100",
              "--policy", "constant", "--policy", "best cost", "--policy", "schedule", "--policy", "productivity"],
}
STUDIES = {
    "life": ["life", "life/policies.toml", "--lives", "200", "--set", "sensitivity.samples=64"],
    "life-grid": ["life", "life/taylor-grid.toml", "--lives", "100"],
    "lobes": ["lobes", "chatter/milling-slot.toml", "--set", "chart.columns=60", "--set", "chart.rows=30"],
    "lobes-turning": ["lobes", "chatter/turning-bar.toml", "--set", "chart.columns=60", "--set", "chart.rows=30"],
    "lobes-power": ["lobes", "chatter/side-milling.toml", "--best", "--show", "power", "--set", "chart.columns=60", "--set", "chart.rows=30"],
    "contour": ["contour", "contour/rk3.toml", "--draws", "20"],
    "contour-mc1": ["contour", "contour/mc1.toml", "--draws", "20"],
    "grind": ["grind", "grinding/cycle.toml"],
    "identify": ["identify", "data/zb153u_trials.csv"],
    "gap": ["gap", "diagnose", "--model", "gap/turning.toml", "--data", "new/wear.csv"],
    "gap-plan": ["gap", "plan", "--model", "gap/turning.toml", "--data", "new/wear.csv"],
    "gap-predict": ["gap", "predict", "--model", "gap/turning.toml", "--data", "new/wear.csv"],
    "gap-recovery": ["gap", "recovery", "--model", "gap/turning.toml", "--truth", "gap/turning.toml", "--logs", "2"],
    "gap-loop": ["gap", "loop", "--model", "gap/turning.toml", "--data", "new/wear.csv", "--rounds", "1"],
    "gap-blind": ["gap", "blind", "--cases", "smoke", "--process", "turning", "--part", "1/9"],
}

MEASURE = f"<script>{(ROOT / 'tests/measure.js').read_text(encoding='utf-8')}</script></body>"


def browser():
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    print("skipped: no Chromium on this machine")
    sys.exit(0)


def chromium(folder, page, width, *action):
    return subprocess.run(
        [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars", f"--window-size={width},1000",
         f"--user-data-dir={folder / 'profile'}", *action, f"file://{page}"],
        check=True, capture_output=True, timeout=120, text=True).stdout  # fmt: skip


def measured(folder, text, width):
    copy = folder / "measured.html"
    text = text.replace("default-src 'none';", "").replace("script-src", "script-src 'unsafe-inline'")
    copy.write_text(text.replace("</body>", MEASURE), encoding="utf-8")
    dom = chromium(folder, copy, width, "--dump-dom", "--virtual-time-budget=2000")
    return json.loads(html.unescape(re.search(r"<title>MEASURED (.*?)</title>", dom, re.S).group(1)))


def dark(text):
    return text.replace("<html", '<html data-theme="dark"', 1)


def faults(folder, text, schedule):
    """What is wrong with a page, in words."""
    views = [("1400 px", text, 1400), ("700 px", text, 700), ("dark", dark(text), 1400), ("paper", text.replace("@media print", "@media all"), 688)]
    for view, page, width in views[:2] if schedule else views:
        found = measured(folder, page, width)
        if found["wide"] > 0:
            yield f"{view}: the page is {found['wide']} px too wide"
        for kind in ("over", "labels", "poor"):
            if found[kind]:
                yield f"{view}: {kind}: {'; '.join(dict.fromkeys(found[kind]))[:600]}"
        if view == "1400 px" and found["height"] > TALLEST:
            yield f"{view}: {found['height']} px tall"


def made(program, folder, only):
    """Pages by name."""
    def wanted(name):
        return not only or any(word in name for word in only)

    def run(name, arguments, out="--out"):
        place = folder / name
        here = [str(SCENARIOS / word) if (SCENARIOS / word).is_file() else word for word in arguments]
        done = subprocess.run([program, *here, out, place, "--quiet"], cwd=folder, capture_output=True, text=True)
        if done.returncode not in (0, 3):
            print(f"{name}: not written: {done.stderr.strip()[:400]}", flush=True)
            failed.append(name)
        return place

    failed = []
    for name, arguments in (SHOPS | STUDIES).items():
        if wanted(name):
            run(name, arguments)
    if wanted("fit"):
        lives = folder / "lives.csv"
        lives.write_text("life [min],censored,group\n" + "".join(f"{20 + i * 37 % 17},{int(i % 5 == 0)},{'ab'[i % 2]}\n" for i in range(40)))
        run("fit", ["life", "--fit", str(lives), "--bootstrap", "50", "--goodness", "19"])
    if wanted("tap"):
        (folder / "frf.csv").write_bytes(cases.responses())
        run("tap.toml", ["modes", "frf.csv", "--averages", "5"])
    if wanted("calibration"):
        run("calibration.toml", ["calibrate", "turning", "--model", "c45_t15k6", "--data", "new/wear.csv", "--limit", "0.3 mm", "--law", "extended_taylor"])
    if wanted("part"):
        run("part.html", ["program", "programs/housing.nc", "--setup", "programs/housing-setup.toml"], "--report")
        run("part-planned.html", ["program", "programs/plate.nc", "--setup", "programs/plate-setup.toml", "--objective", "time"], "--report")
    return {page.relative_to(folder): page for page in sorted(folder.rglob("*.html"))}, failed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="pages whose name has one of these")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for pictures")
    arguments = parser.parse_args()
    browser()  # without one nothing is made that nobody would look at
    with tempfile.TemporaryDirectory(prefix="toolroom-pages-") as place:
        folder = pathlib.Path(place)
        pages, unmade = made(arguments.program.resolve(), folder, arguments.only)
        count = len(unmade)
        for name, page in pages.items():
            text = page.read_text(encoding="utf-8")
            for fault in faults(folder, text, page.name == "schedule.html"):
                print(f"{name}: {fault}", flush=True)
                count += 1
            if arguments.keep:
                arguments.keep.mkdir(parents=True, exist_ok=True)
                for view, shown, width in (("1400", text, 1400), ("700", text, 700), ("dark", dark(text), 1400)):
                    shot = folder / "shot.html"
                    shot.write_text(shown, encoding="utf-8")
                    picture = arguments.keep.resolve() / f"{str(name).replace('/', '-').removesuffix('.html')}-{view}.png"
                    chromium(folder, shot, width, f"--screenshot={picture}", f"--window-size={width},6000")
        print(f"{len(pages)} pages, {count} faults")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
