import sqlite3
import struct

import numpy as np
import pyarrow
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.readers import open_log
from hyperleg_design.gap.logs.readers.rosbag import BATTERY, IMU, JOINT_STATE

pytest.importorskip("mcap")
pytest.importorskip("rosbags")


class Writer:
    """CDR as the wire format defines it: numbers aligned to their size behind the four bytes of the
    encapsulation.
    """

    def __init__(self, order="<"):
        self.order, self.data = order, b""

    def put(self, kind, *values):
        size = struct.calcsize(kind)
        for value in values:
            self.data += b"\0" * (-len(self.data) % size) + struct.pack(self.order + kind, value)
        return self

    def text(self, value):
        raw = value.encode() + b"\0"
        self.put("I", len(raw))
        self.data += raw
        return self

    def header(self, t, frame="base"):
        return self.put("i", int(t)).put("I", round((t - int(t)) * 1e9)).text(frame)

    def done(self):
        return (b"\0\1" if self.order == "<" else b"\0\0") + b"\0\0" + self.data


def state(t, names, *values, order="<"):
    writer = Writer(order).header(t, "odd").put("I", len(names))
    for name in names:
        writer.text(name)
    for numbers in (*values, *[[]] * (3 - len(values))):
        writer.put("I", len(numbers)).put("d", *numbers)
    return writer.done()


def inertial(t):
    writer = Writer().header(t, "imu_link").put("d", 0.1, 0.2, 0.3, 0.9).put("d", -1, *[0] * 8)
    return (
        writer.put("d", t, 2 * t, 3 * t)
        .put("d", *[0] * 9)
        .put("d", 0, 0, 9.81)
        .put("d", *[0] * 9)
        .done()
    )


def battery(t, voltage):
    writer = Writer().header(t).put("f", voltage, *[0] * 6).put("B", 0, 0, 0, 1)
    return writer.put("I", 0, 0).text("").text("").done()


def traffic():
    """(topic, type, time logged, bytes) of two seconds: states at 100 Hz, targets at 50 Hz, an IMU
    at 200 Hz, a battery.
    """
    for i in range(200):
        t = 5 + i * 0.01
        yield (
            "/joint_states",
            JOINT_STATE,
            t,
            state(t, ["hip", "knee"], [np.sin(t), np.cos(t)], [np.cos(t), -np.sin(t)], [t, -t]),
        )
    for i in range(100):
        t = 5.003 + i * 0.02
        yield "/leg/command", JOINT_STATE, t, state(t, ["knee", "hip"], [2 * t, t])
    for i in range(400):
        t = 5 + i * 0.005
        yield "/imu", IMU, t, inertial(t)
    for i in range(20):
        t = 5 + i * 0.1
        yield "/battery", BATTERY, t, battery(t, 24.0 - i * 0.1)
    yield "/chatter", "std_msgs/msg/String", 6.0, Writer().text("hello").done()


def sqlite_bag(path, messages, encoding="cdr"):
    with sqlite3.connect(path) as base:
        base.execute(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
            "serialization_format TEXT, offered_qos_profiles TEXT)"
        )
        base.execute(
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
            "data BLOB)"
        )
        topics = {}
        for topic, kind, time, data in messages:
            if topic not in topics:
                topics[topic] = len(topics) + 1
                base.execute(
                    "INSERT INTO topics VALUES(?, ?, ?, ?, '')",
                    (topics[topic], topic, kind, encoding),
                )
            base.execute(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)",
                (topics[topic], round(time * 1e9), data),
            )
    base.close()
    return path


def mcap_file(path, messages, compression="", cut=0):
    """By the container's specification, one chunk of all messages and a summary left out."""

    def record(code, body):
        return bytes([code]) + struct.pack("<Q", len(body)) + body

    def text(value):
        return struct.pack("<I", len(value)) + value.encode()

    inside, kinds, topics = b"", {}, {}
    for topic, kind, time, data in messages:
        if kind not in kinds:
            kinds[kind] = len(kinds) + 1
            inside += record(
                3,
                struct.pack("<H", kinds[kind])
                + text(kind)
                + text("ros2msg")
                + struct.pack("<I", 3)
                + b"...",
            )
        if topic not in topics:
            topics[topic] = len(topics) + 1
            inside += record(
                4,
                struct.pack("<HH", topics[topic], kinds[kind])
                + text(topic)
                + text("cdr")
                + struct.pack("<I", 0),
            )
        inside += record(
            5, struct.pack("<HIQQ", topics[topic], 0, round(time * 1e9), round(time * 1e9)) + data
        )
    packed = pyarrow.compress(inside, codec=compression, asbytes=True) if compression else inside
    chunk = (
        struct.pack("<QQQI", 0, 0, len(inside), 0)
        + text(compression)
        + struct.pack("<Q", len(packed))
        + packed
    )
    whole = (
        b"\x89MCAP0\r\n"
        + record(1, text("ros2") + text("test"))
        + record(6, chunk)
        + record(7, b"\0" * 6)
    )
    whole += record(15, b"\0" * 4) + record(2, b"\0" * 20) + b"\x89MCAP0\r\n"
    path.write_bytes(whole[: len(whole) - cut])
    return path


