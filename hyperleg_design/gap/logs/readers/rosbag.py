"""ROS 2 bags: sqlite3 (`.db3`) and MCAP, with `sensor_msgs` JointState, Imu and BatteryState, whose
bytes the library `rosbags` decodes.

Positions, velocities and efforts (taken as joint torques) come from JointState topics; a JointState
topic whose name speaks of commands gives position targets. The clock is that of the joint states'
headers; inertial data are interpolated onto it, targets hold. The source lacks gains, torque
constants and motor signals, and does not say that the inertial sensor sits in the base's frame,
which is taken for granted.
"""

from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs import blocks
from hyperleg_design.gap.logs import columns as log_columns
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers import mcap
from hyperleg_design.gap.logs.readers.source import beside, build_log
from hyperleg_design.gap.logs.readers.timebase import onto, sorted_stream

JOINT_STATE = "sensor_msgs/msg/JointState"
IMU = "sensor_msgs/msg/Imu"
BATTERY = "sensor_msgs/msg/BatteryState"
READ = (JOINT_STATE, IMU, BATTERY)
"""Types that are decoded."""
SQLITE = b"SQLite format 3\0"
COMMANDS = ("command", "cmd", "target", "desired", "reference", "goal", "setpoint")
"""Words in the name of a topic whose joint states are targets."""
IMU_COLUMNS = (
    *(f"base_orientation/{k}" for k in "wxyz"),
    *(f"gyro/{k}" for k in "xyz"),
    *(f"accelerometer/{k}" for k in "xyz"),
)


@dataclass(frozen=True)
class _Source:
    """What publishes a stream: an arm and its gripper may share a topic, each with a clock of its
    own.
    """

    topic: str
    kind: str
    """Type of its messages."""
    joints: frozenset[str]
    """Joints that each of its messages holds."""

    def __str__(self) -> str:
        if self.kind != JOINT_STATE:
            return self.topic
        return f"{self.topic} of {', '.join(sorted(self.joints))}"


@dataclass
class _Stream:
    """Messages of one source."""

    time: list[float] = field(default_factory=list)
    columns: dict[str, int] = field(default_factory=dict)
    """Place of each column that any message has, in order of appearance."""
    places: dict[tuple[str, ...], list[int]] = field(default_factory=dict)
    """Places of the columns of a message, by these columns."""
    rows: list[tuple[list[int], np.ndarray]] = field(default_factory=list)
    """Of each message, the places of its columns and their values."""

    def add(self, time: float, columns: tuple[str, ...], row: np.ndarray) -> None:
        """Append a message, which may have other columns than those before."""
        if columns not in self.places:
            self.places[columns] = [
                self.columns.setdefault(column, len(self.columns)) for column in columns
            ]
        self.time.append(time)
        self.rows.append((self.places[columns], row))

    def arrays(self) -> tuple[np.ndarray, dict[str, np.ndarray], int]:
        """Sorted times, columns with NaN where a message lacks them, and messages out of order."""
        values = np.full((len(self.rows), len(self.columns)), np.nan)
        for message, (places, row) in enumerate(self.rows):
            values[message, places] = row
        return sorted_stream(
            np.array(self.time), {column: values[:, i] for column, i in self.columns.items()}
        )


def is_bag(path: Path) -> bool:
    """Decide whether a folder is a ROS 2 bag.

    Args:
        path: of the folder.

    Returns:
        True if it is.
    """
    return path.is_dir() and (path / "metadata.yaml").is_file() and bool(_parts(path))


def read_bag(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """Read a bag: a folder with its parts, or one `.db3` or `.mcap` file.

    Args:
        path: of the folder or file.
        metadata: fields that take precedence.

    Returns:
        One log.

    Raises:
        InputError: damaged, without joint states, or in another encoding than CDR.
    """
    user_metadata = beside(path, metadata)
    streams, remarks = _streams(_parts(path) if path.is_dir() else [path], path.name)
    states = {
        source: stream
        for source, stream in streams.items()
        if source.kind == JOINT_STATE and not _commands(source.topic)
    }
    if not states:
        there = sorted({source.topic for source in streams})
        remedy = f"holds no joint states: expects {JOINT_STATE} with positions"
        raise InputError(path.name, "topics", there, remedy)
    main = max(states, key=lambda source: len(states[source].time))
    time, signals, disorder = states[main].arrays()
    if disorder:
        remarks.append(
            f"{disorder} messages of {main.topic} came out of order and were sorted by their stamps"
        )
    for source, stream in streams.items():
        if source == main:
            continue
        own, values, _ = stream.arrays()
        is_target = source.kind == JOINT_STATE and _commands(source.topic)
        if is_target:
            positions = {c: v for c, v in values.items() if c.startswith("position/")}
            values = {c.replace("position", "position_target", 1): v for c, v in positions.items()}
        new = {column: v for column, v in values.items() if column not in signals}
        signals |= onto(time, own, new, hold=is_target)
        remarks.append(
            f"{source} has a clock of its own: "
            f"{'each target holds until the next' if is_target else 'interpolated'}"
        )
    if not any(c.startswith("position_target/") for c in signals):
        remarks.append("the source lacks targets: no JointState topic speaks of commands")
    if not user_metadata.get("gains"):
        remarks.append("the source lacks the controller's gains; say `gains` in a side file")
    name = path.name if path.is_dir() else path.stem
    source_metadata = {}
    if any(c.startswith("gyro/") for c in signals):
        source_metadata["base"] = "floating"
        if not user_metadata.get("base"):
            remarks.append(
                'an IMU is logged, so the base is taken as floating; if it is fixed, say `"base": '
                '"fixed"` in a side file'
            )
    return [build_log(path, name, time, signals, source_metadata, user_metadata, remarks)]


def _parts(path: Path) -> list[Path]:
    return sorted(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))


