#!/usr/bin/env python3
"""The documents hold: links lead somewhere, the examples of `new` run, and so do the commands of the pages in an empty folder,
which print what these show: the tutorial and the guide of order systems.

    python3 tests/docs.py target/debug/toolroom

Blocks of `sh` are run as they stand, by a shell whose PATH has the program and the system's tools; each has to end with
exit code 0. A block after a line "File `NAME`:" is saved, and "In `NAME`, replace `A` by `B`." is done. Each line of a block of
`text` has to be among the lines that the commands before it printed, spaces aside; `…` alone stands for lines left out.
"""

import argparse
import difflib
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = [ROOT / "docs/tutorial.md", ROOT / "docs/guide/order-system.md"]
FENCE = re.compile(r"^```(\w*)$")
FILE = re.compile(r"^File `([^`]+)`:$")
REPLACE = re.compile(r"^In `([^`]+)`, replace `([^`]+)` by `([^`]+)`\.$")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
# A command that takes longer has hung.
LONGEST = 300


def steps(text):
    """What a page asks for, in order: (kind, content, number of the first line)."""
    lines, i = text.splitlines(), 0
    while i < len(lines):
        fence, replace = FENCE.match(lines[i]), REPLACE.match(lines[i])
        if replace:
            yield "replace", replace.groups(), i + 1
        if fence:
            end = lines.index("```", i + 1)
            named = FILE.match(lines[i - 1]) if i else None
            content = "\n".join(lines[i + 1:end]) + "\n"
            yield ("file", (named[1], content), i + 1) if named else (fence[1], content, i + 1)
            i = end
        i += 1


def bare(line):
    return " ".join(line.split())


def follow(page, program):
    """Runs a page in an empty folder. Lines that were promised and not printed."""
    missing, printed = [], []
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as home:
        tools = pathlib.Path(home) / "bin"
        tools.mkdir()
        (tools / "toolroom").symlink_to(program.resolve())
        environment = {"PATH": f"{tools}:/usr/bin:/bin", "HOME": home, "LANG": "C.UTF-8"}
        for kind, content, line in steps(page.read_text(encoding="utf-8")):
            place = f"{page.relative_to(ROOT)}:{line}"
            if kind == "file":
                (pathlib.Path(folder) / content[0]).write_text(content[1], encoding="utf-8")
            elif kind == "replace":
                name, old, new = content
                path = pathlib.Path(folder) / name
                text = path.read_text(encoding="utf-8")
                if text.count(old) != 1:
                    sys.exit(f"{place}: {name} has `{old}` {text.count(old)} times")
                path.write_text(text.replace(old, new), encoding="utf-8")
            elif kind == "sh":
                printed = []
                for command in content.splitlines():
                    start = time.monotonic()
                    done = subprocess.run(["sh", "-c", command], cwd=folder, env=environment, capture_output=True,
                                          text=True, timeout=LONGEST, check=False)
                    if done.returncode:
                        sys.exit(f"{place}: `{command}` ends with {done.returncode}\n{done.stdout}{done.stderr}")
                    print(f"{time.monotonic() - start:6.1f} s  {command}", flush=True)
                    printed += [bare(own) for own in (done.stdout + done.stderr).splitlines()]
            elif kind == "text":
                promised = [own for own in content.splitlines() if bare(own) not in ("…", *printed)]
                nearest = lambda own: (difflib.get_close_matches(bare(own), printed, 1, 0) or ["nothing"])[0]
                missing += [(place, f"{own}\n    printed: {nearest(own)}") for own in promised]
    return missing


def examples(program):
    """Writes the example of every kind, and runs the commands that `new` names for it in its folder."""
    usage = subprocess.run([program, "new", "--help"], capture_output=True, text=True, check=True).stdout
    kinds = re.findall(r"^\s+- ([\w-]+):", usage, flags=re.M)
    assert len(kinds) > 10, usage
    for kind in kinds:
        with tempfile.TemporaryDirectory() as folder:
            answer = subprocess.run([program, "new", kind, folder + "/new", "--json"], capture_output=True, text=True, check=True)
            for command in json.loads(answer.stdout)["next"]:
                start = time.monotonic()
                words = shlex.split(command)
                assert words[0] == "toolroom", command
                done = subprocess.run([program, *words[1:]], cwd=folder + "/new", capture_output=True, text=True,
                                      timeout=LONGEST, check=False)
                if done.returncode:
                    sys.exit(f"new {kind}: `{command}` ends with {done.returncode}\n{done.stdout}{done.stderr}")
                print(f"{time.monotonic() - start:6.1f} s  {command}", flush=True)


def dead_links(page):
    """Links of a page to files and headings that are not there."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    for link in LINK.findall(text):
        if "://" in link or link.startswith("mailto:"):
            continue
        name, _, heading = link.partition("#")
        target = (page.parent / name).resolve() if name else page
        if not target.exists():
            yield link
        elif heading and target.suffix == ".md":
            heads = re.findall(r"^#+ (.+)$", target.read_text(encoding="utf-8"), flags=re.M)
            slug = lambda head: re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", head).lower()).replace(" ", "-")
            if heading not in [slug(head) for head in heads]:
                yield link


def book():
    """Every page of docs stands in the table of contents of the book, or in the pages below a folder that it names."""
    summary = (ROOT / "docs/SUMMARY.md").read_text(encoding="utf-8")
    named = {link.partition("#")[0] for link in LINK.findall(summary)}
    pages = {str(path.relative_to(ROOT / "docs")) for path in (ROOT / "docs").rglob("*.md")}
    return sorted(page for page in pages - named if not page.startswith("gap-benchmark/") and page != "SUMMARY.md")


def front_door():
    """What is wrong with the two commands that README.md promises: one for the main job, one for all tests, that of the
    continuous integration."""
    block = (ROOT / "README.md").read_text().split("```sh\n")[1].split("```")[0]
    commands = [line.partition("#")[0].strip() for line in block.splitlines()]
    scenario = pathlib.Path(commands[0].split()[-1])
    if not (commands[0].startswith("cargo run ") and (ROOT / scenario).is_file()):
        return f"README.md begins with `{commands[0]}`, which runs no scenario of this repository"
    if commands[1:] != ["cargo test --workspace"] or commands[1] not in (ROOT / ".ci/run").read_text():
        return "README.md does not name the command that passes all tests after the main job"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    arguments = parser.parse_args()
    reference = ROOT / "docs/reference"
    done = subprocess.run([arguments.program.resolve(), "reference", reference, "--quiet"], check=False)
    if done.returncode:
        sys.exit("toolroom reference fails")
    pages = [ROOT / "README.md", ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md", ROOT / "python/README.md",
             *sorted((ROOT / "docs").rglob("*.md"))]
    dead = [f"{page.relative_to(ROOT)}: {link}" for page in pages for link in dead_links(page)]
    if dead:
        sys.exit("links that lead nowhere:\n  " + "\n  ".join(dead))
    if book():
        sys.exit(f"pages that docs/SUMMARY.md does not name: {', '.join(book())}")
    print(f"{len(pages)} pages, every link leads somewhere")
    if front_door():
        sys.exit(front_door())
    examples(arguments.program.resolve())
    for page in PAGES:
        start = time.monotonic()
        missing = follow(page, arguments.program)
        if missing:
            sys.exit("promised and not printed:\n" + "\n".join(f"  {place}: {line}" for place, line in missing))
        print(f"{page.relative_to(ROOT)} took {time.monotonic() - start:.0f} s, and prints what the page shows")


if __name__ == "__main__":
    main()
