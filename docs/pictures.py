#!/usr/bin/env python3
"""The pictures of the documents, made by the program and taken in headless Chromium.

    python docs/pictures.py target/quick/toolroom             all of them, into docs/images
    python docs/pictures.py target/quick/toolroom grind       one of them

The report takes two minutes on two cores, the others some seconds. `gap-on-real-programs.svg` is made of measured data that
are not part of the project; gap-on-real-programs.md has the command.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENARIOS = ROOT / "scenarios"

# Picture: arguments of the program, titles of the charts that it shows (all of the page where none are named), width and height
# in pixels.
PICTURES = {
    "report": (
        ["compare", SCENARIOS / "constant-vs-adaptive.toml", "--tune", "--replications", "100"]
        + [part for policy in ("constant", "best cost", "schedule", "productivity") for part in ("--policy", policy)],
        [],
        (900, 1215),
    ),
    "contour": (
        ["contour", SCENARIOS / "contour" / "mc1.toml", "--pass", "finish"],
        ["Feed along the contour, pass finish", "What limits the feed where, pass finish, least cost"],
        (830, 1030),
    ),
    "grind": (["grind", SCENARIOS / "grinding" / "cycle.toml"], ["Infeed and stock", "Temperature rise"], (810, 810)),
    "identify": (["identify", SCENARIOS / "data" / "zb153u_trials.csv"], ["Lag K and how well it is known"], (830, 400)),
}


def browser() -> str:
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            return path
    sys.exit("no Chromium: apt-get install chromium")


def charts(page: str, titles: list[str]) -> str:
    """The page with nothing but the charts of these titles. A chart holds another one inside, the part that is clipped."""
    figures = re.findall(r"<figure.*?</figure>", page, re.S)
    shown = []
    for title in titles:
        found = [figure for figure in figures if f">{title}</text>" in figure]
        if len(found) != 1:
            sys.exit(f"{len(found)} charts are called {title!r}")
        shown.append(re.search(r"<svg.*</svg>", found[0], re.S).group())
    body = "".join(f'<div style="padding:0 10px">{svg}</div>' for svg in shown)
    return page[: page.index("<body")] + f'<body style="margin:0;background:#fff">{body}</body></html>'


def take(page: Path, picture: Path, size: tuple[int, int]) -> None:
    """A picture of the upper left part of a page."""
    width, height = size
    subprocess.run(
        [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--window-size={width},{height}",
         f"--user-data-dir={page.parent / 'profile'}", f"--screenshot={picture}", f"file://{page}"],
        check=True, capture_output=True, timeout=120,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="toolroom, compiled")
    parser.add_argument("pictures", nargs="*", choices=[[], *PICTURES], help="all of them, if left out")
    arguments = parser.parse_args()
    for name in arguments.pictures or PICTURES:
        command, titles, size = PICTURES[name]
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            subprocess.run([arguments.program, *command, "--quiet", "--out", out], check=True, stdout=subprocess.DEVNULL)
            page = out / "report.html"
            if titles:
                page.write_text(charts(page.read_text(encoding="utf-8"), titles), encoding="utf-8")
            take(page, ROOT / "docs" / "images" / f"{name}.png", size)
        print(ROOT / "docs" / "images" / f"{name}.png")


if __name__ == "__main__":
    main()
