import json

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log, read_log, write_log
from hyperleg_design.gap.logs.metadata import Metadata


def example(ticks: int = 50, **signals: np.ndarray) -> Log:
    time = np.arange(ticks) * 0.005
    return Log(
        "run", time, {"position/knee": np.sin(time), "motor_current/m": np.cos(time), **signals}
    )


NAMES = st.text("abcdefgh_/.äß 1", min_size=1, max_size=8)
VALUES = hnp.arrays(float, 7, elements=st.floats(allow_infinity=False))


@settings(max_examples=40, deadline=None)
@given(
    joints=st.dictionaries(NAMES, VALUES, max_size=4),
    motors=st.dictionaries(NAMES, VALUES, max_size=3),
    gains=st.dictionaries(NAMES, st.tuples(st.floats(0, 1e6), st.floats(0, 1e6)), max_size=3),
    extra=st.dictionaries(
        st.text("xyz", min_size=1),
        st.recursive(st.none() | st.booleans() | st.integers() | st.text(), st.lists),
        max_size=3,
    ),
    notes=st.text(),
    start=st.floats(-1e6, 1e6),
)
def test_round_trip(tmp_path_factory, joints, motors, gains, extra, notes, start):
    signals = (
        {"position/always": np.arange(7.0)}
        | {f"position/{k}": v for k, v in joints.items()}
        | {f"motor_current/{k}": v for k, v in motors.items()}
    )
    metadata = Metadata(
        gains=gains,
        extra=extra,
        notes=notes,
        payload={"hand": (1.0, 0.0, 0.1, 0.2)},
        role="reference",
    )
    log = Log("one", start + np.arange(7) * 0.01, signals, metadata)
    path = write_log(tmp_path_factory.mktemp("logs") / "one.parquet", log)
    again = read_log(path)
    assert again.metadata == log.metadata
    assert again.name == "one"
    assert list(again.signals) == list(signals)
    np.testing.assert_array_equal(again.time, log.time)
    for column, values in signals.items():
        np.testing.assert_array_equal(again.signals[column], values)


def test_same_log_gives_the_same_bytes(tmp_path):
    assert (
        write_log(tmp_path / "a.parquet", example()).read_bytes()
        == write_log(tmp_path / "b.parquet", example()).read_bytes()
    )


def test_stack_gives_nan_where_a_column_is_missing():
    log = example()
    found = log.stack("position", ["knee", "hip"])
    np.testing.assert_array_equal(found[:, 0], log.signals["position/knee"])
    assert np.isnan(found[:, 1]).all()
    assert log.stack("position", []).shape == (50, 0)
    assert log.has("position", "knee")
    assert not log.has("position", "hip")
    assert not example(**{"velocity/knee": np.full(50, np.nan)}).has("velocity", "knee")
    assert log.joints == ("knee",)
    assert log.motors == ("m",)


def test_vectors_feet_and_battery():
    ones = np.ones(50)
    signals = {
        "gyro/z": 3 * ones,
        "battery_voltage": 7.4 * ones,
        "contact_force/left_foot_x": ones,
        "contact_force/left_foot_z": ones,
    }
    log = example(**signals)
    assert np.isnan(log.vector("gyro")[:, :2]).all()
    assert (log.vector("gyro")[:, 2] == 3).all()
    assert log.vector("base_orientation").shape == (50, 4)
    assert log.has("battery_voltage")
    assert log.feet == ("left_foot",)


def test_arrays_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        example().signals["position/knee"][0] = 1


@pytest.mark.parametrize(
    ("time", "message"),
    [
        ([0, 1, 2, 1.5], "row 3 after 2 s'.*runs backwards"),
        ([0, 1, 1, 2], "repeats"),
        ([0, np.nan, 1, 2], "no number in row 1"),
        ([], "empty"),
        ([1], "empty"),
    ],
)
def test_bad_clock(time, message):
    with pytest.raises(InputError, match=message) as error:
        Log("run.parquet", np.array(time), {"position/knee": np.zeros(len(time))})
    assert str(error.value).startswith("run.parquet: t")


