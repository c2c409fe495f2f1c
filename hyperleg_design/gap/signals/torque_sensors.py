"""Torque sensors between gears and links: which joints have them, and what acts before them."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model import friction
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.channels import of_motors
from hyperleg_design.gap.signals.limit_cycle import LimitCycle
from hyperleg_design.gap.signals.smoothing import Smooth


def behind_gears(log: Log, subject: Subject) -> np.ndarray | None:
    """Find the joints whose torque a sensor behind the gear tells, and no signal of their motors.

    Args:
        log: as it was read.
        subject: the robot.

    Returns:
        `(n,)` of bool; None where there is none.
    """
    if not log.metadata.torque_sensors:
        return None
    logged = of_motors(log, "motor_torque", subject), of_motors(log, "motor_current", subject)
    own = np.isfinite(np.concatenate(logged)).any(0)
    sensed = np.isin(subject.joints, log.metadata.torque_sensors)
    sensed &= np.isfinite(log.stack("joint_torque", subject.joints)).any(0)
    sensed &= ~(subject.joint_from_motor[:, own] != 0).any(1)
    return sensed if sensed.any() else None


def taken_before(
    subject: Subject, behind: np.ndarray, motion: Smooth, shaken: LimitCycle | None
) -> np.ndarray:
    """Compute what nominal friction and rotors take of the drives before these sensors.

    Args:
        subject: the robot.
        behind: joints with such a sensor, `(n,)`.
        motion: of the joints, `t` ticks.
        shaken: limit cycle of the joints; None where there is none.

    Returns:
        The torque at the joints [Nm], `(t, n)`; 0 at joints without such a sensor.
    """
    rubbing = friction.rubbing_torque(
        subject, motion.first, None if shaken is None else shaken.speed
    )
    return np.where(behind, rubbing + motion.second @ subject.armature.T, 0.0)
