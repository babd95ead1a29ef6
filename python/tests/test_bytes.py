"""The package and the command line write the same bytes."""

import json
from pathlib import Path

import pytest

import toolroom as tr

NOTEBOOKS = Path(__file__).resolve().parents[1] / "notebooks"
# `run.json` holds the wall time.
UNLIKE = {"run.json"}


def same(study, folder):
    """Every file of a study is as the command line wrote it."""
    there = {path.name for path in folder.iterdir() if path.is_file()} - UNLIKE
    assert there == set(study.files) - UNLIKE
    for name in sorted(there):
        assert study.read(name) == (folder / name).read_bytes(), name


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_comparison(here, shipped, program):
    scenario = tr.scenario(shipped / "demo.toml", {"shop.seed": 7})
    words = ["compare", shipped / "demo.toml", "--set", "shop.seed=7", "--replications", 2, "--out", "cli"]
    said = json.loads(program(*words, "--json", cwd=here))
    study = scenario.compare(replications=2, threads=1)
    same(study, here / "cli")
    assert study.summary == said and study.complete


def test_a_comparison_until_a_figure_is_known(here, shipped, program):
    until = "cost_per_part half-width 90%"
    policies = ["v0 at 0.2 mm", "best cost"]
    words = ["--policy", policies[0], "--policy", policies[1], "--replications", 40, "--until", until, "--out", "cli"]
    said = json.loads(program("compare", shipped / "demo.toml", *words, "--json", cwd=here))
    study = tr.scenario(shipped / "demo.toml").compare(replications=40, policies=policies, until=until)
    same(study, here / "cli")
    assert study.summary == said and said["replications"] < 40


def test_the_tables_of_a_comparison(here, shipped):
    study = tr.scenario(shipped / "demo.toml").compare(replications=1)
    assert {"policy", "kpi", "value"} <= set(study.kpi.columns) and len(study.kpi) > 0
    for table in (study.operations, study.tools, study.jobs, study.states, study.events):
        assert len(table) > 0 and table.to_polars().height == len(table)
    assert set(study.policies) == {row["policy"] for row in study.kpi.rows()}


def test_lives(here, shipped, program):
    file = shipped / "life" / "constant.toml"
    program("life", file, "--lives", 2000, "--bootstrap", 40, "--goodness", 0, "--out", "cli", cwd=here)
    same(tr.life(file, lives=2000, bootstrap=40, goodness=0, threads=1), here / "cli")


def test_a_chart(here, shipped, program):
    file = shipped / "chatter" / "turning-bar.toml"
    program("lobes", file, "--out", "cli", cwd=here)
    same(tr.lobes(file), here / "cli")
    said = program("lobes", file, "--at", "1000 rpm", "1 mm", "--json", cwd=here)
    assert tr.verdict(file, "1000 rpm", "1 mm") == json.loads(said)


def test_trials_of_grinding(here, shipped, program):
    data = shipped / "data" / "zb153u_trials.csv"
    program("identify", data, "--out", "cli", cwd=here)
    same(tr.identify(data), here / "cli")


def test_a_point(here, program):
    said = json.loads(program("point", "turning", "--set", "cutting_speed=40 m/min", "--set", "flank_wear=0.2 mm", "--json", cwd=here))
    table = tr.turning().point(cutting_speed=[40.0], unit="m/min", flank_wear="0.2 mm")
    row = next(table.rows())
    for name, value in {**said["inputs"], **said["state"], **said["outputs"]}.items():
        if not isinstance(value, list):
            assert row[name] == value, name


def test_diagnosis_and_its_application(here, shipped, program):
    model = shipped / "gap" / "turning.toml"
    records(here, shipped, program)
    data = here / "records" / "operations.csv"
    program("gap", "diagnose", "--model", model, "--data", data, "--out", "cli", cwd=here)
    found = tr.diagnose(model, data)
    same(found, here / "cli")
    assert found.verdict == json.loads((here / "cli" / "diagnosis.json").read_text())["verdict"]
    if found.effects:
        program("gap", "apply", "--model", model, "--diagnosis", "cli/diagnosis.json", "--out", "better.toml", cwd=here)
        assert tr.apply(found, model) == (here / "better.toml").read_text()


def test_terms_that_are_proposed_and_effects_of_ones_own(here, shipped, program):
    model = shipped / "gap" / "turning.toml"
    effects = here / "mine.toml"
    effects.write_text(
        'schema = 1\n[[effect]]\nid = "my.wear"\nprocess = ["turning"]\nsize = { ordinary = 0.2, range = [0, 20] }\n'
        'changes = [{ term = "cutting_force", factor = "1 + size * (flank_wear / 0.3 mm)" }]\n'
    )
    # Noise that is not that of the model: the test rejects, no cause is known, and terms are sought.
    noisy = here / "noisy.toml"
    noisy.write_text(model.read_text() + '\n[[gap.sensor]]\nchannel = "cutting_force"\nrelative = 0.12\n')
    program("run", noisy, "--replications", 1, "--records", "records", "--out", "run", cwd=here)
    data = here / "records" / "operations.csv"
    words = ["--model", model, "--data", data, "--effects", effects, "--propose", "terms.toml", "--out", "cli"]
    program("gap", "diagnose", *words, cwd=here)
    written = here / "terms.toml"
    there = written.read_bytes() if written.exists() else None
    written.unlink(missing_ok=True)
    found = tr.diagnose(model, data, definitions=[effects], propose="terms.toml")
    same(found, here / "cli")
    assert found.verdict == "unknown", found.verdict
    assert (written.read_bytes() if written.exists() else None) == there == (found.proposed and found.proposed.encode())
    written.write_text("mine")
    with pytest.raises(tr.Error):
        tr.diagnose(model, data, propose="terms.toml")
    assert written.read_text() == "mine"

    words = ["turning", "--effects", effects, "--effect", "my.wear=0.5", "--set", "flank_wear=0.3 mm", "--json"]
    said = json.loads(program("point", *words, cwd=here))
    table = tr.turning(effects={"my.wear": 0.5}, definitions=[effects]).point(flank_wear="0.3 mm")
    assert next(table.rows())["cutting_force [N]"] == said["outputs"]["cutting_force [N]"]


def test_calibration(here, program):
    data = NOTEBOOKS / "wear.csv"
    words = ["--limit", "0.4 mm", "--draws", 200, "--law", "energy_balance", "--out", "my.toml"]
    program("calibrate", "turning", "--model", "c45_t15k6", "--data", data, *words, cwd=here)
    made = tr.calibrate("c45_t15k6", data, limit="0.4 mm", draws=200, laws=["energy_balance"])
    assert sorted(made.files) == sorted(path.name for path in here.glob("my*"))
    for name in made.files:
        assert made.read(name) == (here / name).read_bytes(), name
    assert len(made.posterior) == 200 and made.intervals and made.law == "energy_balance"
    frame = tr.Table.read(data).to_pandas()
    again = tr.calibrate("c45_t15k6", frame, limit="0.4 mm", draws=200, laws=["energy_balance"])
    assert again.set_file == made.set_file


def records(here, shipped, program):
    """Records of a small shop, as its sensors would have written them."""
    shop = shipped / "gap" / "turning.toml"
    program("run", shop, "--replications", 1, "--records", "records", "--out", "run", cwd=here)
