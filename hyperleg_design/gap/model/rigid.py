"""Rigid-body dynamics of many ticks at once: torques that a motion needs, and how they depend on
each link's mass.

Recursive Newton-Euler over the tree of `mechanism.Mechanism`, every joint once and all ticks
together, in the joints' own frames, z along the axis (Featherstone, Rigid Body Dynamics Algorithms,
2008, Table 5.1). A uniform velocity of the whole robot changes no torque, so a floating base enters
by its angular velocity, angular acceleration and specific force alone, which is what an inertial
sensor measures. Rotors of coupled motors add `armature` times acceleration, as M diag(J) M^T does
not depend on posture here.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.recursion import torques
from hyperleg_design.gap.model.subject import Subject

BLOCK = 4096
"""Ticks worked on together, so that they stay in the processor's cache."""


def inverse_dynamics(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None = None,
    *,
    rotors: bool = True,
    joints: Sequence[int] | None = None,
) -> np.ndarray:
    """Joint torques that a motion needs, without friction, springs or contact [Nm].

    Args:
        subject: robot with n joints.
        position: `(..., t, n)` [rad].
        velocity: the same [rad/s].
        acceleration: the same [rad/s^2].
        base: of a floating base, of t ticks; at rest by default.
        rotors: add the rotors' inertia.
        joints: whose torques are computed, whole limbs as of `Mechanism.limbs`; all by default.

    Returns:
        `(..., t, n)`, or `(..., t, len(joints))`.
    """
    return _dynamics(subject, position, velocity, acceleration, base, rotors, joints)[0]


def accelerating(
    subject: Subject,
    position: np.ndarray,
    accelerations: Iterable[np.ndarray],
    *,
    rotors: bool = True,
) -> list[np.ndarray]:
    """Compute the torque that each of some accelerations takes of a robot at rest, beyond its
    weight.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        accelerations: [rad/s^2], `(t, n)` or `(n,)` each.
        rotors: whether rotor inertia counts.

    Returns:
        The torques [Nm], `(t, n)` each; see `inverse_dynamics`.
    """
    rest = np.zeros_like(position)
    weight = inverse_dynamics(subject, position, rest, rest, rotors=rotors)
    return [
        inverse_dynamics(subject, position, rest, rest + acceleration, rotors=rotors) - weight
        for acceleration in accelerations
    ]


def base_wrench(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion,
) -> np.ndarray:
    """Compute the force and moment that a floating base needs from outside, about its origin and in
    its frame.

    A rotor's own spin pushes back on the base in nature; like MuJoCo's armature, this leaves it
    out.

    Args:
        subject: the robot.
        position: as in `inverse_dynamics`.
        velocity: as in `inverse_dynamics`.
        acceleration: as in `inverse_dynamics`.
        base: motion of the base.

    Returns:
        The wrench [N, Nm], `(..., t, 6)`.
    """
    return _dynamics(subject, position, velocity, acceleration, base, False)[1]


def base_start(subject: Subject, base: BaseMotion | None, rows: int) -> np.ndarray:
    """Read the motion of the base, from which the recursion starts.

    Args:
        subject: the robot.
        base: its motion, None where it stands still.
        rows: ticks `t`.

    Returns:
        Angular velocity [rad/s], angular acceleration [rad/s^2] and acceleration minus gravity
        [m/s^2] in the base's frame `(9, t)`.
    """
    if base is None or not subject.floating:
        return np.tile(np.concatenate([np.zeros(6), -subject.gravity])[:, None], rows)
    return np.concatenate(
        [base.angular_velocity.T, base.angular_acceleration.T, base.specific_force.T]
    )


def _dynamics(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None,
    rotors: bool,
    joints: Sequence[int] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    tree = subject.tree
    own = range(tree.count) if joints is None else joints
    position, velocity, acceleration = np.broadcast_arrays(position, velocity, acceleration)
    shape = position.shape
    q, v, a = (
        x.reshape(-1, shape[-1]).T for x in (position - tree.reference, velocity, acceleration)
    )
    ticks, rows = q.shape[1], shape[-2] if len(shape) > 1 else 1
    torque, wrench = np.empty((ticks, len(own))), np.empty((ticks, 6))
    start = base_start(subject, base, rows)
    for first in range(0, ticks, BLOCK):
        part = slice(first, min(first + BLOCK, ticks))
        index = np.arange(part.start, part.stop) % rows
        torque[part], wrench[part] = torques(
            tree,
            np.ascontiguousarray(q[:, part]),
            np.ascontiguousarray(v[:, part]),
            np.ascontiguousarray(a[:, part]),
            start[:, index],
            own,
        )
    if rotors:
        torque += a.T @ subject.armature[own].T
    return torque.reshape(*shape[:-1], len(own)), wrench.reshape(*shape[:-1], 6)
