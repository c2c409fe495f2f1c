"""An inertial sensor with a constant error."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Set
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.excitation import Excitation, Motion
from hyperleg_design.gap.effects.families import INERTIAL
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.simulation.alteration import Alteration, Live

IMU = "imu"
_GYRO = (
    "0.01 rad/s turn-on bias of consumer MEMS gyros (BMI088, ICM-42688 data sheets: 0.5-1 "
    "deg/s before calibration)"
)
_ACCELEROMETER = (
    "0.2 m/s^2, 20 mg zero-g offset of consumer MEMS accelerometers (BMI088, ICM-42688 data sheets)"
)
GYRO, ACCELEROMETER = 0.003, 0.05
"""Usual biases [rad/s], [m/s^2]."""


class ImuBias(Effect):
    """Constant errors of gyro and accelerometer, in the sensor's axes.

    They differ from a logged orientation and velocity by it. The motion of a floating base is
    known from them, so that the joint torques which it needs are off, too. In simulation the policy
    is told a wrong angular velocity and a tilted gravity.
    """

    identifier: ClassVar[str] = "imu_bias"
    kind: ClassVar[str] = "sensor"
    summary: ClassVar[str] = "gyro and accelerometer are off by a constant"
    parameters: ClassVar[tuple[Parameter, ...]] = tuple(
        Parameter(f"{sensor}_{axis}", unit, 0.0, -most, most, typical, source, spread)
        for sensor, unit, most, typical, source, spread in (
            ("gyro", "rad/s", 0.5, 0.01, _GYRO, GYRO),
            ("accelerometer", "m/s^2", 5.0, 0.2, _ACCELEROMETER, ACCELEROMETER),
        )
        for axis in "xyz"
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {
        "rest level": INERTIAL | {"encoder_offset", "joint_spring"}
    }

    @override
    def locations(self, subject: Subject) -> tuple[str, ...]:
        """The sensor, on a floating base."""
        return (IMU,) if subject.floating else ()

    @override
    def excited(self, log: Log, motion: Motion) -> Excitation:
        known = tuple(k for k in ("gyro", "accelerometer") if log.has(k, "x"))
        why = "inertial data" if known else "no gyroscope and no accelerometer"
        return Excitation(self.identifier, bool(known), known, why)

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        values = np.atleast_2d(np.asarray(values, float))[:, None]
        ticks = (1, len(signals.time), 1)
        return misread(signals, np.tile(values[..., :3], ticks), np.tile(values[..., 3:], ticks))

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Each error alone, of both signs."""
        usual = np.diag(self.usual(location, signals.subject))
        return np.concatenate([usual, -usual])

    @override
    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        values = np.asarray(values, float)
        turned = subject.imu_rotation.T
        return BiasedImu(values[..., :3] @ turned, values[..., 3:] @ turned)


class _Imu(Live):
    alteration: BiasedImu

    def imu(self, angular_velocity: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return angular_velocity + self.alteration.gyro, force + self.alteration.accelerometer


@dataclass(frozen=True, eq=False)
class BiasedImu(Alteration):
    """What gyro and accelerometer tell is off."""

    live: ClassVar[type[Live] | None] = _Imu
    gyro: Any
    """In the base's axes [rad/s], `(3,)` or `(n, 3)`."""
    accelerometer: Any
    """In the base's axes [m/s^2], `(3,)` or `(n, 3)`."""


def misread(signals: Signals, gyro: np.ndarray, accelerometer: np.ndarray) -> dict[str, np.ndarray]:
    """Compute what errors of an IMU leave in the residuals: of the sensors themselves, and of the
    torques that the motion needs which they tell.

    Args:
        signals: a conditioned log, `t` ticks.
        gyro: errors of the gyro, in the sensor's axes `(k, t, 3)` [rad/s].
        accelerometer: errors of the accelerometer, in the sensor's axes `(k, t, 3)` [m/s^2].

    Returns:
        Traces by name of the residual `(k, t, rows)`; none without a floating base.
    """
    subject, base = signals.subject, signals.base
    if base is None:
        return {}
    by_gyro, by_accelerometer = (
        np.isfinite(signals.log.vector(kind)).any(0).all() for kind in ("gyro", "accelerometer")
    )
    motion = signals.position, signals.velocity, signals.acceleration
    arm = subject.imu_position

    def centripetal(spin: np.ndarray) -> np.ndarray:
        return np.cross(spin, np.cross(spin, arm))

    needed = rigid.inverse_dynamics(subject, *motion, base)
    wrench = rigid.base_wrench(subject, *motion, base) if "base" in signals.residual else None
    rows, base_rows = [], []
    for turning, felt in zip(gyro, accelerometer, strict=True):
        spin, force = base.angular_velocity, base.specific_force
        if by_gyro:
            spin = spin - turning @ subject.imu_rotation.T
        if by_accelerometer:
            force = force - felt @ subject.imu_rotation.T
            force = force + centripetal(base.angular_velocity) - centripetal(spin)
        true = dataclasses.replace(base, angular_velocity=spin, specific_force=force)
        rows.append(rigid.inverse_dynamics(subject, *motion, true) - needed)
        if wrench is not None:
            base_rows.append(rigid.base_wrench(subject, *motion, true) - wrench)
    traces = {"motion": np.stack(rows), "gyro": gyro, "accelerometer": accelerometer}
    return traces | ({"base": np.stack(base_rows)} if base_rows else {})
