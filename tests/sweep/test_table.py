import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.sweep import table
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import evaluate_range
from hyperleg_design.sweep.space import sweep_from_mapping

SWEEP = sweep_from_mapping(
    {
        "design": "hyperleg",
        "axes": {
            "toe.mass": {"values": [0.1, 0.2, 0.3]},
            "actuators.toe.motor": {"values": ["RI50", "RI60"]},
        },
    }
)


@pytest.fixture
def parts(tmp_path):
    paths = []
    for start, stop in ((0, 2), (2, 5), (5, 6)):
        paths.append(tmp_path / f"{start}.parquet")
        paths[-1].write_bytes(table.to_bytes(SWEEP, evaluate_range(SWEEP, start, stop)))
    return paths


def test_joined_parts_are_the_whole(tmp_path, parts, monkeypatch):
    monkeypatch.setattr(table, "ROW_GROUP", 4)
    path = tmp_path / "all.parquet"
    table.join(SWEEP, parts, path, {"seed": 1})
    whole = evaluate_range(SWEEP, 0, 6)
    found = table.read(path)
    assert list(found) == list(whole)
    for name, values in whole.items():
        np.testing.assert_array_equal(found[name], values)
    assert table.rows_of(path) == 6
    assert list(table.read(path, ["variant", "leg_mass"])) == ["variant", "leg_mass"]


def test_columns_carry_units_and_other_tools_read_them(tmp_path, parts):
    import pandas as pd
    import pyarrow.parquet as pq

    path = tmp_path / "all.parquet"
    table.join(SWEEP, parts, path, {"seed": 1})
    schema = pq.read_schema(path)
    assert json.loads(schema.metadata[b"hyperleg_sweep"]) == {"seed": 1}
    for column in measures.columns(SWEEP.measures):
        assert schema.field(column).metadata[b"unit"].decode() == measures.measure_of(column).unit
    assert schema.field("toe.mass").metadata[b"unit"] == b"kg"
    frame = pd.read_parquet(path)
    assert frame["total_mass"].iloc[0] == pytest.approx(
        32.0 - 2 * 0.12 + 2 * (frame["leg_mass"].iloc[0] - 8.15)
    )


def test_what_is_no_table_is_refused(tmp_path, parts):
    broken = tmp_path / "broken.parquet"
    broken.write_bytes(b"PAR1")
    for path in (broken, tmp_path / "missing.parquet"):
        assert table.rows_of(path) == -1
        with pytest.raises(InputError, match=path.name):
            table.read(path)
        with pytest.raises(InputError, match=path.name):
            table.read_metadata(path)
    with pytest.raises(InputError, match="not the table of a sweep"):
        table.read_metadata(parts[0])
