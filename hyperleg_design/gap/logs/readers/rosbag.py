"""ROS 2 bags: sqlite3 (`.db3`) and MCAP, with `sensor_msgs` JointState, Imu and BatteryState in
CDR.

Positions, velocities and efforts (taken as joint torques) come from JointState topics; a JointState
topic whose name speaks of commands gives position targets. The clock is that of the joint states'
headers; inertial data are interpolated onto it, targets hold. The source lacks gains, torque
constants and motor signals, and does not say that the inertial sensor sits in the base's frame,
which is taken for granted.
"""

from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs import log as logs
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers import cdr, mcap
from hyperleg_design.gap.logs.readers.source import beside, made_log
from hyperleg_design.gap.logs.readers.timebase import onto, sorted_stream

SQLITE = b"SQLite format 3\0"
COMMANDS = ("command", "cmd", "target", "desired", "reference", "goal", "setpoint")
"""Words in the name of a topic whose joint states are targets."""
IMU_COLUMNS = (
    *(f"base_orientation/{k}" for k in "wxyz"),
    *(f"gyro/{k}" for k in "xyz"),
    *(f"accelerometer/{k}" for k in "xyz"),
)


@dataclass
class _Stream:
    time: list[float] = field(default_factory=list)
    columns: tuple[str, ...] = ()
    rows: list[np.ndarray] = field(default_factory=list)

    def arrays(self) -> tuple[np.ndarray, dict[str, np.ndarray], int]:
        values = np.stack(self.rows)
        return sorted_stream(
            np.array(self.time), {column: values[:, i] for i, column in enumerate(self.columns)}
        )


def is_bag(path: Path) -> bool:
    """Whether a folder is a ROS 2 bag."""
    return path.is_dir() and (path / "metadata.yaml").is_file() and bool(_parts(path))


def read_bag(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """The log of a bag: a folder with its parts, or one `.db3` or `.mcap` file.

    Raises:
        InputError: damaged, without joint states, or in another encoding than CDR.
    """
    said = beside(path, metadata)
    streams, remarks = _streams(_parts(path) if path.is_dir() else [path], path.name)
    states = {
        topic: s
        for (topic, kind), s in streams.items()
        if kind == cdr.JOINT_STATE and not _commands(topic)
    }
    if not states:
        there = sorted({topic for topic, _ in streams})
        raise InputError(
            path.name,
            "topics",
            there,
            f"holds no joint states: expects {cdr.JOINT_STATE} with positions",
        )
    main = max(states, key=lambda topic: len(states[topic].time))
    time, signals, disorder = states[main].arrays()
    if disorder:
        remarks.append(
            f"{disorder} messages of {main} came out of order and were sorted by their stamps"
        )
    for (topic, kind), stream in streams.items():
        if topic == main or not stream.rows:
            continue
        own, values, _ = stream.arrays()
        is_target = kind == cdr.JOINT_STATE and _commands(topic)
        if is_target:
            values = {
                c.replace("position/", "position_target/", 1): v
                for c, v in values.items()
                if c.startswith("position/")
            }
        new = {column: v for column, v in values.items() if column not in signals}
        signals |= onto(time, own, new, hold=is_target)
        remarks.append(
            f"{topic} has a clock of its own: "
            f"{'each target holds until the next' if is_target else 'interpolated'}"
        )
    if not any(c.startswith("position_target/") for c in signals):
        remarks.append("the source lacks targets: no JointState topic speaks of commands")
    if not said.get("gains"):
        remarks.append("the source lacks the controller's gains; say `gains` in a side file")
    name = path.name if path.is_dir() else path.stem
    found = {"base": "floating"} if any(c.startswith("gyro/") for c in signals) else {}
    return [made_log(path, name, time, signals, found, said, remarks)]


def _parts(path: Path) -> list[Path]:
    return sorted(p for p in path.iterdir() if p.suffix in (".db3", ".mcap"))


def _commands(topic: str) -> bool:
    return any(word in topic.lower() for word in COMMANDS)


def _streams(parts: list[Path], where: str) -> tuple[dict[tuple[str, str], _Stream], list[str]]:
    streams: dict[tuple[str, str], _Stream] = {}
    remarks: list[str] = []
    held = 0
    for part in parts:
        for message in _messages(part):
            if message.encoding != "cdr":
                raise InputError(
                    where, message.topic, message.encoding, "is no known encoding: expects cdr"
                )
            stream = streams.setdefault((message.topic, message.type), _Stream())
            try:
                stamp, columns, row = _decoded(message)
            except cdr.CdrError as error:
                raise InputError(
                    where, message.topic, None, f"holds a damaged message: it {error}"
                ) from None
            if not stream.columns:
                stream.columns = columns
            elif stream.columns != columns:
                row = _reordered(stream.columns, columns, row)
            stream.time.append(stamp if stamp > 0 else message.time)
            stream.rows.append(row)
            held += len(row)
            if held > logs.MAX_VALUES:
                return streams, [
                    *remarks,
                    "too long to be held in memory: only its beginning was read",
                ]
    return {k: s for k, s in streams.items() if len(s.rows) > 1 and s.columns}, remarks


def _reordered(wanted: tuple[str, ...], columns: tuple[str, ...], row: np.ndarray) -> np.ndarray:
    have = dict(zip(columns, row, strict=True))
    return np.array([have.get(column, np.nan) for column in wanted])


def _decoded(message: mcap.Message) -> tuple[float, tuple[str, ...], np.ndarray]:
    if message.type == cdr.IMU:
        stamp, row = cdr.imu(message.data)
        return stamp, IMU_COLUMNS, row
    if message.type == cdr.BATTERY:
        stamp, voltage = cdr.battery(message.data)
        return stamp, (logs.BATTERY,), np.array([voltage])
    state = cdr.joint_state(message.data)
    columns: list[str] = []
    parts: list[np.ndarray] = []
    for signal, values in (
        ("position", state.position),
        ("velocity", state.velocity),
        ("joint_torque", state.effort),
    ):
        if len(values) and len(values) == len(state.names):
            columns += [f"{signal}/{name}" for name in state.names]
            parts.append(values)
    return (
        state.stamp,
        tuple(columns),
        np.concatenate(parts).astype(float) if parts else np.empty(0),
    )


def _messages(part: Path) -> Iterator[mcap.Message]:
    with part.open("rb") as stream:
        magic = stream.read(16)
    if magic.startswith(mcap.MAGIC):
        yield from mcap.messages(part, cdr.READ)
        return
    if magic != SQLITE:
        raise InputError(
            part.name,
            "",
            None,
            "is neither an MCAP file nor a sqlite3 bag; decompress a .zstd bag first",
        )
    try:
        with contextlib.closing(
            sqlite3.connect(f"{part.resolve().as_uri()}?mode=ro", uri=True)
        ) as base:
            marks = ", ".join("?" for _ in cdr.READ)
            query = (
                "SELECT topics.name, topics.type, topics.serialization_format, messages.timestamp, "
                "messages.data FROM messages "
                f"JOIN topics ON messages.topic_id = topics.id WHERE topics.type IN ({marks}) "
                f"ORDER BY messages.timestamp, messages.id"
            )
            for topic, kind, encoding, time, data in base.execute(query, cdr.READ):
                yield mcap.Message(topic, kind, encoding, time * 1e-9, bytes(data))
    except sqlite3.Error as error:
        raise InputError(part.name, "", None, f"is damaged ({error})") from None
