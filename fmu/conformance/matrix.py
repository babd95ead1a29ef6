"""Conformance of the exported units, by importers that come from a package registry.

    python -m venv venv && venv/bin/pip install -r fmu/conformance/requirements.txt
    cargo build --release --manifest-path fmu/conformance/Cargo.toml --target-dir target/conformance
    venv/bin/python fmu/conformance/matrix.py --toolroom target/release/toolroom \\
        --fmi-rs target/conformance/release/toolroom-fmu-conformance

Every row says what was compared and with which result; a row that needs a program that is not
here says which. Exit code 1 where a row fails. T6 and T8 call the C interface directly and are
tests of the crate: `cargo test -p toolroom-fmu`. T12 compiles for minutes: `platforms.py`.
"""

import argparse
import csv
import hashlib
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
VERSIONS = (2, 3)
MODELS = ("turning", "milling", "infeed", "controller")
WEAR = "process.flank_wear"


class Failed(Exception):
    """A row that does not hold."""


class Skipped(Exception):
    """A row that cannot be tried here."""


class Matrix:
    def __init__(self, toolroom, fmi_rs, folder):
        self.toolroom = toolroom
        self.fmi_rs = fmi_rs
        self.folder = folder
        self.rows = []

    # -- helpers

    def run(self, *command, **options):
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300, **options)
        if done.returncode:
            said = (done.stderr.strip() or done.stdout.strip()).splitlines()[-3:]
            raise Failed(f"{Path(str(command[0])).name} {command[1]}: exit {done.returncode}: {' | '.join(said)}")
        return done.stdout

    def importer(self, action, *arguments):
        """Runs one action of importers.py in a process of its own."""
        environment = dict(os.environ)
        # The wheel of Ecos lacks libtbb; that of tbb puts it into lib of the environment.
        libraries = [str(Path(sys.prefix) / "lib"), environment.get("LD_LIBRARY_PATH", "")]
        environment["LD_LIBRARY_PATH"] = ":".join(path for path in libraries if path)
        return result(self.run(sys.executable, HERE / "importers.py", action, *arguments, env=environment))

    def dependencies(self, action, path):
        return result(self.run(sys.executable, HERE / "dependencies.py", action, path))

    def in_rust(self, action, *arguments, **environment):
        """Runs one action of the importer fmi-rs."""
        if not self.fmi_rs:
            raise Skipped("fmi-rs: give --fmi-rs, built from fmu/conformance/Cargo.toml")
        return result(self.run(self.fmi_rs, action, *arguments, env={**os.environ, **environment}))

    def unit(self, version, model="turning"):
        return self.folder / f"toolroom_{model}_fmi{version}.fmu"

    def member(self, version, name):
        """A file of the turning unit on disk."""
        path = self.folder / f"{version}_{Path(name).name}"
        with zipfile.ZipFile(self.unit(version)) as archive:
            path.write_bytes(archive.read(name))
        return path

    def reference(self, version):
        """Reference input and output of the package: the native core at the same steps."""
        start = "extra/org.fmi-standard.fmi-ls-ref/toolroom_turning_"
        with open(self.member(version, start + "out.csv"), newline="") as source:
            rows = {float(row["time"]): row for row in csv.DictReader(source)}
        return self.member(version, start + "in.csv"), rows

    def native(self, seconds, speed=40):
        """Wear of an edge after some seconds at the unit's start values and a speed (m/min), in one go, m."""
        cut = ["--set", f"cutting_speed={speed} m/min", "--set", "feed_per_rev=0.12 mm/rev", "--set", "depth_of_cut=0.75 mm"]
        text = self.run(self.toolroom, "point", "turning", "--tool", "ni_vk6om", *cut, "--advance", f"{seconds} s", "--json")
        return json.loads(text)["state"]["flank_wear [mm]"] * 1e-3

    def row(self, name, what, action):
        start = time.perf_counter()
        try:
            self.rows.append((name, what, "pass", action()))
        except Skipped as skipped:
            self.rows.append((name, what, "not here", str(skipped)))
        except (Failed, subprocess.TimeoutExpired, KeyError, ValueError, IndexError) as failed:
            self.rows.append((name, what, "FAIL", f"{type(failed).__name__}: {failed}"))
        wall = time.perf_counter() - start
        print(f"{name:5} {self.rows[-1][2]:9} {what}: {self.rows[-1][3]} ({wall:.1f} s)", flush=True)

    # -- rows

    def packages(self):
        """Every unit, made without network and without libclang."""
        alone = ["unshare", "--net"] if shutil.which("unshare") and os.geteuid() == 0 else []
        environment = {name: value for name, value in os.environ.items() if "CLANG" not in name}
        start = time.perf_counter()
        for model in MODELS:
            self.run(*alone, self.toolroom, "fmu", "export", model, "--out", self.folder, env=environment)
        wall = time.perf_counter() - start
        if wall > 60.0:
            raise Failed(f"{wall:.0f} s")
        tree = self.run("cargo", "tree", "--offline", "-p", "toolroom-fmu", "--edges", "normal,build", cwd=HERE.parent, env=environment)
        clang = [line for line in tree.splitlines() if "clang" in line or "bindgen" in line or "fmi-sys" in line]
        if clang:
            raise Failed(f"compiling needs libclang: {clang}")
        network = "network cut off" if alone else "network not cut off: needs unshare and root"
        return f"{2 * len(MODELS)} packages in {wall:.1f} s, {network}; nothing that is compiled for them asks for libclang"

    def symbols(self, version):
        entry = "binaries/linux64/toolroom_turning.so" if version == 2 else "binaries/x86_64-linux/toolroom_turning.so"
        if not shutil.which("nm"):
            raise Skipped("nm")
        names = self.run("nm", "-D", "--defined-only", self.member(version, entry)).split()[2::3]
        others = [name for name in names if not name.startswith("fmi")]
        if len(names) != 119 or others:
            raise Failed(f"{len(names)} symbols, not of FMI: {others[:5]}")
        return "119 functions of FMI and nothing else"

    def validate(self, version):
        problems = self.importer("validate", self.unit(version))
        if problems:
            raise Failed("; ".join(problems))
        for model in MODELS:
            self.run(self.toolroom, "fmu", "check", self.unit(version, model))
        return "FMPy: no problems found; fmu check of all units: no error"

    def validate_in_rust(self, version):
        problems = [f"{model}: {problem}" for model in MODELS for problem in self.in_rust("validate", self.unit(version, model))]
        if problems:
            raise Failed("; ".join(problems[:5]))
        return "fmi-rs: no problem in any of the units"

    def trajectory(self, version):
        # Up to its change of the edge the reference is the native core at the steps of the experiment.
        _, expected = self.reference(version)
        rows = [row for row in self.importer("cs", self.unit(version), "0.1") if row[0] < 300.0]
        worst = compare(rows, expected, least=40)
        near(worst, 1e-9, "against the native core at the same steps")
        whole = abs(self.importer("cs", self.unit(version), "1.0")[-1][1] / self.native(600) - 1)
        near(whole, 1e-7, "against toolroom point in one go, whose integrator takes other steps")
        return f"CS: {worst:.1e} against the native core at the same steps, {whole:.1e} against toolroom point"

    def exchange(self, version):
        worst = {}
        for speed in (25, 30, 40, 45):
            rows = self.importer("me", self.unit(version), speed)
            at = [row for row in rows if row[0] in (60.0, 300.0, 600.0)]
            worst[speed] = max(abs(row[1] / self.native(row[0], speed) - 1) for row in at)
            near(worst[speed], 1e-5, f"against toolroom point at a constant {speed} m/min")
        said = ", ".join(f"{value:.1e} at {speed}" for speed, value in worst.items())
        return f"ME (CVode) against toolroom point at 60, 300 and 600 s under constant speed: {said} m/min"

    def change(self, version):
        inputs, expected = self.reference(version)
        rows = self.importer("inputs", self.unit(version), inputs)
        worst = compare(rows, expected)
        near(worst, 1e-9, "against the reference results of the package")
        said = f"tool.change by table: {worst:.1e} against the package's reference results, edges {rows[-1][3]:.0f}"
        if rows[-1][3] != 2:
            raise Failed(f"tool.count is {rows[-1][3]}")
        if version == 3:
            events = compare(self.importer("events", self.unit(version), inputs), expected)
            near(events, 1e-9, "with Event Mode")
            said += f"; with Event Mode {events:.1e}"
        return said

    def state(self, version):
        file = self.folder / f"state{version}"
        saved = self.importer("save", self.unit(version), file)
        restored = self.importer("restore", self.unit(version), file)
        if saved["wear"] != restored["wear"]:
            raise Failed(f"{saved['wear']} became {restored['wear']}")
        if restored["refused"] != restored["damaged"]:
            raise Failed(f"{restored['refused']} of {restored['damaged']} damaged states were refused")
        return f"{saved['bytes']} bytes go on in another process bit for bit; damaged ones are refused"

    def state_in_rust(self, version):
        found = self.in_rust("state", self.unit(version), WEAR)
        if found["on"] != found["restored"] or not found["refused"]:
            raise Failed(str(found))
        return f"fmi-rs: {found['bytes']} bytes go on in another instance bit for bit; damaged ones are refused"

    def structure(self, version, model):
        if version == 2:
            # Both versions are made from one table: what is tried is the later one.
            two, three = (self.dependencies("declared", self.unit(each, model)) for each in VERSIONS)
            if two != [pair for pair in three if not pair[0].startswith("indicator.")]:
                raise Failed("FMI 2 and FMI 3 declare different dependencies")
            return f"{len(two)} pairs, those of FMI 3 but for its event indicators"
        found = self.dependencies("compare", self.unit(version, model))
        for fault in ("hidden", "idle"):
            if found[fault]:
                what = "depend and are not declared" if fault == "hidden" else "are declared and do not depend"
                raise Failed(f"{len(found[fault])} pairs {what}: {found[fault][:4]}")
        return f"of {found['tried']} pairs of unknown and known exactly the {found['declared']} declared ones depend"

    def memory(self, version):
        growth = self.importer("cycles", self.unit(version), 3000)["growth_kB"]
        if growth >= 1024:
            raise Failed(f"{growth} kB more after 3000 instances")
        different = self.importer("threads", self.unit(version))["different"]
        if different != 1:
            raise Failed(f"4 threads with 4 instances each gave {different} different results")
        return f"3000 instances: {growth} kB; 4 threads with 4 instances each: one result"

    def ecos(self, version):
        return self.against("ecos", version)

    def libcosim(self, version):
        if version == 3:
            raise Skipped("libcosimpy 0.0.6 crashes on every unit of FMI 3.0")
        return self.against("libcosim", version)

    def rust(self, version):
        return self.against("fmi-rs", version)

    def against(self, importer, version):
        unit = self.unit(version)
        rows = self.in_rust("cs", unit, WEAR) if importer == "fmi-rs" else self.importer(importer, unit)
        fmpy = {row[0]: row[1] for row in self.importer("cs", self.unit(version), "1.0")}
        worst = 0.0
        for at, wear in rows:
            # Ecos rounds its end time; its own time says which point it is.
            worst = max(worst, abs(wear / fmpy[round(at)] - 1))
        near(worst, 1e-9, "against FMPy")
        return f"{worst:.1e} against FMPy at six points up to {rows[-1][0]:.0f} s"

    def package_twice(self):
        again = self.folder / "again"
        self.run(self.toolroom, "fmu", "export", "turning", "--out", again)
        digests = []
        for version in VERSIONS:
            pair = [hashlib.sha256(path.read_bytes()).hexdigest() for path in (self.unit(version), again / self.unit(version).name)]
            if pair[0] != pair[1]:
                raise Failed(f"FMI {version}: {pair[0][:12]} and {pair[1][:12]}")
            digests.append(pair[0][:12])
        return f"same bytes: {', '.join(digests)}"

    def simulated_here(self, version):
        table = self.folder / f"sim{version}.csv"
        done = subprocess.run(
            [self.toolroom, "fmu", "sim", str(self.unit(version)), "--stop", "600 s", "--step", "1 s", "--output", str(table)],
            capture_output=True,
            text=True,
        )
        if "built without" in done.stderr:
            raise Skipped("this toolroom was built without --features fmu-import")
        if done.returncode:
            raise Failed(done.stderr.strip())
        with open(table, newline="") as source:
            rows = [(float(row["time [s]"]), float(row["process.flank_wear [m]"])) for row in csv.DictReader(source)]
        fmpy = {row[0]: row[1] for row in self.importer("cs", self.unit(version), "1.0")}
        worst = max(abs(wear / fmpy[at] - 1) for at, wear in rows if at > 0)
        near(worst, 1e-12, "against FMPy")
        return f"toolroom fmu sim (fmi crate): {worst:.1e} against FMPy"

    def peer(self):
        """A unit by pythonfmu, made once."""
        gain = self.folder / "Gain.fmu"
        if not gain.is_file():
            self.run(Path(sys.executable).with_name("pythonfmu"), "build", "-f", HERE / "gain.py", "-d", self.folder)
        return gain

    def units(self):
        yield from ((f"toolroom FMI {version}", self.unit(version), WEAR) for version in VERSIONS)
        yield "pythonfmu gain", self.peer(), "y"

    def speeds(self):
        said = []
        for name, path, output in self.units():
            found = self.importer("speed", path, output)
            said.append(f"{name} {found['step_us']:.1f} us a step, {found['get_us']:.1f} us a value")
        return "through FMPy: " + "; ".join(said)

    def speeds_in_rust(self):
        said = []
        for name, path, output in self.units():
            # A unit by pythonfmu wants a program with Python in it.
            python = Path(sysconfig.get_config_var("LIBDIR")) / str(sysconfig.get_config_var("INSTSONAME"))
            if output == "y" and not python.name.count(".so"):
                said.append(f"{name} not run: Python is not a shared library here")
                continue
            environment = {"LD_PRELOAD": str(python), "PYTHONPATH": sysconfig.get_path("purelib")} if output == "y" else {}
            found = self.in_rust("speed", path, output, **environment)
            said.append(f"{name} " + ", ".join(f"{what} {nanoseconds:.0f} ns" for what, nanoseconds in found.items()))
        return "through fmi-rs: " + "; ".join(said)

    def cell(self):
        """The lathe of a shop with its controller, in FMPy's master and in our own."""
        package, table = self.folder / "cell.ssp", self.folder / "cell.csv"
        scenario = HERE.parent.parent / "scenarios" / "lathe-cell.toml"
        self.run(self.toolroom, "ssp", "export", scenario, "--machine", "L", "--out", package)
        # FMPy begins with inputs of 0 in its first step and hands signals on after each.
        step, stop = 0.5, 1800.0
        rows = self.importer("cell", package, stop, step)
        sim = [self.toolroom, "ssp", "sim", package, "--order", "jacobi", "--stop", f"{stop} s", "--step", f"{step} s"]
        done = subprocess.run([*map(str, sim), "--output", str(table)], capture_output=True, text=True)
        if "built without" in done.stderr:
            raise Skipped("this toolroom was built without --features fmu-import")
        if done.returncode:
            raise Failed(done.stderr.strip())
        with open(table, newline="") as source:
            own = [(float(row["lathe.process.flank_wear [m]"]), float(row["lathe.tool.count"])) for row in csv.DictReader(source)]
        said = [f"FMPy's master {self.apart([(wear, edge) for _, wear, _, edge in rows], own, 1e-2)}"]
        flat = self.folder / "flat.ssp"
        self.run(self.toolroom, "ssp", "export", scenario, "--machine", "L", "--flat", "--out", flat)
        for name, action in (("Ecos", "cell_in_ecos"), ("libcosim", "cell_in_libcosim")):
            rows = self.importer(action, flat, stop, step)
            said.append(f"that of {name} {self.apart([row[1:] for row in rows], own, 1e-9)}")
        return f"{', '.join(said)} of the greatest wear from the own one over {stop:.0f} s"

    @staticmethod
    def apart(theirs, own, limit):
        """Greatest difference of wear at points with the same edge, over the greatest wear; rows of wear and edges."""
        edges = theirs[-1][1]
        # At the change of an edge one of the two may be a step ahead.
        same = [abs(each - wear) for (each, edge), (wear, other) in zip(theirs, own[1:]) if edge == other]
        if len(same) < 0.99 * len(theirs) or edges < 2:
            raise Failed(f"{len(same)} of {len(theirs)} points with the same edge, {edges:.0f} edges")
        worst = max(same) / max(wear for wear, _ in own)
        near(worst, limit, "of the greatest wear against the own master")
        return f"{worst:.1e} ({edges:.0f} edges)"

    def on_path(self, program, *runs):
        if not shutil.which(program):
            raise Skipped(f"{program} is not on PATH")
        for version in VERSIONS:
            for arguments in runs:
                self.run(program, *[str(self.unit(version)) if part == "F" else part for part in arguments.split()])
        return "clean"


