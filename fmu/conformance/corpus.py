"""The Reference FMUs of the standard's makers through `toolroom fmu check` and `toolroom fmu sim`, against FMPy.

    git clone https://github.com/modelica/Reference-FMUs && cd Reference-FMUs
    for v in 2 3; do cmake -S . -B b$v -DFMI_VERSION=$v -DWITH_FMUSIM=OFF && cmake --build b$v; done
    venv/bin/python fmu/conformance/corpus.py --toolroom target/release/toolroom Reference-FMUs/b2/fmus Reference-FMUs/b3/fmus

and any other folder of units, such as toolroom's own. Prints a table in Markdown, one row a unit, version and interface:
what `fmu check` and FMPy's validation say; the largest difference of the outputs at the communication points between
toolroom and FMPy, relative to the largest value of each output; and what Ecos and libcosim, which read Co-Simulation only,
make of the first real output at the end, where they are installed. Exit code 1 where the two checks disagree, or where toolroom
cannot run what FMPy can.
"""

import argparse
import csv
import json
import math
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

NAMES = {"CoSimulation": "co-simulation", "ModelExchange": "model-exchange"}
SHOWN = {"CoSimulation": "Co-Simulation", "ModelExchange": "Model Exchange"}
# A driver of CVode at a relative tolerance of 1e-8 beside our own; units of Co-Simulation step by themselves.
LIMITS = {"CoSimulation": 1e-9, "ModelExchange": 1e-4}
FMPY = """
import json, sys, fmpy
path, kind, stop, step = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
result = fmpy.simulate_fmu(path, fmi_type=kind, stop_time=stop, step_size=step, output_interval=step,
                           relative_tolerance=1e-8, record_events=False)
columns = {}
for name in result.dtype.names:
    values = result[name]
    if values.dtype.kind in "fiub":
        flat = values.reshape(len(values), -1).astype(float)
        shape = values.shape[1:]
        for i in range(flat.shape[1]):
            index, rest = [], i
            for extent in reversed(shape):
                index.insert(0, rest % extent + 1)
                rest //= extent
            columns[name + (f"[{','.join(map(str, index))}]" if shape else "")] = flat[:, i].tolist()
print(json.dumps(columns))
"""
# Other importers: time and value of an output after a number of steps, each in a process of its own.
OTHERS = {
    "Ecos": r"""
import json, sys
from ecospy.EcosSimulation import EcosSimulation
from ecospy.EcosSimulationStructure import EcosSimulationStructure
path, step, count, name = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
structure = EcosSimulationStructure()
structure.add_model("unit", path)
simulation = EcosSimulation(structure=structure, step_size=step)
simulation.init()
simulation.step(count)
print("\nresult", json.dumps([simulation.get_time(), simulation.get_real("unit::" + name)]))
""",
    "libcosim": r"""
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave
path, step, count, name = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
execution = CosimExecution.from_step_size(round(step * 1e9))
unit = execution.add_local_slave(CosimLocalSlave(path, "unit"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
reference = {each.name.decode(): each.reference for each in execution.slave_variables(unit)}[name]
execution.step(count)
print("\nresult", json.dumps([step * count, observer.last_real_values(slave_index=unit, variable_references=[reference])[0]]))
""",
}


def run(command, seconds=60, **options):
    try:
        return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=seconds, **options)
    except subprocess.TimeoutExpired:
        return None


def validated(path):
    """What FMPy's validation says: nothing, or its first finding."""
    from fmpy.validation import validate_fmu

    try:
        problems = validate_fmu(str(path))
    except Exception as error:  # a parser's own error is a finding as well
        problems = [str(error)]
    return problems


def with_python():
    """The environment for units that want a program with Python in it."""
    library = Path(sysconfig.get_config_var("LIBDIR")) / str(sysconfig.get_config_var("INSTSONAME"))
    return {**os.environ, "LD_PRELOAD": str(library), "PYTHONPATH": sysconfig.get_path("purelib")}


def told(text):
    """Why a simulation ended, without what differs from one run to the next: names of files, times that are rounded."""
    reason = " ".join(text.replace("error: ", "").split("\n  help")[0].split())
    reason = re.sub(r"^at \S+ s: ", "", re.sub(r"; \S+ holds what came before$", "", reason))
    return re.sub(r"\b(\d+\.\d{2})\d+", r"\1", reason)


def simulated(toolroom, path, kind, stop, step, folder, environment=None):
    """Columns of `fmu sim` by their names, or none, and how it went."""
    table = Path(folder) / "rows.csv"
    command = [toolroom, "fmu", "sim", path, "--interface", NAMES[kind], "--stop", f"{stop} s", "--step", f"{step} s"]
    done = run([*command, "--output", table, "--force"], env=environment)
    if done and "needs the library of Python" in done.stderr and environment is None:
        return simulated(toolroom, path, kind, stop, step, folder, with_python())
    if done is None:
        return None, "no end within a minute"
    if done.returncode:
        return None, told(done.stderr)
    with open(table, newline="") as file:
        rows = list(csv.reader(file))
    names = [name.split(" [")[0] for name in rows[0]]
    columns = {}
    for i, name in enumerate(names):
        try:
            columns[name] = [float(row[i]) for row in rows[1:]]
        except ValueError:
            continue  # texts
    return columns, "runs, with Python preloaded" if environment else "runs"


