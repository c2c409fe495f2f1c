"""Columns that a log may have: names of signals and their units."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

JOINT_SIGNALS = ("position_target", "position", "velocity", "joint_torque")
MOTOR_SIGNALS = (
    "motor_torque_command",
    "motor_torque",
    "motor_current",
    "motor_velocity",
    "motor_temperature",
)
VECTOR_SIGNALS = {
    "gyro": ("x", "y", "z"),
    "accelerometer": ("x", "y", "z"),
    "base_position": ("x", "y", "z"),
    "base_orientation": ("w", "x", "y", "z"),
    "base_velocity": ("x", "y", "z"),
}
BATTERY = "battery_voltage"
CONTACT = "contact_force"
UNITS = {
    "t": "s",
    "position_target": "rad",
    "position": "rad",
    "velocity": "rad/s",
    "joint_torque": "Nm",
    "motor_torque_command": "Nm",
    "motor_torque": "Nm",
    "motor_current": "A",
    "motor_velocity": "rad/s",
    "motor_temperature": "degC",
    BATTERY: "V",
    "gyro": "rad/s",
    "accelerometer": "m/s^2",
    "base_position": "m",
    "base_orientation": "",
    "base_velocity": "m/s",
    CONTACT: "N",
}
"""Unit of each signal."""
NEARLY = 0.85
"""Similarity from which a name is taken for a misspelt signal [-] (difflib's ratio)."""


def force_names(places: Iterable[str]) -> tuple[str, ...]:
    """Name the parts of the ground's forces on feet or pads.

    Args:
        places: names of feet or pads.

    Returns:
        Each of them with each axis, as after `contact_force/`.
    """
    return tuple(f"{place}_{axis}" for place in places for axis in "xyz")


def known_column(column: str) -> bool:
    """Decide whether the log format has a column.

    Args:
        column: its full name.

    Returns:
        True if it has.
    """
    kind, slash, name = column.partition("/")
    if kind in JOINT_SIGNALS or kind in MOTOR_SIGNALS:
        return bool(name)
    if kind in VECTOR_SIGNALS:
        return name in VECTOR_SIGNALS[kind]
    return (kind == CONTACT and len(name) > 2 and name[-2:] in ("_x", "_y", "_z")) or (
        kind == BATTERY and not slash
    )


def columns_of(signals: Mapping[str, np.ndarray], places: Sequence[str]) -> dict[str, np.ndarray]:
    """Name the columns of signals of several places.

    Args:
        signals: `(t, places)` each.
        places: names of the joints, motors or axes.

    Returns:
        Values `(t,)` by column.
    """
    return {
        f"{signal}/{place}": values[:, i]
        for signal, values in signals.items()
        for i, place in enumerate(places)
    }


def misspelt(columns: Iterable[str]) -> tuple[str, str] | None:
    """Find a column whose signal is nearly one of the format that the log lacks.

    Args:
        columns: of a log.

    Returns:
        The column and the one that is meant; None where there is none.
    """
    columns = list(columns)
    for column in columns:
        kind, _, name = column.partition("/")
        if known_column(column) or kind in UNITS:
            continue
        for near in difflib.get_close_matches(kind, UNITS, n=1, cutoff=NEARLY):
            wanted = f"{near}/{name}" if name else near
            if known_column(wanted) and wanted not in columns:
                return column, wanted
    return None


def unit(column: str) -> str:
    """Look up the unit of a column.

    Args:
        column: its full name.

    Returns:
        The unit; empty without one.
    """
    return UNITS.get(column.partition("/")[0], "")
