"""How a floating base moves, from whatever sensors a log has: gyro, accelerometer, orientation,
velocity, position.

All is smoothed without delay but the accelerometer, which needs no derivative.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.smoothing import Smooth, bridged, smooth

LEVELLING = 0.5
"""Rate at which an orientation integrated from the gyro is drawn to what the accelerometer calls
down [1/s]; assumed."""
QUIET = 0.1
"""Largest difference of the specific force from gravity, over gravity, at which the accelerometer
is asked for down; assumed."""


def base_motion(
    log: Log, subject: Subject, ticks: np.ndarray
) -> tuple[BaseMotion, tuple[str, ...]]:
    """Compute the motion of the base on the ticks.

    Specific force comes from the accelerometer, else from base velocity, else from base position.
    Angular velocity comes from the gyro, else from orientation. Orientation is logged, else
    integrated from gyro and accelerometer (heading then drifts).

    Args:
        log: of a floating base.
        subject: the robot.
        ticks: [s], `(t,)`.

    Returns:
        The motion, and notes on what was derived.

    Raises:
        InputError: neither accelerometer nor base velocity nor position, or neither gyro nor
        orientation.
    """
    notes: list[str] = []
    quaternion, gyro, felt = (
        known(log, kind) for kind in ("base_orientation", "gyro", "accelerometer")
    )
    velocity, place = known(log, "base_velocity"), known(log, "base_position")
    if gyro is None and quaternion is None:
        remedy = "neither it nor base_orientation is logged: declare base fixed, or log one of them"
        raise InputError(log.name, "gyro", None, remedy)
    if felt is None and (quaternion is None or (velocity is None and place is None)):
        remedy = (
            "neither it nor base_velocity or base_position with base_orientation is logged: "
            "declare base fixed, or log one of them"
        )
        raise InputError(log.name, "accelerometer", None, remedy)
    turning = orientation(log, quaternion, ticks) if quaternion is not None else None
    if gyro is not None:
        rates = smooth(log.time, gyro @ subject.imu_rotation.T, ticks)
        angular, angular_acceleration = rates.value, rates.first
    else:
        notes.append("angular velocity of the base is the derivative of its orientation")
        assert turning is not None
        angular, angular_acceleration = spin(turning)
    force = None
    if felt is not None:
        arm = subject.imu_position
        # not smoothed: residuals of forces are filtered later, together with the model's side
        force = (
            on_ticks(log, felt, ticks) @ subject.imu_rotation.T
            - np.cross(angular_acceleration, arm)
            - np.cross(angular, np.cross(angular, arm))
        )
    if turning is not None:
        rotation = quaternion_rotation(turning.value)
    else:
        assert force is not None
        notes.append(
            "orientation of the base is integrated from gyro and accelerometer; its heading is "
            "unknown"
        )
        rotation = _integrated(angular, force, ticks, subject.gravity)
    moving = smooth(log.time, velocity, ticks) if velocity is not None else None
    placed = smooth(log.time, place, ticks) if place is not None else None
    unknown = np.full((len(ticks), 3), np.nan)
    world = moving.value if moving is not None else placed.first if placed is not None else unknown
    if force is None:
        notes.append(
            f"acceleration of the base is the derivative of its "
            f"{'velocity' if moving is not None else 'position, twice'}"
        )
        acceleration = (
            moving.first if moving is not None else placed.second if placed is not None else unknown
        )
        force = np.einsum("tji,tj->ti", rotation, acceleration - subject.gravity)
    motion = BaseMotion(
        position=placed.value if placed is not None else unknown,
        rotation=rotation,
        linear_velocity=np.einsum("tji,tj->ti", rotation, world),
        angular_velocity=angular,
        specific_force=force,
        angular_acceleration=angular_acceleration,
    )
    return motion, tuple(notes)


def known(log: Log, kind: str) -> np.ndarray | None:
    """Look up a vector of a log.

    Args:
        log: the log.
        kind: such as `gyro`.

    Returns:
        `(s, 3)` or `(s, 4)`; None where any component is missing throughout.
    """
    values = log.vector(kind)
    return values if np.isfinite(values).any(0).all() else None


def on_ticks(log: Log, values: np.ndarray, ticks: np.ndarray) -> np.ndarray:
    """Interpolate a vector of a log to the ticks, with its gaps bridged.

    Args:
        log: the log.
        values: `(s, 3)`.
        ticks: [s], `(t,)`.

    Returns:
        `(t, 3)`.
    """
    return np.stack([np.interp(ticks, log.time, bridged(axis)) for axis in values.T], -1)


def orientation(log: Log, quaternion: np.ndarray, ticks: np.ndarray) -> Smooth:
    """Smooth a quaternion component by component, after its sign is made continuous.

    Args:
        log: the log.
        quaternion: w first, `(s, 4)`.
        ticks: [s], `(t,)`.

    Returns:
        The smoothed quaternion with its derivatives.

    Raises:
        InputError: quaternions that are not of unit length.
    """
    logged = np.isfinite(quaternion).all(1)
    q = quaternion[logged]
    length = np.linalg.norm(q, axis=1)
    if not np.all(np.abs(length - 1) < 0.1):
        remedy = "is no unit quaternion: expects w, x, y, z"
        raise InputError(
            log.name, "base_orientation", float(length[np.argmax(np.abs(length - 1))]), remedy
        )
    flips = np.concatenate([[1.0], np.where(np.sum(q[1:] * q[:-1], 1) < 0, -1.0, 1.0)])
    return smooth(log.time[logged], q * np.cumprod(flips)[:, None] / length[:, None], ticks)


def spin(turning: Smooth) -> tuple[np.ndarray, np.ndarray]:
    """Compute angular velocity and acceleration from a smoothed quaternion q, 2 q* q' and its
    derivative.

    Args:
        turning: the quaternion with its derivatives.

    Returns:
        Angular velocity [rad/s] and acceleration [rad/s^2] in the base's frame, `(t, 3)` each.
    """
    conjugate = turning.value * np.array([1, -1, -1, -1])
    norm = np.sum(turning.value**2, 1, keepdims=True)
    return 2 * _product(conjugate, turning.first)[:, 1:] / norm, 2 * _product(
        conjugate, turning.second
    )[:, 1:] / norm


def _product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    w = p[:, 0] * q[:, 0] - np.sum(p[:, 1:] * q[:, 1:], 1)
    return np.concatenate(
        [w[:, None], p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])], 1
    )


def _integrated(
    angular: np.ndarray, force: np.ndarray, ticks: np.ndarray, gravity: np.ndarray
) -> np.ndarray:
    """Orientation from angular velocity, drawn to the accelerometer's vertical while that feels
    little but gravity.
    """
    from scipy.spatial.transform import Rotation

    strength = float(np.linalg.norm(gravity)) or 1.0
    up = -np.asarray(gravity) / strength
    start = np.nanmean(force[: max(len(force) // 200, 5)], 0)
    rotation = _turn_onto(start / max(float(np.linalg.norm(start)), 1e-9), up)
    out = np.empty((len(ticks), 3, 3))
    steps = np.diff(ticks, append=ticks[-1])
    size = np.linalg.norm(force, axis=1)
    for tick in range(len(ticks)):
        out[tick] = rotation
        turn = angular[tick] * steps[tick]
        if abs(size[tick] - strength) < QUIET * strength:
            turn = turn + LEVELLING * steps[tick] * np.cross(
                force[tick] / size[tick], rotation.T @ up
            )
        rotation = rotation @ Rotation.from_rotvec(turn).as_matrix()
    return out


def _turn_onto(source: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Shortest rotation that takes the unit vector `source` to the unit vector `target`."""
    from scipy.spatial.transform import Rotation

    axis, cosine = np.cross(source, target), float(source @ target)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-9:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return np.asarray(Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix())
