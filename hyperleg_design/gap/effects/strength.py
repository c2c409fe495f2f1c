"""Torques that joints and motors are made for, and inertias at joints, also of robots whose files
give no limits, or placeholders.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.memoized import memoized

PLACEHOLDER = 100.0
"""Limit of torque over what a joint needs from which, at all joints of a robot, it limits nothing
[-]: robots of `example-robot-data` have 13 at most at the joint where it is least, those with
limits of 1000 Nm at each joint of a small leg 1500 and more."""
LIVELY = 10.0
"""Acceleration that a robot's drives are taken to be made for where nobody gives their limits
[rad/s^2]; assumed."""
BEYOND = 10.0
"""Largest torque of a joint over what it needs, where nobody gives its limits [-] (assumed: robots
of `example-robot-data` can give up to 13 times what their most loaded joint needs)."""
_POSTURES = 24


@memoized
def joint_strength(subject: Subject) -> np.ndarray:
    """Torque for which each joint is made `(n,)` [Nm]: what its motors can give; gravity's largest
    and its inertia's share where that is not known, and where the limits of all joints that
    carry weight are placeholders, `PLACEHOLDER` times that and more.

    Args:
        subject: the robot.

    Returns:
        The torques `(n,)` [Nm].
    """
    return np.where(_unlimited(subject), np.maximum(*_needed(subject)), _given(subject)[0])


@memoized
def largest_torque(subject: Subject) -> np.ndarray:
    """Torque that may act at each joint at most `(n,)` [Nm]: `joint_strength` where limits give it,
    `BEYOND` times as much where it is only what the joint needs.

    Args:
        subject: the robot.

    Returns:
        The torques `(n,)` [Nm].
    """
    return np.where(_unlimited(subject), BEYOND, 1.0) * joint_strength(subject)


def motor_strength(subject: Subject, motor: int) -> float:
    """Torque for which a motor is made [Nm]: its limit or what it gives at stall, else its share of
    what its joints are made for.

    Args:
        subject: the robot.
        motor: index of the motor.

    Returns:
        The torque [Nm].
    """
    most = float(min(subject.torque_limit[motor], subject.stall_torque[motor]))
    if 0 < most < np.inf and not has_placeholders(subject):
        return most
    column = np.abs(subject.joint_from_motor[:, motor])
    used = column > 0
    return float(np.max(joint_strength(subject)[used] / column[used], initial=1e-3))


def motor_strengths(subject: Subject) -> np.ndarray:
    """Torque for which each motor is made, as `motor_strength`.

    Args:
        subject: the robot.

    Returns:
        The torques `(m,)` [Nm].
    """
    return np.array([motor_strength(subject, motor) for motor in range(len(subject.motors))])


def joint_inertia(subject: Subject) -> np.ndarray:
    """Inertia at each joint alone at the posture of rest, rotors left out `(n,)` [kg m^2].

    Args:
        subject: the robot.

    Returns:
        The inertias `(n,)` [kg m^2].
    """
    still = np.zeros((len(subject.joints), len(subject.joints)))
    rest = np.broadcast_to(subject.default, still.shape)
    base = _base_at_rest(subject, len(still))
    moved = rigid.inverse_dynamics(subject, rest, still, np.eye(len(still)), base, rotors=False)
    return np.asarray(
        np.diag(moved - rigid.inverse_dynamics(subject, rest, still, still, base, rotors=False))
    )


def _given(subject: Subject) -> tuple[np.ndarray, np.ndarray]:
    """Torque that its motors can give each joint `(n,)` [Nm], and where that is not known."""
    most = np.minimum(subject.torque_limit, subject.stall_torque)
    share, known = np.abs(subject.joint_from_motor), np.isfinite(most)
    given = share @ np.where(known, most, 0.0)
    return given, (share @ (~known).astype(float) > 0) | (given <= 0)


def _unlimited(subject: Subject) -> np.ndarray:
    """Joints whose limits nobody gives `(n,)`."""
    return _given(subject)[1] | has_placeholders(subject)


@memoized
def has_placeholders(subject: Subject) -> bool:
    """Tell whether the limits of all joints that carry weight are placeholders.

    Args:
        subject: the robot.
    """
    (given, unknown), (weight, lively) = _given(subject), _needed(subject)
    loaded = (weight > lively) & ~unknown
    return bool(loaded.any() and np.all(given[loaded] > PLACEHOLDER * weight[loaded]))


@memoized
def _needed(subject: Subject) -> tuple[np.ndarray, np.ndarray]:
    """Torque for twice gravity's largest, and for a lively motion, of each joint `(n,)` [Nm]."""
    count = len(subject.joints)
    spread = np.sin(np.outer(np.arange(1, _POSTURES + 1), np.sqrt(np.arange(2, count + 2)))) * 1.5
    still = np.zeros((_POSTURES, count))
    gravity = rigid.inverse_dynamics(
        subject, subject.default + spread, still, still, _base_at_rest(subject, _POSTURES)
    )
    inertia = joint_inertia(subject) + np.diag(subject.armature)
    return 2 * np.abs(gravity).max(0), inertia * LIVELY


def _base_at_rest(subject: Subject, ticks: int) -> BaseMotion | None:
    if not subject.floating:
        return None
    zero = np.zeros((ticks, 3))
    return BaseMotion(
        zero, np.broadcast_to(np.eye(3), (ticks, 3, 3)), zero, zero, zero - subject.gravity, zero
    )
