"""Every CSV file that toolroom writes reads back in pandas, polars and duckdb.

    python tests/csv_read_back.py path/to/toolroom

Runs the verbs to get one file of every kind, names with commas and quotes among them, and compares header
and values with those of Python's csv module. Numbers have to be the same to the last bit. Exit code 1 where
a file differs, or holds a signed zero or a number that is none.
"""

import csv
import math
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import duckdb
import pandas
import polars

ROOT = Path(__file__).resolve().parent.parent
SCENARIOS = ROOT / "scenarios"
# A name with everything that has to be quoted.
ODD = "v0, at \"0.2\" mm"

PROGRAM = """%
O1(PART)
T1 M6
G21 G90 G54 G0 X0 Y0 Z5. S3000 M3
G1 Z-1. F300.
X60. F600.
G0 Z50.
T2 M6
G0 X10. Y10. Z5.
G98 G81 Z-5. R2. F60.
G80
G4 P500
M30
%
"""

LOG = """2024-05-02T08:00:00Z|avail|AVAILABLE|execution|READY|program|O1|Fovr|100|tool|1|line|0
2024-05-02T08:00:10Z|execution|ACTIVE|line|3
2024-05-02T08:00:14Z|line|4
2024-05-02T08:00:15Z|line|6
2024-05-02T08:00:28Z|line|7
2024-05-02T08:00:30Z|tool|2
2024-05-02T08:00:33Z|line|9
2024-05-02T08:00:41Z|line|11
2024-05-02T08:00:50Z|line|13
2024-05-02T08:00:51Z|execution|PROGRAM_COMPLETED|PartCountAct|1
2024-05-02T08:00:52Z|execution|READY
"""


def run(toolroom, *arguments):
    """Runs a verb; what it said, if it failed."""
    said = subprocess.run([toolroom, *map(str, arguments), "--quiet"], capture_output=True, text=True, check=False)
    if said.returncode != 0:
        sys.exit(f"toolroom {' '.join(map(str, arguments))}: exit code {said.returncode}\n{said.stderr}")


def renamed(scratch, scenario, name):
    """A shipped file with a name in it exchanged for an odd one."""
    text = (SCENARIOS / scenario).read_text()
    assert f'name = "{name}"' in text, f"{scenario} has no {name}"
    path = scratch / Path(scenario).name
    path.write_text(text.replace(f'name = "{name}"', f"name = '{ODD}'", 1))
    return path


def three_edges():
    """Forces of three edges that follow feed and wear, with a little scatter."""
    head = "operation_id,tool_id,sequence,feed_per_rev [mm],depth_of_cut [mm],cutting_time [min],flank_wear [mm],"
    text = head + "cutting_force [N]\n"
    for edge in range(3):
        for run in range(1, 13):
            feed, land = (0.1, 0.2, 0.3)[(5 * run + edge) % 3], 0.02 * run
            force = 2000 * feed**0.75 * math.exp(0.01 * math.sin(37 * run + 91 * edge) + 0.03 * edge)
            text += f"{edge}-{run},T{edge},{run},{feed},1,1,{land:.4f},{force:.3f}\n"
    return text


