"""Residuals of an IMU: its reading minus what the logged motion of the base predicts for it.

The gyro is compared with the rate of a logged orientation, the accelerometer with the acceleration
of a logged velocity and gravity. No mass, friction or ground enters.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.base_motion import known, on_ticks, orientation, spin
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.smoothing import smooth


def inertial_residuals(log: Log, subject: Subject, ticks: np.ndarray) -> dict[str, np.ndarray]:
    """Compare gyro and accelerometer with a logged orientation and velocity.

    Args:
        log: of a robot.
        subject: the robot.
        ticks: [s], `(t,)`.

    Returns:
        `gyro` [rad/s] and `accelerometer` [m/s^2], in the sensor's axes `(t, 3)` each, as far as
        the log allows; of a fixed base none.
    """
    quaternion, gyro, felt, velocity = (
        known(log, kind) for kind in ("base_orientation", "gyro", "accelerometer", "base_velocity")
    )
    if quaternion is None or not subject.floating:
        return {}
    turning = orientation(log, quaternion, ticks)
    rate, turn = spin(turning)
    residuals = {}
    if gyro is not None:
        residuals["gyro"] = on_ticks(log, gyro, ticks) - rate @ subject.imu_rotation
    if felt is not None and velocity is not None:
        rotation = quaternion_rotation(turning.value)
        force = smooth(log.time, velocity, ticks).first - subject.gravity
        lever = subject.imu_position
        at_sensor = np.einsum("tji,tj->ti", rotation, force)
        at_sensor += np.cross(turn, lever) + np.cross(rate, np.cross(rate, lever))
        residuals["accelerometer"] = on_ticks(log, felt, ticks) - at_sensor @ subject.imu_rotation
    return residuals


def sensed(signals: Signals, sensor: str) -> np.ndarray:
    """Compute what a sensor of the IMU feels, without its lever arm.

    Args:
        signals: a conditioned log of a floating base, `t` ticks.
        sensor: `gyro` or `accelerometer`.

    Returns:
        In the sensor's axes `(t, 3)` [rad/s or m/s^2].
    """
    base = signals.base
    assert base is not None
    values = base.angular_velocity if sensor == "gyro" else base.specific_force
    return np.asarray(values @ signals.subject.imu_rotation)
