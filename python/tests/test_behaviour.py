"""Errors, Ctrl-C, threads, changes of scenarios."""

import _thread
import os
import pickle
import signal
import sys
import threading
import time
import zipfile

import pytest

import toolroom as tr


def test_an_error_says_where_and_what_to_do(tmp_path, shipped):
    bad = tmp_path / "bad.toml"
    bad.write_text((shipped / "demo.toml").read_text().replace("[shop]", "[shop]\nnmae = 3", 1))
    with pytest.raises(tr.Error) as caught:
        tr.scenario(bad)
    error = caught.value
    assert error.code == "unknown-key" and error.file == str(bad) and error.line > 1 and error.help
    assert error.problems[0]["line"] == error.line
    again = pickle.loads(pickle.dumps(error))
    assert (again.code, again.line, str(again)) == (error.code, error.line, str(error))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: tr.turning().point(cutting_speed=[30.0]), "m/min"),
        (lambda: tr.turning().point(cutting_speed=[30.0, -1.0], unit="m/min"), "point 1"),
        (lambda: tr.turning().point(cuting_speed=[30.0], unit="m/min"), "cutting_speed"),
        (lambda: tr.turning("none").point(), "none"),
        (lambda: tr.diagnose("none.toml", "none.csv"), "none.toml"),
        (lambda: tr.export_fmu("drilling"), "turning"),
        (lambda: tr.calibrate("ni_vk6om", "none.csv"), "none.csv"),
        (lambda: tr.identify("none.csv"), "none.csv"),
        (lambda: tr.life("none.toml"), "none.toml"),
    ],
)
def test_bad_input_is_refused_with_its_name(call, words):
    with pytest.raises(tr.Error, match=words):
        call()


def test_a_scenario_is_changed_by_key(shipped):
    scenario = tr.scenario(shipped / "demo.toml")
    scenario["shop.seed"] = 9
    assert scenario.seed == 9 and scenario["shop.seed"] == 9
    assert scenario.changed({"shop.seed": 10}).seed == 10 and scenario.seed == 9
    with pytest.raises(tr.Error):
        scenario["shop.sede"] = 9
    assert list(scenario.changes) == ["shop.seed"]
    assert scenario.values["shop.seed"] == "9"
    with pytest.raises(tr.Error, match="no policy"):
        scenario.compare(1, policies=["none"])


@pytest.fixture
def heard():
    """Ctrl-C is heard, also where the tests run in the background and were started to ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heard")
def test_ctrl_c_ends_a_comparison_and_others_go_on(shipped):
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.01)

    other = threading.Thread(target=tick)
    other.start()
    threading.Timer(1.0, _thread.interrupt_main).start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        tr.scenario(shipped / "demo.toml").compare(replications=100_000)
    took = time.monotonic() - start
    stop.set()
    other.join()
    assert len(ticks) > 10, "the interpreter was free"
    assert 0.5 < took < 20, took


def test_progress_and_threads(shipped):
    seen = []
    scenario = tr.scenario(shipped / "demo.toml")
    one = scenario.compare(replications=2, threads=1, logged=0, progress=lambda done, total: seen.append((done, total)))
    assert one.read("kpi.csv") == scenario.compare(replications=2, threads=2, logged=0).read("kpi.csv")
    assert not seen or seen[-1][1] >= seen[-1][0] > 0

    def fails(done, total):
        raise ValueError("mine")

    with pytest.raises(ValueError, match="mine"):
        scenario.compare(replications=2000, progress=fails)


def test_a_sweep_is_a_table(shipped):
    sweep = tr.sweep(shipped / "demo.toml", {"shop.seed": [1, 2]}, replications=2)
    policies = len(tr.scenario(shipped / "demo.toml").policies)
    assert len(sweep.table) == 2 * policies
    row = next(sweep.table.rows())
    assert row["shop.seed"] == 1 and row["parts_per_shift low"] <= row["parts_per_shift"] <= row["parts_per_shift high"]


def test_a_bare_number_stands_in_the_unit_of_the_file(tmp_path, shipped):
    price, change = "tool.insert.edge_cost", "machine.L.tool_change_time"
    text = (shipped / "demo.toml").read_text()
    assert f'{change.rsplit(".")[-1]} = "2 min"' in text
    path = tmp_path / "own.toml"
    path.write_text(text.replace('"2 min"', '"120 s"'))
    scenario = tr.scenario(path)
    scenario[price] = 9
    # Times read back in the unit that suits their length; what counts is how the file writes them.
    assert scenario[change] == "2 min"
    scenario[change] = 90
    assert scenario.changes == {price: "9 EUR", change: "90 s"}
    words = tr.scenario(path, {price: "9 EUR"}).compare(replications=1)
    row = next(tr.sweep(path, {price: [9]}, replications=1).table.rows())
    assert row[price] == 9 and row["cost_per_part"] == words.policies[row["policy"]]["cost_per_part"]["mean"]
    with pytest.raises(tr.Error, match="unit"):
        tr.scenario(path, {"machine.M.coolant_change": 90})


def test_a_sweep_is_drawn_with_its_intervals(shipped, monkeypatch):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    seeds, prices = [1, 2], ["6 EUR", "9 EUR"]
    sweep = tr.sweep(shipped / "template.toml", {"shop.seed": seeds, "tool.insert.edge_cost": prices}, replications=2)
    axes = sweep.plot().axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    policies = list(sweep.comparisons[0].policies)
    # One line a policy and price: a line through both prices would go back and forth.
    assert labels == [f"{policy}, tool.insert.edge_cost = {price}" for price in prices for policy in policies]
    drawn = axes.containers[0].lines[0]
    mean = sweep.comparisons[0].policies[policies[0]]["cost_per_part"]["mean"]
    assert list(drawn.get_xdata()) == seeds and drawn.get_ydata()[0] == mean
    assert not pyplot.get_fignums(), "an open figure is shown twice in a notebook"
    with pytest.raises(tr.Error, match="no key figure"):
        sweep.plot("cost")
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(tr.Error, match="pip install matplotlib"):
        sweep.plot()


def test_reports_are_written_once(tmp_path, shipped):
    study = tr.lobes(shipped / "chatter" / "turning-bar.toml")
    path = study.report(tmp_path / "r.html")
    assert path.read_text().startswith("<!") and "<svg" in study.plot()._repr_html_().replace("&lt;", "<")
    with pytest.raises(tr.Error, match="there already"):
        study.report(path)
    study.write(tmp_path / "all")
    assert sorted(own.name for own in (tmp_path / "all").iterdir()) == sorted(study.files)


def test_a_unit_is_exported(tmp_path):
    """With a library of units at hand: that inside the package, or `TOOLROOM_UNITS`."""
    library = os.environ.get("TOOLROOM_UNITS")
    try:
        made = tr.export_fmu("turning", tmp_path, fmi=[3], library=library)
    except tr.Error as error:
        if library is None and "embedded-units" in str(error):
            pytest.skip("built without its library of units")
        raise
    assert len(made) == 1
    for path in made:
        with zipfile.ZipFile(path) as unit:
            names = unit.namelist()
        assert "modelDescription.xml" in names and any(name.startswith("binaries/") for name in names)