def check(log):
    t = log.time + log.metadata.extra.get("start_time", 0)
    assert log.joints == ("hip", "knee")
    np.testing.assert_allclose(t, 5 + np.arange(200) * 0.01)
    np.testing.assert_allclose(log.signals["position/knee"], np.cos(t))
    np.testing.assert_allclose(log.signals["joint_torque/hip"], t)
    held = 5.003 + np.floor((t - 5.003) / 0.02) * 0.02
    np.testing.assert_allclose(log.signals["position_target/knee"][1:], 2 * held[1:])
    assert np.isnan(log.signals["position_target/knee"][0])
    np.testing.assert_allclose(log.signals["gyro/y"], 2 * t)
    np.testing.assert_allclose(log.signals["accelerometer/z"], 9.81)
    np.testing.assert_allclose(log.signals["battery_voltage"][:190], 24 - (t[:190] - 5), atol=1e-5)
    assert not log.has("base_orientation", "w")
    assert log.metadata.base == "floating"


@pytest.mark.parametrize("kind", ["sqlite", "", "zstd", "lz4"])
def test_bags(tmp_path, kind):
    path = tmp_path / ("run.db3" if kind == "sqlite" else "run.mcap")
    (log,) = open_log(
        sqlite_bag(path, traffic()) if kind == "sqlite" else mcap_file(path, traffic(), kind)
    )
    assert log.name == "run"
    check(log)


def test_folder_of_parts(tmp_path):
    folder = tmp_path / "bag"
    folder.mkdir()
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {}\n")
    ordered = sorted(traffic(), key=lambda m: m[2])
    sqlite_bag(folder / "bag_0.db3", ordered[:300])
    sqlite_bag(folder / "bag_1.db3", ordered[300:])
    (log,) = open_log(folder)
    assert log.name == "bag"
    check(log)


def test_joints_in_another_order_and_messages_out_of_order(tmp_path):
    messages = list(traffic())[:200]
    messages[7] = (*messages[7][:3], state(5.07, ["knee", "hip"], [np.cos(5.07), np.sin(5.07)]))
    messages[50], messages[51] = messages[51], messages[50]
    (log,) = open_log(mcap_file(tmp_path / "run.mcap", messages))
    t = 5 + np.arange(200) * 0.01
    np.testing.assert_allclose(log.signals["position/knee"], np.cos(t))
    assert np.isnan(log.signals["joint_torque/hip"][7])
    assert any("out of order" in remark for remark in log.metadata.remarks)


def test_two_publishers_on_one_topic(tmp_path):
    def both():
        for i in range(100):
            t = 5 + i * 0.01
            yield "/joint_states", JOINT_STATE, t, state(t, ["hip", "knee"], [t, -t])
            if i % 2:
                t += 0.004
                yield "/joint_states", JOINT_STATE, t, state(t, ["gripper"], [2 * t])

    (log,) = open_log(mcap_file(tmp_path / "run.mcap", both()))
    t = 5 + np.arange(100) * 0.01
    np.testing.assert_allclose(log.signals["position/knee"], -t)
    np.testing.assert_allclose(log.signals["position/gripper"][2:-1], 2 * t[2:-1])
    assert any("/joint_states of gripper has a clock" in r for r in log.metadata.remarks)


def test_columns_that_begin_later(tmp_path):
    def late():
        for i in range(20):
            t = 5 + i * 0.01
            yield "/joints", JOINT_STATE, t, state(t, ["hip"], *([t], [1.0])[: 1 + (i >= 10)])

    (log,) = open_log(mcap_file(tmp_path / "run.mcap", late()))
    np.testing.assert_array_equal(np.isnan(log.signals["velocity/hip"]), np.arange(20) < 10)


@pytest.mark.parametrize("order", "<>")
def test_messages_of_either_byte_order(tmp_path, order):
    messages = [
        ("/joints", JOINT_STATE, t, state(t, ["hip", "left_knee"], [t, 2], [3, 4], order=order))
        for t in np.arange(20) * 0.5
    ]
    (log,) = open_log(sqlite_bag(tmp_path / "run.db3", messages))
    np.testing.assert_allclose(log.column("position/hip"), log.time)
    np.testing.assert_array_equal(log.column("velocity/left_knee"), 4)


@pytest.mark.parametrize("cut", [0, 3, 8, 30, 50])
def test_cut_messages(tmp_path, cut):
    messages = [("/joints", JOINT_STATE, t, state(t, ["hip"], [t])[:cut]) for t in (1.0, 2.0)]
    with pytest.raises(InputError, match="/joints: holds a damaged message"):
        open_log(sqlite_bag(tmp_path / "run.db3", messages))


def test_bad_bags(tmp_path):
    with pytest.raises(InputError, match=r"holds no joint states"):
        open_log(sqlite_bag(tmp_path / "a.db3", list(traffic())[300:]))
    with pytest.raises(InputError, match="expects cdr"):
        open_log(sqlite_bag(tmp_path / "b.db3", list(traffic())[:10], "json"))
    broken = [(*m[:3], m[3][:40]) for m in list(traffic())[:10]]
    with pytest.raises(InputError, match="/joint_states: holds a damaged message"):
        open_log(sqlite_bag(tmp_path / "c.db3", broken))
    (tmp_path / "d.db3").write_bytes((tmp_path / "a.db3").read_bytes()[:5000])
    with pytest.raises(InputError, match=r"d.db3: is damaged"):
        open_log(tmp_path / "d.db3")
    with pytest.raises(InputError, match=r"e.mcap: is cut short"):
        open_log(mcap_file(tmp_path / "e.mcap", traffic(), "zstd", cut=200))
    damaged = bytearray(mcap_file(tmp_path / "f.mcap", traffic(), "zstd").read_bytes())
    damaged[2000:2100] = bytes(100)
    (tmp_path / "f.mcap").write_bytes(bytes(damaged))
    with pytest.raises(InputError, match=r"f.mcap"):
        open_log(tmp_path / "f.mcap")
