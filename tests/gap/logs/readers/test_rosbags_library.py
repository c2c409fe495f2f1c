"""ROS 2 bags that the library `rosbags` wrote, an implementation independent of ours."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.logs.readers import open_log

rosbag2 = pytest.importorskip("rosbags.rosbag2")
typesys = pytest.importorskip("rosbags.typesys")

START = 1_700_000_000_000_000_000
"""Of the clock [ns]."""


@pytest.mark.parametrize("storage", ["SQLITE3", "MCAP"])
@pytest.mark.parametrize("store", ["ROS2_HUMBLE", "ROS2_JAZZY"])
def test_joint_states_are_read_as_they_were_written(tmp_path, storage, store):
    types = typesys.get_typestore(getattr(typesys.Stores, store))
    state, header, stamp = (
        types.types[name]
        for name in (
            "sensor_msgs/msg/JointState",
            "std_msgs/msg/Header",
            "builtin_interfaces/msg/Time",
        )
    )
    rng = np.random.default_rng(0)
    position, velocity, effort = rng.normal(size=(3, 60, 2))
    time = START + 5_000_000 * np.arange(60)
    with rosbag2.Writer(
        tmp_path / "bag", version=9, storage_plugin=getattr(rosbag2.StoragePlugin, storage)
    ) as writer:
        topic = writer.add_connection("/joint_states", state.__msgtype__, typestore=types)
        for row, now in enumerate(time.tolist()):
            message = state(
                header=header(stamp=stamp(*divmod(now, 10**9)), frame_id=""),
                name=["hip", "knee"],
                position=position[row],
                velocity=velocity[row],
                effort=effort[row],
            )
            writer.write(topic, now, types.serialize_cdr(message, state.__msgtype__))
    (log,) = open_log(tmp_path / "bag")
    assert log.joints == ("hip", "knee")
    np.testing.assert_allclose(log.time, 0.005 * np.arange(60), atol=1e-6)
    for kind, values in (("position", position), ("velocity", velocity), ("joint_torque", effort)):
        np.testing.assert_array_equal(log.stack(kind, log.joints), values)
