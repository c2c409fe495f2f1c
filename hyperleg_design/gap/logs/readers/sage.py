"""SAGE's folders: `joint_list.txt`, `control.csv` (targets), `state_motor.csv` (positions,
velocities, torques as lists).

Time stamps are microseconds on hardware, seconds in simulation. The source lacks gains, units and
signs: the SO-101 collector writes the supply current's size under `torques`, which is left out, and
the jaw's position as 0 .. 1.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs.columns import columns_of
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers.source import beside, build_log, joint_names
from hyperleg_design.gap.logs.readers.timebase import onto, sorted_stream
from hyperleg_design.reading import given_path

STATE, CONTROL, JOINTS = "state_motor.csv", "control.csv", "joint_list.txt"
SO101 = ("Rotation", "Pitch", "Elbow", "Wrist_Pitch", "Wrist_Roll", "Jaw")
"""Joint list of the SO-101 arm, six STS3215 servos."""
SO101_FIRMWARE_GAIN = 16
"""Position gain that SAGE's collector writes to the servos; integral gain 0."""
STS3215 = {"torque_constant": 1.2116, "resistance": 2.676, "error_gain": 0.166, "supply": 7.4}
"""kt [Nm/A], R [ohm], duty a firmware gain and radian, nominal supply [V]: BAM's fit m1 of the 7.4
V servo. The recorded supply currents agree: duty^2 V / R predicts 19.5 A/rad^2 while holding, 22
are recorded (the 12 V servo would draw 42)."""
SO101_JAW_RANGE = 2.29
"""From closed to open [rad]: logged speed over rate of the 0 .. 1 position, in recordings that move
the jaw."""
LONGEST_STEP = 1.0
"""Median steps beyond are microseconds."""


def is_sage(path: Path) -> bool:
    """Decide whether a folder is a SAGE recording.

    Args:
        path: of the folder.

    Returns:
        True if it is.
    """
    return path.is_dir() and (path / STATE).is_file()


def read_sage(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """Read a SAGE folder, or one of its CSV files.

    Args:
        path: of the folder or file.
        metadata: fields that take precedence.

    Returns:
        One log.

    Raises:
        InputError: a missing, empty or malformed table.
    """
    folder = path if path.is_dir() else path.parent
    user_metadata = beside(folder, metadata)
    time, state = _table(folder / STATE, ("positions", "velocities", "torques"))
    width = state["positions"].shape[1]
    listed = (
        (folder / JOINTS).read_text(encoding="utf-8").split() if (folder / JOINTS).is_file() else []
    )
    if listed and len(listed) != width:
        remedy = f"expects {width} names, as many as {STATE} has values"
        raise InputError(f"{folder.name}/{JOINTS}", "", len(listed), remedy)
    joints = joint_names(user_metadata, listed or [f"joint_{i}" for i in range(width)], folder.name)
    remarks = [] if listed else ["the source names no joints: joint_0, joint_1, ... in its order"]
    scale = np.ones(width)
    source_metadata: dict[str, Any] = {"base": ""}
    if tuple(listed) == SO101:
        scale[-1] = SO101_JAW_RANGE
        source_metadata |= _so101(joints)
        remarks.append(
            f"{joints[-1]} is logged as 0 .. 1 and taken as {SO101_JAW_RANGE} rad from closed to "
            f"open; its zero is not known"
        )
        if "gains" not in user_metadata:
            remarks.append(
                "gains are worked out from the collector's firmware gain and published kt and R at "
                "7.4 V"
            )
    elif "gains" not in user_metadata:
        remarks.append("the source lacks the controller's gains; say `gains` in a side file")
    signals = columns_of({"position": state["positions"] * scale}, joints)
    if "velocities" in state:
        signals |= columns_of({"velocity": state["velocities"]}, joints)
    if "torques" in state:
        torque = state["torques"]
        if np.nanmin(torque) < 0:
            signals |= columns_of({"joint_torque": torque}, joints)
        else:
            remarks.append("torques have no sign (the size of a current) and were left out")
    if (folder / CONTROL).is_file():
        own, control = _table(folder / CONTROL, ("positions",))
        if control["positions"].shape[1] != width:
            remedy = f"expects {width} values, as {STATE}"
            raise InputError(
                f"{folder.name}/{CONTROL}", "positions", control["positions"].shape[1], remedy
            )
        targets = columns_of({"position_target": control["positions"] * scale}, joints)
        if len(own) == len(time) and np.array_equal(own, time):
            signals |= targets
        else:
            own, targets, _ = sorted_stream(own, targets)
            signals |= onto(time, own, targets, hold=True)
            remarks.append("targets have a clock of their own: each holds until the next")
    else:
        remarks.append(f"the source lacks {CONTROL}: no targets")
    return [build_log(folder, folder.name, time, signals, source_metadata, user_metadata, remarks)]


def _so101(joints: list[str]) -> dict[str, Any]:
    slope = STS3215["torque_constant"] / STS3215["resistance"]
    gains = [
        slope * STS3215["supply"] * STS3215["error_gain"] * SO101_FIRMWARE_GAIN,
        slope * STS3215["torque_constant"],
    ]
    return {
        "base": "fixed",
        "gains": dict.fromkeys(joints, gains),
        "torque_constant": dict.fromkeys(joints, STS3215["torque_constant"]),
        "supply": dict.fromkeys(
            joints,
            (
                STS3215["supply"],
                slope * STS3215["supply"],
                STS3215["supply"] / STS3215["torque_constant"],
            ),
        ),
        "extra": {
            "servo": "STS3215",
            "kp": SO101_FIRMWARE_GAIN,
            "vin": STS3215["supply"],
            "resistance": STS3215["resistance"],
        },
        "session": "so101",
    }


def _table(path: Path, columns: tuple[str, ...]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Time [s] `(t,)` and the columns of lists `(t, n)` of one CSV file."""
    import pandas as pd

    where = given_path(path)
    if not path.is_file():
        remedy = f"is missing: a recording is a folder with {STATE}, {CONTROL} and {JOINTS}"
        raise InputError(where, "", None, remedy)
    try:
        table = pd.read_csv(path)
    except (ValueError, pd.errors.ParserError, OSError) as error:
        raise InputError(where, "", None, f"is no table ({in_short(error, 80)})") from None
    for column in ("timestamp", "positions"):
        if column not in table:
            raise InputError(where, column, list(table.columns)[:6], "is missing")
    if len(table) < 2:
        raise InputError(where, "", len(table), "is an empty log: expects at least two rows")
    time = pd.to_numeric(table["timestamp"], errors="coerce").to_numpy(float)
    if np.nanmedian(np.diff(time)) > LONGEST_STEP:
        time = time * 1e-6
    lists = {}
    for column in columns:
        if column in table:
            lists[column] = _rows(table[column].tolist(), where, column)
    return time, lists


def _rows(texts: list[Any], where: str, column: str) -> np.ndarray:
    rows: list[list[float]] = []
    for number, text in enumerate(texts):
        try:
            row = [float(v) for v in json.loads(str(text).replace("nan", "NaN"))]
        except (ValueError, TypeError):
            raise InputError(
                where, f"{column}, row {number}", text, "expects a list of numbers, [0.1, 0.2]"
            ) from None
        if rows and len(row) != len(rows[0]):
            remedy = f"expects {len(rows[0])} values, as in the first row"
            raise InputError(where, f"{column}, row {number}", len(row), remedy)
        rows.append(row)
    return np.array(rows, float)