def test_columns_of_other_lengths_and_infinities():
    with pytest.raises(InputError, match="one value a tick"):
        example(**{"velocity/knee": np.ones(3)})
    with pytest.raises(InputError, match="finite"):
        example(**{"velocity/knee": np.full(50, np.inf)})
    with pytest.raises(InputError, match="expects numbers"):
        example(**{"velocity/knee": ["a"] * 50})


def write_table(path, **columns):
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    return path


def test_side_file_wins_field_by_field(tmp_path):
    log = example().changed(metadata=Metadata(robot="inside", session="a", extra={"kept": 1}))
    path = write_log(tmp_path / "run.parquet", log)
    (tmp_path / "run.json").write_text(json.dumps({"robot": "beside", "operator": "me"}))
    found = read_log(path).metadata
    assert (found.robot, found.session, found.extra) == (
        "beside",
        "a",
        {"kept": 1, "operator": "me"},
    )
    (tmp_path / "run.json").write_text("{")
    with pytest.raises(InputError, match=r"run.json: is not JSON"):
        read_log(path)


def test_missing_empty_and_truncated_files(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        read_log(tmp_path / "none.parquet")
    (tmp_path / "empty.parquet").write_bytes(b"")
    with pytest.raises(InputError, match=r"empty.parquet: is no whole Parquet file"):
        read_log(tmp_path / "empty.parquet")
    whole = write_log(tmp_path / "run.parquet", example(5000)).read_bytes()
    for share in (0.05, 0.5, 0.99):
        (tmp_path / "cut.parquet").write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(InputError, match="no whole Parquet file"):
            read_log(tmp_path / "cut.parquet")
    damaged = bytearray(whole)
    damaged[400:3000] = bytes(2600)
    (tmp_path / "cut.parquet").write_bytes(bytes(damaged))
    with pytest.raises(InputError, match="no whole Parquet file"):
        read_log(tmp_path / "cut.parquet")
    with pytest.raises(InputError, match="has no rows"):
        read_log(write_table(tmp_path / "rows.parquet", t=pyarrow.array([], pyarrow.float64())))


def test_wrong_columns(tmp_path):
    with pytest.raises(InputError, match=r"run.parquet: t.*is missing"):
        read_log(write_table(tmp_path / "run.parquet", time=[0.0, 1.0]))
    with pytest.raises(InputError, match=r"position/\.\.\.: is missing: expects"):
        read_log(write_table(tmp_path / "run.parquet", t=[0.0, 1.0]))
    empty = {"t": [0.0, 1.0], "position/knee": [float("nan")] * 2}
    with pytest.raises(InputError, match="no number in position/knee: expects the measured"):
        read_log(write_table(tmp_path / "run.parquet", **empty))
    with pytest.raises(InputError, match=r"position/knee = 'string': is no column of numbers"):
        read_log(
            write_table(
                tmp_path / "run.parquet", **{"t": [0.0, 1.0], "position/knee": ["1.0", "2.0"]}
            )
        )
    found = read_log(
        write_table(
            tmp_path / "run.parquet",
            **{
                "t": [0, 1],
                "position/knee": pyarrow.array([1, None], pyarrow.int32()),
                "comment": ["a", "b"],
            },
        )
    )
    np.testing.assert_array_equal(found.signals["position/knee"], [1, np.nan])
    assert any("comment" in remark for remark in found.metadata.remarks)


def test_clock_of_a_file(tmp_path):
    with pytest.raises(InputError, match=r"run.parquet: t = '1 s in row 3"):
        read_log(
            write_table(
                tmp_path / "run.parquet", **{"t": [0.0, 1.0, 2.0, 1.0], "position/knee": [0.0] * 4}
            )
        )
    found = read_log(
        write_table(
            tmp_path / "run.parquet",
            **{"t": [0.0, 1.0, 1.0, 2.0], "position/knee": [0.0, None, 5.0, 2.0]},
        )
    )
    np.testing.assert_array_equal(found.signals["position/knee"], [0, 5, 2])
    assert any("repeat" in remark for remark in found.metadata.remarks)
    with pytest.raises(InputError, match="stands still"):
        read_log(
            write_table(
                tmp_path / "run.parquet",
                **{"t": [0.0, 0.0, 0.0, 0.0, 1.0], "position/knee": [0.0] * 5},
            )
        )
