"""Packages for several platforms: what is in them, and the same bits wherever they can be run.

    pip install cargo-zigbuild ziglang        (both on PATH)
    rustup target add aarch64-unknown-linux-gnu x86_64-pc-windows-gnu x86_64-apple-darwin aarch64-apple-darwin
    python fmu/conformance/platforms.py --toolroom target/release/toolroom

The unit is exported for all platforms, which compiles it five times. Its libraries are run by a
small importer (runner.c) that zig compiles for each platform: here, in qemu-aarch64 with the
libraries of Debian's libc6-arm64-cross, in wine. What cannot be run here is said. Exit code 1
where a library lacks something or a platform gives other bits.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
OUTPUTS = ("process.flank_wear", "process.temperature", "process.cutting_force")
# Folder in a package of FMI 2.0, target of zig, how to run it here.
PLATFORMS = (
    ("linux64", "x86_64-linux-gnu.2.17", []),
    ("aarch64-linux", "aarch64-linux-gnu.2.17", ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]),
    ("win64", "x86_64-windows-gnu", ["wine"]),
    ("darwin64", None, []),
    ("aarch64-darwin", None, []),
)


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=3600, **options)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr.strip() or done.stdout.strip()}")
    return done


def bits(folder, library, target, machine, token, references):
    """What the library gives on its platform."""
    runner = folder / f"runner-{target}.exe"
    # Of wine's and Debian's standard libraries only what every system has is used.
    run(sys.executable, "-m", "ziglang", "cc", "-O1", "-target", target, HERE / "runner.c", "-o", runner, "-ldl" if "linux" in target else "-lkernel32")
    environment = {**os.environ, "WINEDEBUG": "-all", "WINEPREFIX": str(folder / "wine")}
    if "windows" in target:
        # Rust's library asks for a system library of Windows 10 that old versions of wine lack.
        source = folder / "bcryptprimitives.c"
        source.write_text(
            "__declspec(dllimport) unsigned char __stdcall SystemFunction036(void *, unsigned long);\n"
            "__declspec(dllexport) int __stdcall ProcessPrng(unsigned char *data, unsigned long long size) {\n"
            "    return SystemFunction036(data, (unsigned long)size);\n}\n"
        )
        run(sys.executable, "-m", "ziglang", "cc", "-shared", "-target", target, source, "-o", folder / "bcryptprimitives.dll", "-ladvapi32")
    return run(*machine, runner, library, token, *references, env=environment, cwd=folder).stdout.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--toolroom", required=True, help="the program that exports the units")
    parser.add_argument("--packages", help="folder of packages exported before, which are then not made again")
    options = parser.parse_args()
    toolroom = Path(options.toolroom).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        packages = Path(options.packages).resolve() if options.packages else folder
        if not options.packages:
            said = run(toolroom, "fmu", "export", "turning", "--platforms", "all", "--out", packages)
            print(said.stdout.strip(), said.stderr.strip(), sep="\n")
        for version in (2, 3):
            print(run(toolroom, "fmu", "check", packages / f"toolroom_turning_fmi{version}.fmu").stderr.strip())
        with zipfile.ZipFile(packages / "toolroom_turning_fmi2.fmu") as archive:
            archive.extractall(folder / "unit")
        description = ElementTree.parse(folder / "unit/modelDescription.xml").getroot()
        variables = {each.get("name"): each.get("valueReference") for each in description.iter("ScalarVariable")}
        references = [variables[output] for output in OUTPUTS]
        found = {}
        for place, target, machine in PLATFORMS:
            library = next((folder / "unit/binaries" / place).glob("*"), None)
            if library is None:
                print(f"{place}: not in the package")
                continue
            kind = run("file", "-b", library).stdout.strip() if shutil.which("file") else "file is not here"
            said = f"{place}: {library.stat().st_size // 1000} kB, {kind}"
            wine = next((each for each in ("wine", "wine64", "/usr/lib/wine/wine64") if shutil.which(each)), None)
            machine = [wine or "wine"] if machine == ["wine"] else machine
            if target is None:
                print(f"{said}; not run: there is no macOS here")
            elif machine and not shutil.which(machine[0]):
                print(f"{said}; not run: {machine[0]} is not on PATH")
            else:
                found[place] = bits(folder, library, target, machine, description.get("guid"), references)
                print(f"{said}; runs: {found[place]}")
        if len(set(found.values())) > 1:
            sys.exit("the platforms differ")
        print(f"{', '.join(found)}: the same bits")


if __name__ == "__main__":
    main()
