"""BAM's JSON recordings of one servo that swings a mass: one entry a tick.

Servos are position-controlled by firmware: duty = gain * error_gain * (goal - position) of the
supply, clipped to one; the motor's torque is kt (duty V - kt speed) / R. At the nominal supply that
is a stiffness of kt / R * V * gain * error_gain and a damping of kt^2 / R, which the metadata
declare as gains, with a stall torque of kt / R * V and a no-load speed of V / kt. The motor's
current is not recorded by most files; it is worked out from recorded duty, supply voltage and
speed.

The source lacks the mass of the arm, friction and rotor inertia; kt and R are BAM's published fits
(model m1, whose friction does not depend on load) to recordings of this kind.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.readers.source import beside, build_log, joint_names


@dataclass(frozen=True)
class Servo:
    """What is published of a servo's drive."""

    torque_constant: float
    """kt, at the output [Nm/A]."""
    resistance: float
    """Resistance R of the winding [ohm]."""
    error_gain: float
    """Duty a unit of firmware gain and radian of error [1/rad]."""
    full_duty: float
    """Recorded load at full duty [counts]."""


SERVOS = {
    # error gain: firmware gain / 256 counts of PWM a count of position, 4096 counts a turn;
    # recorded duty agrees within 0.3 %
    "xl330": Servo(
        torque_constant=0.3029,
        resistance=3.368,
        error_gain=4096 / (2 * math.pi) / 256 / 885,
        full_duty=885.0,
    )
}
"""By BAM's name of the motor; kt and R from BAM's params/xl330/m1.json."""
JOINT = "servo"
"""Name of joint and motor; `joints` in a side file gives another."""
_NEEDED = ("timestamp", "position", "goal_position")
_NUMBERS = (
    "timestamp",
    "position",
    "speed",
    "load",
    "input_volts",
    "temp",
    "present_current",
    "goal_position",
    "torque_enable",
)


def is_bam(content: Any) -> bool:
    """Decide whether the content of a JSON file is one of BAM's recordings.

    Args:
        content: as parsed.

    Returns:
        True if it is.
    """
    return (
        isinstance(content, dict) and isinstance(content.get("entries"), list) and "mass" in content
    )


def read_bam(path: Path, metadata: Mapping[str, Any] | None = None) -> list[Log]:
    """Read one BAM recording.

    Args:
        path: of the file.
        metadata: fields that take precedence.

    Returns:
        One log.

    Raises:
        InputError: no JSON, none of BAM's, or entries that lack time, position or goal.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(
            path.name, "", None, f"is no whole JSON file ({in_short(error, 80)})"
        ) from None
    if not is_bam(content):
        raise InputError(
            path.name, "entries", None, "is missing: expects BAM's mass, length, kp, entries"
        )
    entries = content["entries"]
    if len(entries) < 2:
        raise InputError(
            path.name, "entries", len(entries), "is an empty log: expects at least two entries"
        )
    user_metadata = beside(path, metadata)
    joint = joint_names(user_metadata, [JOINT], path.name)[0]
    data = {
        key: _numbers(entries, key, path.name)
        for key in _NUMBERS
        if any(key in entry for entry in entries if isinstance(entry, dict))
    }
    for key in _NEEDED:
        if key not in data:
            raise InputError(path.name, f"entries.{key}", None, "is missing")
    goal = data["goal_position"]
    remarks = []
    if "torque_enable" in data and (data["torque_enable"] == 0).any():
        goal = np.where(data["torque_enable"] > 0, goal, np.nan)
        remarks.append("where the servo was switched off there is no target")
    signals = {f"position_target/{joint}": goal, f"position/{joint}": data["position"]}
    if "speed" in data:
        signals |= {f"velocity/{joint}": data["speed"], f"motor_velocity/{joint}": data["speed"]}
    if "temp" in data:
        signals[f"motor_temperature/{joint}"] = data["temp"]
    if "input_volts" in data:
        signals["battery_voltage"] = data["input_volts"]
    source_metadata = _source_metadata(content, joint)
    current, remark = _current(content, data)
    if current is not None:
        signals[f"motor_current/{joint}"] = current
        remarks.append(remark)
    if not source_metadata["gains"]:
        remarks.append(
            f"nothing is known of the drive of {content.get('motor')!r}: say `gains` in a side file"
        )
    elif "gains" not in user_metadata:
        remarks.append(
            "gains are worked out from the firmware's gain, the nominal supply and published kt "
            "and R"
        )
    date = re.match(r"\d{4}-\d{2}-\d{2}", path.stem)
    setup = (content.get(key) for key in ("motor", "mass", "length"))
    source_metadata["session"] = "_".join(map(str, (*setup, date[0] if date else path.stem)))
    return [
        build_log(
            path, path.stem, data["timestamp"], signals, source_metadata, user_metadata, remarks
        )
    ]


def _source_metadata(content: Mapping[str, Any], joint: str) -> dict[str, Any]:
    known = {
        key: content[key]
        for key in ("mass", "arm_mass", "length", "kp", "vin", "motor", "trajectory", "damping")
        if key in content
    }
    metadata: dict[str, Any] = {"base": "fixed", "gains": {}, "extra": known}
    metadata["notes"] = (
        f"{known.get('motor')} swings {known.get('mass')} kg at {known.get('length')} m, firmware "
        f"gain {known.get('kp')}"
    )
    servo = SERVOS.get(str(content.get("motor")).lower())
    if servo is not None and all(
        isinstance(content.get(key), int | float) for key in ("kp", "vin")
    ):
        slope = servo.torque_constant / servo.resistance
        stiffness = slope * content["vin"] * content["kp"] * servo.error_gain
        metadata["gains"] = {joint: [stiffness, slope * servo.torque_constant]}
        metadata["torque_constant"] = {joint: servo.torque_constant}
        metadata["supply"] = {
            joint: [content["vin"], slope * content["vin"], content["vin"] / servo.torque_constant]
        }
        metadata["extra"] = {**known, "resistance": servo.resistance}
    return metadata


def _current(
    content: Mapping[str, Any], data: Mapping[str, np.ndarray]
) -> tuple[np.ndarray | None, str]:
    if "present_current" in data:
        raw = data["present_current"]
        return np.where(
            raw > 2**15 - 1, raw - 2**16, raw
        ) * 1e-3, "the current is the servo's own reading, in steps of 1 mA"
    servo = SERVOS.get(str(content.get("motor")).lower())
    if servo is None or not {"load", "input_volts", "speed"} <= data.keys():
        return None, ""
    load = data["load"]
    duty = (
        load
        if np.nanmax(np.abs(load)) <= 1
        else np.where(load > 2**15 - 1, load - 2**16, load) / servo.full_duty
    )  # 16 bits, signed
    current = (
        duty * data["input_volts"] - servo.torque_constant * data["speed"]
    ) / servo.resistance
    return (
        current,
        "the current is not measured: worked out from recorded duty, supply voltage and speed with "
        "published kt and R",
    )


def _numbers(entries: list[Any], key: str, where: str) -> np.ndarray:
    values = np.full(len(entries), np.nan)
    for row, entry in enumerate(entries):
        value = entry.get(key) if isinstance(entry, dict) else entry
        if value is None and isinstance(entry, dict):
            continue
        if not isinstance(value, int | float):
            raise InputError(where, f"entries[{row}].{key}", value, "expects a number")
        values[row] = float(value)
    return values
