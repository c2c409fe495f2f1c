"""How a robot carries itself: upright or leaning, joints at their stops, vibration."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

STOP = np.deg2rad(1.0)
"""Distance from the end of a joint's range within which it rests on the stop [rad]."""
VIBRATION = 15.0
"""Frequency above which motion counts as vibration [Hz]; a walk's own harmonics lie below."""


def headings(orientation: Any) -> np.ndarray:
    """Compute the directions in which bodies point on the floor.

    Args:
        orientation: quaternions w x y z, world from body, `(..., 4)`.

    Returns:
        Cosine and sine of the yaw, `(..., 2)`.
    """
    w, x, y, z = np.moveaxis(np.asarray(orientation, float), -1, 0)
    forward = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z)], -1)
    return np.asarray(forward / np.maximum(np.linalg.norm(forward, axis=-1, keepdims=True), 1e-9))


def tilt(orientation: Any) -> np.ndarray:
    """Compute the angle between a body's vertical axis and the world's.

    Args:
        orientation: quaternions w x y z, world from body, `(..., 4)`.

    Returns:
        The angle [rad], `(...)`.
    """
    _, x, y, _ = np.moveaxis(np.asarray(orientation, float), -1, 0)
    return np.arccos(np.clip(1 - 2 * (x * x + y * y), -1.0, 1.0))


def turned(heading: Any) -> float:
    """Compute the angle between the first and the last heading, whole turns included.

    Args:
        heading: cosine and sine of the yaw at each sample, `(t, 2)`.

    Returns:
        The angle, counterclockwise positive [rad].
    """
    heading = np.asarray(heading, float)
    angle = np.unwrap(np.arctan2(heading[:, 1], heading[:, 0]))
    return float(angle[-1] - angle[0])


def stop_share(joint_position: Any, lower: Any, upper: Any) -> np.ndarray:
    """Share of time that each joint rests on a stop or is pressed past it [-].

    Args:
        joint_position: [rad], `(t, J)`.
        lower: lower ends of the ranges of motion [rad], `(J,)`.
        upper: upper ends [rad], `(J,)`.

    Returns:
        `(J,)`
    """
    position = np.asarray(joint_position, float)
    return np.asarray(
        np.mean((position < np.asarray(lower) + STOP) | (position > np.asarray(upper) - STOP), 0)
    )


def stop_measures(
    joint_position: Any, joint_velocity: Any, stop_torque: Any, lower: Any, upper: Any
) -> dict[str, float]:
    """How far joints go past their stops, and the power of the stops, which no motor pays.

    A stop takes energy from a joint that moves into it, returns what its spring stored, and
    dissipates the difference.

    Args:
        joint_position: [rad], `(t, J)`.
        joint_velocity: [rad/s], `(t, J)`.
        stop_torque: of the stops on the joints [Nm], `(t, J)`; None where nobody recorded it.
        lower: lower ends of the ranges of motion [rad], `(J,)`.
        upper: upper ends [rad], `(J,)`.

    Returns:
        `stop_overshoot` [rad], the largest, `stop_absorbed_power` and `stop_returned_power` [W],
        summed over the joints, mean over time and not negative.
    """
    position = np.asarray(joint_position, float)
    past = np.maximum(np.asarray(lower) - position, position - np.asarray(upper))
    measures = {"stop_overshoot": float(max(past.max(), 0.0))}
    power = (
        np.full((1, 1), np.nan)
        if stop_torque is None
        else np.asarray(stop_torque, float) * np.asarray(joint_velocity, float)
    )
    measures["stop_absorbed_power"] = float(np.maximum(-power, 0.0).sum(-1).mean())
    measures["stop_returned_power"] = float(np.maximum(power, 0.0).sum(-1).mean())
    return measures


def vibration(joint_velocity: Any, time_step: float, above: float = VIBRATION) -> np.ndarray:
    """Compute how much the joints vibrate above a frequency.

    Args:
        joint_velocity: joint velocities at even time steps [rad/s], `(t, J)`.
        time_step: time between samples [s].
        above: cut-off of the high-pass filter [Hz].

    Returns:
        Root mean square of the filtered velocities [rad/s], `(J,)`.
    """
    from scipy.signal import sosfiltfilt

    velocity = np.asarray(joint_velocity, float)
    fast = sosfiltfilt(
        _high_pass(above, 1 / time_step), velocity, axis=0, padlen=min(9, len(velocity) - 1)
    )
    return np.asarray(np.sqrt(np.mean(fast**2, 0)))


@cache
def _high_pass(above: float, rate: float) -> np.ndarray:
    """Second-order sections of the filter, which all trials of a protocol share."""
    from scipy.signal import butter

    return np.asarray(butter(2, above, "highpass", fs=rate, output="sos"))