def difference(ours, theirs):
    """Largest difference at times that both have, relative to the largest value of the output."""
    worst = 0.0
    at = {round(time, 9): i for i, time in reversed(list(enumerate(theirs["time"])))}
    last = {round(time, 9): i for i, time in enumerate(theirs["time"])}
    for name, values in ours.items():
        if name == "time" or name not in theirs:
            continue
        scale = max(abs(value) for value in theirs[name]) or 1.0
        for time, value in zip(ours["time"], values):
            rows = {table.get(round(time, 9)) for table in (at, last)} - {None}
            if rows:  # an instant of an event has two rows there
                worst = max(worst, min(abs(value - theirs[name][row]) for row in rows) / scale)
    return worst


def elsewhere(importer, path, step, steps, name, theirs):
    """What another importer makes of an output: its difference to FMPy, relative to the largest value, or how it failed."""
    environment = dict(os.environ)
    # The wheel of Ecos lacks libtbb; that of tbb puts it into lib of the environment.
    libraries = [str(Path(sys.prefix) / "lib"), environment.get("LD_LIBRARY_PATH", "")]
    environment["LD_LIBRARY_PATH"] = ":".join(each for each in libraries if each)
    done = run([sys.executable, "-c", OTHERS[importer], path, step, steps, name], env=environment)
    if done is None:
        return "no end within a minute"
    if done.returncode < 0:
        return f"crashes (signal {-done.returncode})"
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["fails"])[-1]
        return "not installed" if "ModuleNotFoundError" in said else "refuses"
    results = [line for line in done.stdout.splitlines() if line.startswith("result ")]
    if not results:
        return "refuses"
    time, value = json.loads(results[-1].removeprefix("result "))
    near = [i for i, other in enumerate(theirs["time"]) if abs(other - time) < 1e-6 * max(1.0, time)]
    if not near:
        return f"ends at {time:g} s"
    scale = max(abs(each) for each in theirs[name]) or 1.0
    worst = min(abs(value - theirs[name][i]) for i in near) / scale
    return "0" if worst == 0 else f"{worst:.0e}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--toolroom", required=True)
    parser.add_argument("folders", nargs="+", type=Path)
    arguments = parser.parse_args()
    import fmpy

    failed = []
    print("| unit | FMI | interface | `fmu check`, FMPy validate | `fmu sim` | difference to FMPy | Ecos | libcosim |")
    print("|---|---|---|---|---|---|---|---|")
    for path in sorted(each for folder in arguments.folders for each in folder.glob("*.fmu")):
        problems = validated(path)
        checked = run([arguments.toolroom, "fmu", "check", path, "--json"])
        sound = checked is not None and checked.returncode == 0
        verdict = {(True, True): "sound", (False, False): "faulty"}.get((sound, not problems), "**disagree**")
        if sound != (not problems):
            failed.append(f"{path}: fmu check {'finds nothing' if sound else checked.stdout}, FMPy: {problems}")
        description = fmpy.read_model_description(str(path), validate=False)
        kinds = {"CoSimulation": description.coSimulation, "ModelExchange": description.modelExchange}
        if not any(kinds.values()):
            print(f"| {path.stem} | {description.fmiVersion} | Scheduled Execution | {verdict} | not driven | – | – | – |")
        for kind in (kind for kind, there in kinds.items() if there):
            own = description.defaultExperiment
            stop = float(own.stopTime or 1.0) if own else 1.0
            step = float(own.stepSize or stop / 500) if own else stop / 500
            with tempfile.TemporaryDirectory() as folder:
                ours, ran = simulated(arguments.toolroom, path, kind, stop, step, folder)
            done = run([sys.executable, "-c", FMPY, path, kind, stop, step])
            theirs = json.loads(done.stdout.splitlines()[-1]) if done and done.returncode == 0 else None
            ran, shown = ran.replace("|", "/"), "–"
            if ours is None and theirs is not None:
                failed.append(f"{path} {kind}: {ran}")
            if theirs is None:
                shown = "FMPy does not run it" if done else "no end within a minute in FMPy"
            elif ours is not None:
                worst = difference(ours, theirs)
                shown = "0" if worst == 0 else f"{worst:.0e}"
                if not worst <= LIMITS[kind] or math.isnan(worst):
                    failed.append(f"{path} {kind}: {worst}")
            others = ["–"] * len(OTHERS)
            real = [
                each.name
                for each in description.modelVariables
                if each.causality == "output" and each.type in ("Real", "Float64") and each.name in (theirs or {})
            ]
            if kind == "CoSimulation" and real:
                steps = round(stop / step)
                others = [elsewhere(each, path, step, steps, real[0], theirs) for each in OTHERS]
            by = description.generationTool or ""
            name = f"{path.stem} ({by})" if "python" in by.lower() else path.stem
            row = [name, description.fmiVersion, SHOWN[kind], verdict, ran, shown, *others]
            print("| " + " | ".join(row) + " |", flush=True)
    for each in failed:
        print(f"failed: {each}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