def result(text):
    """The line of JSON of an importer, which may print before it."""
    return json.loads([line for line in text.splitlines() if line[:1] in "[{"][-1])


def near(worst, bound, what):
    if not worst <= bound:
        raise Failed(f"{worst:.2e} {what}, {bound:.0e} is allowed")


def compare(rows, expected, least=90):
    """Greatest relative difference of wear and temperature at the times of the reference."""
    worst, seen = 0.0, 0
    for at, wear, temperature, _ in rows:
        row = expected.get(round(at, 9))
        if row is None:
            continue
        # At the change itself a table may be read before or after it.
        if abs(at - 300.0) < 1e-6:
            continue
        seen += 1
        for value, name in ((wear, "process.flank_wear"), (temperature, "process.temperature")):
            due = float(row[name])
            worst = max(worst, abs(value - due) / abs(due) if due else abs(value))
    if seen < least:
        raise Failed(f"only {seen} common times")
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--toolroom", required=True, help="the program that exports the units")
    parser.add_argument("--fmi-rs", help="the importer of this folder's Cargo.toml; its rows are left out without")
    options = parser.parse_args()
    fmi_rs = Path(options.fmi_rs).resolve() if options.fmi_rs else None
    with tempfile.TemporaryDirectory() as folder:
        matrix = Matrix(Path(options.toolroom).resolve(), fmi_rs, Path(folder))
        matrix.row("T0", "packages", matrix.packages)
        if matrix.rows[0][2] != "pass":
            return 1
        for version in VERSIONS:
            of = f"FMI {version}"
            matrix.row("T1", f"{of} symbols", lambda: matrix.symbols(version))
            matrix.row("T2", f"{of} description", lambda: matrix.validate(version))
            matrix.row("T2", f"{of} description", lambda: matrix.validate_in_rust(version))
            matrix.row("T3", f"{of} trajectory", lambda: matrix.trajectory(version))
            matrix.row("T3", f"{of} trajectory", lambda: matrix.exchange(version))
            matrix.row("T4", f"{of} tool change", lambda: matrix.change(version))
            matrix.row("T5", f"{of} state", lambda: matrix.state(version))
            matrix.row("T5", f"{of} state", lambda: matrix.state_in_rust(version))
            for model in ("turning", "milling"):
                matrix.row("T7", f"{of} dependencies of {model}", lambda: matrix.structure(version, model))
            matrix.row("T9", f"{of} memory", lambda: matrix.memory(version))
            matrix.row("T10", f"{of} Ecos", lambda: matrix.ecos(version))
            matrix.row("T10", f"{of} libcosim", lambda: matrix.libcosim(version))
            matrix.row("T10", f"{of} fmi-rs", lambda: matrix.rust(version))
            matrix.row("T11", f"{of} own importer", lambda: matrix.simulated_here(version))
        matrix.row("T13", "speed", matrix.speeds)
        matrix.row("T13", "speed", matrix.speeds_in_rust)
        matrix.row("T14", "package", matrix.package_twice)
        matrix.row("T16", "cell as SSP", matrix.cell)
        simulate = "simulate --interface-type cs --stop-time 600 F"
        matrix.row("T15", "fmusim", lambda: matrix.on_path("fmusim", "validate F", simulate))
        run = "--mode=cs --suppressPath=true --stopTime=600 F"
        matrix.row("T15", "OMSimulator", lambda: matrix.on_path("OMSimulator", run))
        matrix.row("T15", "fmuCheck", lambda: matrix.on_path("fmuCheck.linux64", "-l 4 F"))
        failed = sum(1 for row in matrix.rows if row[2] == "FAIL")
        print(f"{len(matrix.rows)} rows, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
