import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs.readers import open_log


def write(path, text):
    path.write_text(text)
    return path


def test_our_names_with_units(tmp_path):
    path = write(
        tmp_path / "run.csv",
        "t [ms],position/knee [deg],motor_current/m "
        "[mA],comment\n0,90,1500,a\n5,180,,b\n10,0,500,c\n",
    )
    (log,) = open_log(path)
    np.testing.assert_allclose(log.time, [0, 0.005, 0.01])
    np.testing.assert_allclose(log.signals["position/knee"], [np.pi / 2, np.pi, 0])
    np.testing.assert_allclose(log.signals["motor_current/m"], [1.5, np.nan, 0.5])
    assert any("comment" in remark for remark in log.metadata.remarks)


def test_units_of_the_side_file_hold_where_the_header_has_none(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(
        "t,position/knee,position_target/knee,motor_current/knee [A]\n0,90,45,1\n10,180,45,2\n"
    )
    units = {"t": "ms", "position": "deg", "position_target/knee": "deg", "motor_current": "mA"}
    (tmp_path / "run.json").write_text(json.dumps({"units": units}))
    (log,) = open_log(path)
    np.testing.assert_allclose(log.time, [0, 0.01])
    np.testing.assert_allclose(log.column("position/knee"), np.radians([90, 180]))
    np.testing.assert_allclose(log.column("position_target/knee"), np.radians([45, 45]))
    np.testing.assert_allclose(log.column("motor_current/knee"), [1, 2])


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ({"position": "furlong"}, "is no unit of this signal"),
        ({"velocity": "deg/s"}, "units.velocity.*is in no column of the file"),
        ({"position": 5}, "units.*expects texts by name"),
        (["deg"], "units.*expects texts by name"),
    ],
)
def test_bad_units_of_the_side_file(tmp_path, stated, message):
    path = tmp_path / "run.csv"
    path.write_text("t,position/knee\n0,1\n0.01,2\n")
    (tmp_path / "run.json").write_text(json.dumps({"units": stated}))
    with pytest.raises(InputError, match=message):
        open_log(path)


@pytest.mark.parametrize("way", ["argument", "side file"])
def test_mapping_of_other_names(tmp_path, way):
    path = write(tmp_path / "run.csv", "stamp;q1 (deg);u1\n0,0;90,0;1,5\n0,01;180,0;1,6\n")
    mapping = {"stamp": "t", "q1": "position/knee", "u1": "position_target/knee [rad]"}
    if way == "side file":
        (tmp_path / "run.json").write_text(
            json.dumps({"columns": mapping, "gains": {"knee": [20, 1]}})
        )
        (log,) = open_log(path)
        assert log.metadata.gains == {"knee": (20, 1)}
    else:
        (log,) = open_log(path, mapping=mapping)
    np.testing.assert_allclose(log.signals["position/knee"], [np.pi / 2, np.pi])
    np.testing.assert_allclose(log.signals["position_target/knee"], [1.5, 1.6])


@pytest.mark.parametrize(
    ("text", "mapping", "message"),
    [
        ("", {}, "empty"),
        ("t,position/knee\n", {}, "no rows"),
        ("t,position/knee\n1,2", {}, "two rows"),
        ("q,position/knee\n0,1\n1,2\n", {}, "run.csv: t .*missing"),
        ("t,velocity/knee\n0,1\n1,2\n", {}, "position/.*missing"),
        ("t,position/knee\n0,1\n1,left\n", {}, "position/knee, row 3 = 'left'"),
        ("t,position/knee [Nm]\n0,1\n1,2\n", {}, "Nm.*no unit of this signal"),
        ("t,position/knee\n0,1\n1,2\n", {"q1": "position/hip"}, "q1.*no column of the file"),
        ("t,q1\n0,1\n1,2\n", {"q1": "angle/knee"}, "q1 = 'angle/knee'.*log format"),
        ("t,position/knee,position/knee\n0,1,1\n1,2,2\n", {}, "stands twice"),
        ("t,position/knee\n0,1\n2,2\n1,3\n", {}, "runs backwards"),
    ],
)
def test_bad_files(tmp_path, text, mapping, message):
    with pytest.raises(InputError, match=message):
        open_log(write(tmp_path / "run.csv", text), mapping=mapping)


def test_clock_that_counts_from_the_epoch(tmp_path):
    (log,) = open_log(
        write(tmp_path / "run.csv", "timestamp,position/knee\n1700000000.0,1\n1700000000.5,2\n")
    )
    np.testing.assert_allclose(log.time, [0, 0.5])
    assert log.metadata.extra["start_time"] == 1700000000.0


def test_long_tables_are_read_in_blocks(tmp_path, monkeypatch):
    monkeypatch.setattr(blocks, "BLOCK_ROWS", 100)
    monkeypatch.setattr(blocks, "MAX_VALUES", 2 * 1000)
    rows = "".join(f"{i * 0.01:.2f},{i}\n" for i in range(5050))
    (log,) = open_log(write(tmp_path / "run.csv", "t,position/knee\n" + rows))
    assert len(log.time) == 1000
    np.testing.assert_allclose(log.signals["position/knee"], log.time * 100, atol=1e-9)
    assert any("1000 of its 5050 rows" in remark for remark in log.metadata.remarks)
