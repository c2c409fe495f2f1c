import json

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log

NAMES = ["shoulder_pan.pos", "gripper.pos"]


def write(folder, robot="so101_follower", version="v2.1", names=NAMES, scale=30.0, action=True):
    features = {
        "observation.state": {"dtype": "float32", "shape": [2], "names": names},
        "timestamp": {"dtype": "float32", "shape": [1]},
    }
    if action:
        features["action"] = features["observation.state"]
    (folder / "meta").mkdir(parents=True)
    (folder / "meta" / "info.json").write_text(
        json.dumps(
            {"codebase_version": version, "robot_type": robot, "fps": 30, "features": features}
        )
    )
    tables = []
    for episode in range(3):
        time = np.arange(40, dtype="f4") / 30
        state = np.stack(
            [
                scale * np.sin(time + episode),
                scale + 20 + 0 * time if scale > 1 else 0.5 + 0 * time,
            ],
            -1,
        ).astype("f4")
        columns = {
            "observation.state": list(state),
            "timestamp": time,
            "episode_index": np.full(40, episode),
            "frame_index": np.arange(40),
        }
        tables.append(pyarrow.table(columns | ({"action": list(state + 1)} if action else {})))
    chunk = folder / "data" / "chunk-000"
    chunk.mkdir(parents=True)
    if version == "v3.0":
        pyarrow.parquet.write_table(pyarrow.concat_tables(tables), chunk / "file-000.parquet")
    else:
        for episode, table in enumerate(tables):
            pyarrow.parquet.write_table(table, chunk / f"episode_{episode:06d}.parquet")
    return folder


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
def test_episodes_in_degrees(tmp_path, version):
    found = open_log(write(tmp_path / "set", version=version))
    assert [log.name for log in found] == ["set_000000", "set_000001", "set_000002"]
    log = found[1]
    assert log.joints == ("shoulder_pan", "gripper")
    np.testing.assert_allclose(
        log.signals["position/shoulder_pan"], np.radians(30 * np.sin(log.time + 1)), atol=1e-5
    )
    np.testing.assert_allclose(
        log.signals["position_target/shoulder_pan"] - log.signals["position/shoulder_pan"],
        np.radians(1),
        atol=1e-5,
    )
    np.testing.assert_allclose(log.signals["position/gripper"], 0.5)
    text = " ".join(log.metadata.remarks)
    assert "degrees" in text
    assert "not measured" in text
    assert log.metadata.extra["robot_type"] == "so101_follower"


@pytest.mark.parametrize(("names", "read"), [("wxyz", True), ("xyzw", False)])
def test_the_base_is_read_where_its_columns_are_named_in_the_usual_order(tmp_path, names, read):
    folder = write(tmp_path / "set", robot="dog", scale=1.0, version="v3.0")
    info = json.loads((folder / "meta" / "info.json").read_text())
    shape = {"dtype": "float32", "shape": [4], "names": list(names)}
    info["features"]["observation.base_orientation"] = shape
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    path = folder / "data" / "chunk-000" / "file-000.parquet"
    rows = pyarrow.parquet.read_table(path)
    level = pyarrow.array([[1.0, 0.0, 0.0, 0.0]] * len(rows))
    table = rows.append_column("observation.base_orientation", level)
    pyarrow.parquet.write_table(table, path)
    (log, *_) = open_log(folder)
    assert ("base_orientation/w" in log.signals) == read
    if read:
        assert set(log.column("base_orientation/w")) == {1.0}
        assert set(log.column("base_orientation/z")) == {0.0}


def test_unknown_units_are_asked_for(tmp_path):
    folder = write(tmp_path / "set", robot="arm")
    with pytest.raises(InputError, match=r"units.position = 50.*no angle in rad"):
        open_log(folder)
    (folder / "hyperleg.json").write_text(json.dumps({"units": {"position": "deg"}}))
    assert np.abs(open_log(folder)[0].signals["position/shoulder_pan"]).max() < 1
    with pytest.raises(InputError, match="expects one of rad, deg"):
        open_log(folder, metadata={"units": {"position": "miles"}})


def test_without_actions_and_names(tmp_path):
    log = open_log(write(tmp_path / "set", robot=None, scale=1.0, action=False, names=None))[0]
    assert log.joints == ("joint_0", "joint_1")
    assert any("lacks targets" in remark for remark in log.metadata.remarks)


def test_damage(tmp_path):
    folder = write(tmp_path / "set")
    table = folder / "data" / "chunk-000" / "episode_000001.parquet"
    table.write_bytes(table.read_bytes()[:200])
    with pytest.raises(InputError, match=r"episode_000001.parquet: is no whole table"):
        open_log(folder)
    (folder / "meta" / "info.json").write_text("{}")
    with pytest.raises(InputError, match=r"expects observation\.state"):
        open_log(folder)
    (folder / "meta" / "info.json").write_text("{")
    with pytest.raises(InputError, match="is not JSON"):
        open_log(folder)


def test_targets_are_told_apart_by_their_names(tmp_path):
    folder = write(tmp_path / "set", version="v3.0")
    info = json.loads((folder / "meta" / "info.json").read_text())
    (file,) = (folder / "data").rglob("*.parquet")
    table = pyarrow.parquet.read_table(file)

    def with_action(names, columns):
        state = np.stack(table["observation.state"].to_pylist())
        action = {"dtype": "float32", "shape": [len(columns)], "names": names}
        about = info | {"features": info["features"] | {"action": action}}
        (folder / "meta" / "info.json").write_text(json.dumps(about))
        at = table.column_names.index("action")
        values = [list(row) for row in (state + 1)[:, columns]]
        pyarrow.parquet.write_table(table.set_column(at, "action", [values]), file)
        return open_log(folder)[0]

    apart = np.radians(1)
    for names, columns, logged in (
        (NAMES[::-1], [1, 0], ("shoulder_pan", "gripper")),
        (["speed", *NAMES], [0, 0, 1], ("shoulder_pan", "gripper")),
        (NAMES[:1], [0], ("shoulder_pan",)),
        (None, [0, 1], ("shoulder_pan", "gripper")),
        (["other_a", "other_b"], [0, 1], ("shoulder_pan", "gripper")),
    ):
        log = with_action(names, columns)
        targets = {column for column in log.signals if column.startswith("position_target/")}
        assert targets == {f"position_target/{joint}" for joint in logged}
        moved = log.column("position_target/shoulder_pan") - log.column("position/shoulder_pan")
        np.testing.assert_allclose(moved, apart, atol=1e-5)
    with pytest.raises(InputError, match=r"features.action = 1: expects a column for each of 2"):
        with_action(None, [0])