def _commands(topic: str) -> bool:
    return any(word in topic.lower() for word in COMMANDS)


def _streams(parts: list[Path], where: str) -> tuple[dict[_Source, _Stream], list[str]]:
    streams: dict[_Source, _Stream] = {}
    remarks: list[str] = []
    held = 0
    decode = _decoder(where)
    for part in parts:
        for message in _messages(part):
            if message.encoding != "cdr":
                raise InputError(
                    where, message.topic, message.encoding, "is no known encoding: expects cdr"
                )
            stamp, columns, row = _decoded(decode(message))
            source = _Source(message.topic, message.type, _joints(columns))
            stream = streams.setdefault(source, _Stream())
            stream.add(stamp if stamp > 0 else message.time, columns, row)
            held += len(row)
            if held > blocks.MAX_VALUES:
                return streams, [
                    *remarks,
                    "too long to be held in memory: only its beginning was read",
                ]
    return {k: s for k, s in streams.items() if len(s.rows) > 1 and s.columns}, remarks


@cache
def _joints(columns: tuple[str, ...]) -> frozenset[str]:
    return frozenset(column.partition("/")[2] for column in columns)


def _decoder(where: str) -> Callable[[mcap.Message], Any]:
    """What decodes messages by their types; it raises an `InputError` on damaged ones.

    Raises:
        InputError: the library is not installed.
    """
    try:
        from rosbags.serde import SerdeError
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(where, "", None, mcap.INSTALL) from None
    types = get_typestore(Stores.ROS2_HUMBLE)

    def decode(message: mcap.Message) -> Any:
        try:
            return types.deserialize_cdr(message.data, message.type)
        except SerdeError as error:
            raise InputError(
                where, message.topic, None, f"holds a damaged message ({in_short(error, 80)})"
            ) from None

    return decode


def _decoded(message: Any) -> tuple[float, tuple[str, ...], np.ndarray]:
    """Stamp [s], columns and values of a decoded message of one of the types `READ`."""
    stamp = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
    match message.__msgtype__:
        case kind if kind == IMU:
            o = message.orientation
            spin, felt = _xyz(message.angular_velocity), _xyz(message.linear_acceleration)
            parts = [
                _measured([o.w, o.x, o.y, o.z], message.orientation_covariance),
                _measured(spin, message.angular_velocity_covariance),
                _measured(felt, message.linear_acceleration_covariance),
            ]
            return stamp, IMU_COLUMNS, np.concatenate(parts)
        case kind if kind == BATTERY:
            return stamp, (log_columns.BATTERY,), np.array([float(message.voltage)])
    columns: list[str] = []
    rows: list[np.ndarray] = []
    for signal, values in (
        ("position", message.position),
        ("velocity", message.velocity),
        ("joint_torque", message.effort),
    ):
        if len(values) and len(values) == len(message.name):
            columns += [f"{signal}/{name}" for name in message.name]
            rows.append(np.asarray(values, float))
    return stamp, tuple(columns), np.concatenate(rows) if rows else np.empty(0)


def _xyz(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def _measured(values: list[float], covariance: np.ndarray) -> np.ndarray:
    """Values, NaN where the first covariance is -1: by ROS's convention no such measurement."""
    return np.full(len(values), np.nan) if covariance[0] == -1 else np.array(values, float)


def _messages(part: Path) -> Iterator[mcap.Message]:
    with part.open("rb") as stream:
        magic = stream.read(16)
    if magic.startswith(mcap.MAGIC):
        yield from mcap.messages(part, READ)
        return
    if magic != SQLITE:
        remedy = "is neither an MCAP file nor a sqlite3 bag; decompress a .zstd bag first"
        raise InputError(part.name, "", None, remedy)
    try:
        with contextlib.closing(
            sqlite3.connect(f"{part.resolve().as_uri()}?mode=ro", uri=True)
        ) as base:
            marks = ", ".join("?" for _ in READ)
            query = (
                "SELECT topics.name, topics.type, topics.serialization_format, messages.timestamp, "
                "messages.data FROM messages "
                f"JOIN topics ON messages.topic_id = topics.id WHERE topics.type IN ({marks}) "
                f"ORDER BY messages.timestamp, messages.id"
            )
            for topic, kind, encoding, time, data in base.execute(query, READ):
                yield mcap.Message(topic, kind, encoding, time * 1e-9, bytes(data))
    except sqlite3.Error as error:
        raise InputError(part.name, "", None, f"is damaged ({error})") from None