def write_all(toolroom, scratch):
    """One file of every kind into folders of `scratch`."""
    demo = renamed(scratch, "demo.toml", "v0 at 0.2 mm")
    few = ["--policy", ODD, "--policy", "productivity", "--replications", "2", "--logged", "2"]
    run(toolroom, "run", demo, *few, "--format", "csv", "--records", scratch / "records", "--out", scratch / "run")
    grinding = ["--replications", "1", "--records", scratch / "ground", "--out", scratch / "grinding"]
    run(toolroom, "run", SCENARIOS / "gap/grinding.toml", *grinding)
    model, edges = scratch / "model.toml", scratch / "edges.txt"
    model.write_text('schema = 1\n[gap]\nprocess = "empirical"\n')
    edges.write_text(three_edges())
    run(toolroom, "gap", "plan", "--model", model, "--data", edges, "--out", scratch / "plan")
    # The two processes that are diagnosed fastest fill every column with what all five do: numbers, names, quoted notes, nothing.
    for process in ["grinding", "program"]:
        run(toolroom, "gap", "blind", "--cases", "smoke", "--process", process, "--out", scratch / f"blind-{process}")

    study = renamed(scratch, "life/policies.toml", "best constant")
    run(toolroom, "life", study, "--lives", "300", "--bootstrap", "20", "--out", scratch / "life")

    small = ["--set", "chart.columns=6", "--set", "chart.rows=5"]
    for number, chart in enumerate(["chatter/milling-slot", "chatter/turning-bar", "chuck-fig3"]):
        path = SCENARIOS / f"{chart}.toml"
        run(toolroom, "lobes", path, *small, "--out", scratch / f"lobes-{number}")
        run(toolroom, "lobes", path, "--set", "chart.boundary_only=true", *small, "--out", scratch / f"curve-{number}")

    run(toolroom, "grind", SCENARIOS / "grinding/cycle.toml", "--out", scratch / "grind")
    run(toolroom, "identify", SCENARIOS / "data/zb153u_trials.csv", "--out", scratch / "identify")
    contour = renamed(scratch, "contour/rk3.toml", "rough")
    run(toolroom, "contour", contour, "--draws", "3", "--out", scratch / "contour")

    program, log = scratch / "part.nc", scratch / "mill.shdr"
    program.write_text(PROGRAM)
    log.write_text(LOG)
    (scratch / "blocks").mkdir()
    run(toolroom, "program", program, "--blocks", scratch / "blocks/blocks.csv")
    run(toolroom, "import", "mtconnect", log, "--nc", program, "--stretch", "10 s", "--out", scratch / "mtconnect")

    table, mapping = scratch / "log.txt", scratch / "map.toml"
    mapping.write_text(
        'schema = 1\nprocess = "empirical"\n'
        'column = [{ name = "tool_id", from = "tool" }, { name = "cutting_force", from = "Fc", unit = "kN" }]\n'
    )
    table.write_text("tool;Fc\n\"T, \"\"new\"\"\";0,5\nB2;-0,0\nB;n/a\n")
    run(toolroom, "import", "csv", table, "--map", mapping, "--out", scratch / "import")
    nasa = scratch / "mill.txt"
    nasa.write_text("case,run,VB,time,DOC,feed,material\n1,1,0.1,2,1.5,0.5,1\n1,2,,4,1.5,0.5,1\n2,1,0.3,3,0.75,0.25,2\n")
    run(toolroom, "import", "nasa-mill", nasa, "--out", scratch / "nasa")
    runs = scratch / "runs.txt"
    runs.write_text(
        "machine,day,hour,prog,mode,act,nom,hold,tc,nhold\n\"M1, left\",2017-05-02,9,103,AUTOMATIC,40,20,0,1,0\n"
        "\"M1, left\",2017-05-03,9,103,AUTOMATIC,41,41,0,1,0\n"
    )
    run(toolroom, "import", "nist-runs", runs, "--out", scratch / "nist")

    fmu_files(toolroom, scratch / "fmu")


def fmu_files(toolroom, folder):
    """The reference results within a unit and what a run of it leaves; both ask for more than the program."""
    if not attempted(toolroom, "fmu", "export", "turning", "--fmi", "3", "--out", folder):
        return
    unit = next(folder.glob("*.fmu"))
    with zipfile.ZipFile(unit) as archive:
        for name in archive.namelist():
            if name.endswith(".csv"):
                (folder / Path(name).name).write_bytes(archive.read(name))
    if not attempted(toolroom, "fmu", "sim", unit, "--stop", "2 s", "--step", "0.5 s", "--output", folder / "sim.csv"):
        (folder / "sim.csv").unlink(missing_ok=True)


