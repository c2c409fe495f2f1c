from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.parquet_columns import parquet_columns


def read(folder: Path, table: pa.Table, **options):
    path = folder / "log.parquet"
    pq.write_table(table, path, **options)
    return parquet_columns(pq.ParquetFile(path), path)


def columns(**values):
    return pa.table({"t": np.arange(5.0), **values})


def test_whole_numbers_flags_and_gaps_become_floats(tmp_path):
    table = columns(
        **{
            "position/knee": pa.array([1, 2, None, 4, 5], pa.int32()),
            "velocity/knee": pa.array([True, False, True, None, True]),
            "motor_torque/knee": pa.nulls(5),
        }
    )
    time, values, remarks = read(tmp_path, table, row_group_size=2)
    np.testing.assert_array_equal(time, np.arange(5.0))
    np.testing.assert_array_equal(values["position/knee"], [1, 2, np.nan, 4, 5])
    np.testing.assert_array_equal(values["velocity/knee"], [1, 0, 1, np.nan, 1])
    assert np.isnan(values["motor_torque/knee"]).all()
    assert all(v.dtype == float for v in values.values())
    assert remarks == []


def test_columns_that_nobody_knows_are_left_out_and_named(tmp_path):
    _, values, (remark,) = read(tmp_path, columns(mood=["a"] * 5, __index=np.arange(5)))
    assert values == {}
    assert "mood" in remark
    assert "__index" not in remark


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (pa.table({"time": [0.0, 1.0]}), "t.*is missing"),
        (pa.table({"t": ["0", "1"]}), "is no column of numbers"),
        (columns(**{"position/knee": ["a"] * 5}), "position/knee.*is no column of numbers"),
        (columns().slice(0, 0), "no rows"),
        (columns(**{"positon/knee": [0.0] * 5}), "positon/knee.*did you mean position/knee"),
        (
            pa.Table.from_arrays(
                [pa.array([0.0]), pa.array([1.0]), pa.array([2.0])],
                names=["t", "position/knee", "position/knee"],
            ),
            "stands twice",
        ),
    ],
)
def test_what_is_no_log_says_why(tmp_path, table, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, table)
