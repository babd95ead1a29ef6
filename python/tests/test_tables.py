"""Tables go to and come from other people's frames without loss."""

import math
import time

import numpy as np
import pytest

import toolroom as tr


@pytest.fixture(scope="module")
def table():
    return tr.turning("ni_vk6om").point(cutting_speed=np.linspace(20, 80, 61), unit="m/min")


def test_frames_of_others_take_a_table(table):
    import duckdb
    import polars
    import pyarrow

    speed = np.linspace(20, 80, 61)
    for frame in (table.to_pandas(), table.to_polars(), polars.DataFrame(table), table.to_arrow().to_pydict()):
        assert np.allclose(np.asarray(frame["cutting_speed [m/min]"]), speed, rtol=1e-14)
    own = pyarrow.table(table)
    assert own.schema.field("cutting_speed [m/min]").metadata[b"unit"] == b"m/min"
    assert own.num_rows == 61
    assert duckdb.sql('select count(*), min("tool_life [min]") > 0 from own').fetchall() == [(61, True)]


def test_a_column_shares_its_memory_with_numpy(table):
    column = table["cutting_speed"]
    numbers = np.asarray(column)
    assert numbers.dtype == np.float64 and not numbers.flags.owndata
    del column
    assert numbers[0] == pytest.approx(20) and numbers[-1] == pytest.approx(80)
    assert table.units["cutting_speed [m/min]"] == "m/min"
    with pytest.raises(KeyError, match="cutting_sped"):
        table["cutting_sped"]


def test_a_frame_comes_back_as_it_was(tmp_path):
    import pandas
    import polars

    data = {"tool_id": ["a", None, "ü,\"b\""], "flank_wear [mm]": [0.1, math.nan, 1 / 3], "n": [1, 2, 3], "ok": [True, False, True]}
    for frame in (pandas.DataFrame(data), polars.DataFrame(data), polars.DataFrame(data).to_arrow()):
        table = tr.Table.of(frame)
        assert table.columns == list(data) and len(table) == 3
        rows = list(table.rows())
        assert rows[2]["flank_wear [mm]"] == 1 / 3 and rows[2]["tool_id"] == "ü,\"b\"" and rows[1]["tool_id"] is None
        for name in ("t.csv", "t.parquet"):
            table.write(tmp_path / name)
            again = tr.Table.read(tmp_path / name)
            assert again.columns == table.columns and len(again) == 3
            assert again["flank_wear"][0] == 0.1 and again["flank_wear"][-1] == 1 / 3
    with pytest.raises(TypeError, match="no table"):
        tr.Table.of(3)


def test_many_points_in_one_call():
    speed = np.linspace(20, 80, 100_000)
    start = time.monotonic()
    table = tr.milling().point(cutting_speed=speed, unit="m/min")
    assert len(table) == 100_000
    print(f"100 000 points of milling in {time.monotonic() - start:.2f} s")