def attempted(toolroom, *arguments):
    """Runs a verb that the program may lack; why not, if it does."""
    said = subprocess.run([toolroom, *map(str, arguments)], capture_output=True, text=True, check=False)
    if said.returncode != 0:
        print(f"left out: toolroom {' '.join(map(str, arguments[:2]))} ({said.stderr.strip().splitlines()[0]})")
    return said.returncode == 0


def cells_of(path):
    """Header and rows as text, by the strict reader of Python."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file, strict=True)
    return header, rows


def with_pandas(path):
    # The words null and NA are names to us; pandas takes them for nothing unless told.
    table = pandas.read_csv(path, keep_default_na=False, na_values=[""])
    return list(table.columns), [list(row) for row in table.itertuples(index=False, name=None)]


def with_polars(path):
    table = polars.read_csv(path, infer_schema_length=None)
    return table.columns, [list(row) for row in table.rows()]


def with_duckdb(path):
    relation = duckdb.connect().execute("SELECT * FROM read_csv(?, header = true, sample_size = -1)", [str(path)])
    header = [column[0] for column in relation.description]
    return header, [list(row) for row in relation.fetchall()]


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return None


def same(cell, value):
    """Whether a library has for a cell what stands in it."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return cell == ""
    if isinstance(value, bool) or type(value).__name__ == "bool_":
        return cell == str(bool(value)).lower()
    own = number(cell)
    if own is not None and not isinstance(value, str):
        return float(value) == own
    return str(value) == cell


def faults(path):
    header, rows = cells_of(path)
    if not rows:
        yield "no rows"
    for line, row in enumerate(rows, 2):
        if len(row) != len(header):
            yield f"row {line}: {len(row)} cells where the header has {len(header)}"
        for name, cell in zip(header, row):
            own = number(cell)
            if own is not None and (not math.isfinite(own) or (own == 0 and cell.startswith("-"))):
                yield f"row {line}, {name}: {cell}"
    for library in [with_pandas, with_polars, with_duckdb]:
        word = library.__name__.removeprefix("with_")
        read_header, read = library(path)
        if list(read_header) != header:
            yield f"{word} has the header {list(read_header)}, the file {header}"
            continue
        if len(read) != len(rows):
            yield f"{word} has {len(read)} rows, the file {len(rows)}"
            continue
        for line, (row, values) in enumerate(zip(rows, read), 2):
            for name, cell, value in zip(header, row, values):
                if not same(cell, value):
                    yield f"{word}, row {line}, {name}: {value!r} where the file has {cell!r}"


KINDS = """run/kpi run/operations run/tools run/jobs run/states run/events records/operations records/cuts
    records/events ground/trials plan/runs blind-grinding/cases blind-program/cases life/cells lobes-0/lobes lobes-1/lobes lobes-2/lobes
    curve-0/lobes curve-1/lobes curve-2/lobes grind/cycle grind/dressing identify/trials contour/sections
    contour/conditions contour/draws blocks/blocks mtconnect/events mtconnect/runs mtconnect/stretches
    import/operations nasa/operations nist/stretches""".split()


def main():
    toolroom = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        write_all(toolroom, scratch)
        found = sorted(path for path in scratch.rglob("*.csv"))
        missing = [kind for kind in KINDS if scratch / f"{kind}.csv" not in found]
        wrong = [f"{kind}.csv was not written" for kind in missing]
        for path in found:
            some = [f"{path.relative_to(scratch)}: {fault}" for _, fault in zip(range(3), faults(path))]
            wrong.extend(some)
        odd = [path for path in found if ODD in path.read_text(encoding="utf-8").replace('""', '"')]
        if len(odd) < 5:
            wrong.append(f"only {len(odd)} files hold the odd name")
    for fault in wrong:
        print(fault)
    print(f"{len(found)} files read by pandas, polars and duckdb, {len(wrong)} faults")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
