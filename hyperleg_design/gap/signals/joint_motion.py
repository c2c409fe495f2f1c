"""The motion of a robot's joints in a log, smoothed onto even ticks."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import compress

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.frozen import frozen
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.smoothing import Smooth, smooth


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Motion of `n` joints in a log of `s` rows."""

    position: np.ndarray
    """As logged `(s, n)` [rad]; NaN where unknown or frozen."""
    velocity: np.ndarray
    """As logged `(s, n)` [rad/s]; NaN where unknown."""
    smooth: Smooth
    """Positions, speeds and accelerations at the ticks; joints without positions stand still."""
    lacking: np.ndarray
    """Joints without positions in this log `(n,)` of bool."""
    notes: tuple[str, ...]
    """What was left out or assumed."""


def joint_motion(log: Log, subject: Subject, ticks: np.ndarray) -> JointMotion:
    """Read the motion of the joints from a log, without stretches in which a position is frozen.

    Args:
        log: with positions.
        subject: the robot.
        ticks: times of the even time base [s], `(t,)`.

    Returns:
        The motion.

    Raises:
        InputError: none of the robot's joints has positions in this log.
    """
    notes = []
    position = log.stack("position", subject.joints)
    for column, joint in enumerate(subject.joints):
        if (stuck := frozen(log, joint)) is not None:
            position[stuck, column] = np.nan
            notes.append(
                f"{joint}: position frozen from {log.time[stuck.start]:.4g} s, left out until it "
                f"moves again"
            )
    velocity = log.stack("velocity", subject.joints)
    motion = smooth(log.time, position, ticks, velocity)
    lacking = ~np.isfinite(motion.value).any(0)
    if lacking.all():
        remedy = f"knows no joint of this robot, {', '.join(subject.joints)}"
        raise InputError(log.name, "position", sorted(log.joints)[:8], remedy)
    if lacking.any():
        names = ", ".join(compress(subject.joints, lacking))
        notes.append(f"joints without positions in this log, taken to stand still: {names}")
        motion.value[:, lacking] = subject.default[lacking]
        motion.first[:, lacking] = motion.second[:, lacking] = 0.0
    return JointMotion(position, velocity, motion, lacking, tuple(notes))
