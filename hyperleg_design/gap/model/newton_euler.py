"""Steps of the recursive Newton-Euler algorithm over a kinematic tree, one joint at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.mechanism import Mechanism
from hyperleg_design.gap.model.subject import Subject


@dataclass(frozen=True, eq=False)
class Motion:
    """Of one frame, components first: each `(3, t)`."""

    spin: np.ndarray
    angular: np.ndarray
    """Angular acceleration."""
    linear: np.ndarray
    """Acceleration of the origin minus gravity, as an accelerometer there would feel it."""


def base_start(
    subject: Subject, base: BaseMotion | None, rows: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Read the motion of the base, from which the recursion starts.

    Args:
        subject: the robot.
        base: its motion, None where it stands still.
        rows: ticks `t`.

    Returns:
        Angular velocity [rad/s], angular acceleration [rad/s^2] and acceleration minus gravity
        [m/s^2] in the base's frame, `(3, t)` each, or `(3, 1)` where the base stands still.
    """
    if base is None or not subject.floating:
        return np.zeros((3, 1)), np.zeros((3, 1)), -np.asarray(subject.gravity, float)[:, None]
    return base.angular_velocity.T, base.angular_acceleration.T, base.specific_force.T


def child_motion(
    tree: Mechanism,
    j: int,
    above: Motion,
    q: np.ndarray,
    v: np.ndarray,
    a: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
) -> Motion:
    """Compute the motion of one link from that of the link above it.

    Args:
        tree: the links.
        j: index of the joint, and of the link below it.
        above: motion of the link above.
        q: position of the joint `(t,)` [rad, m].
        v: its velocity `(t,)`.
        a: its acceleration `(t,)`.
        sin: sine of its position `(t,)`.
        cos: cosine of its position `(t,)`.

    Returns:
        The motion of the link, in its own frame.
    """
    arm = tree.offset[j]
    hinge = bool(tree.hinge[j])
    linear = above.linear
    if not hinge or np.any(arm):
        lever: np.ndarray = arm[:, None] if hinge else arm[:, None] + tree.rotation[j][:, 2:] * q
        linear = linear + cross(above.angular, lever) + cross(above.spin, cross(above.spin, lever))
    into = tree.rotation[j].T
    spin, angular, linear = into @ above.spin, into @ above.angular, into @ linear
    if hinge:
        spin, angular, linear = (
            _turned(spin, sin, cos),
            _turned(angular, sin, cos),
            _turned(linear, sin, cos),
        )
        angular[0] += spin[1] * v
        angular[1] -= spin[0] * v
        angular[2] += a
        spin[2] += v
        return Motion(spin, angular, linear)
    linear[0] += 2 * spin[1] * v
    linear[1] -= 2 * spin[0] * v
    linear[2] += a
    return Motion(spin, angular, linear)


def to_parent(
    tree: Mechanism,
    j: int,
    force: np.ndarray,
    moment: np.ndarray,
    q: np.ndarray,
    sin: np.ndarray,
    cos: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Carry a wrench on one link over to the link above it.

    Args:
        tree: the links.
        j: index of the joint, and of the link below it.
        force: on the link, in its frame `(3, t)` [N].
        moment: about its origin `(3, t)` [Nm].
        q: position of the joint `(t,)` [rad, m].
        sin: sine of its position `(t,)`.
        cos: cosine of its position `(t,)`.

    Returns:
        Force and moment about the origin of the link above, in its frame, `(3, t)` each.
    """
    if tree.hinge[j]:
        force, moment = _turned(force, -sin, cos), _turned(moment, -sin, cos)
    force, moment = tree.rotation[j] @ force, tree.rotation[j] @ moment
    lever = tree.offset[j][:, None]
    if not tree.hinge[j]:
        lever = lever + tree.rotation[j][:, 2:] * q
    return force, moment + cross(lever, force)


def _turned(x: np.ndarray, sin: np.ndarray, cos: np.ndarray) -> np.ndarray:
    """Components in a frame turned about z."""
    out = np.empty(np.broadcast_shapes(x.shape, (3, *sin.shape)))
    out[0] = cos * x[0] + sin * x[1]
    out[1] = cos * x[1] - sin * x[0]
    out[2] = x[2]
    return out


def cross(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Compute a cross product over the first axis; `np.cross` copies its arguments about.

    Args:
        x: first factor `(3, t)`.
        y: second factor `(3, t)`; either may have one column for all ticks.

    Returns:
        The products `(3, t)`.
    """
    out = np.empty((3, max(x.shape[1], y.shape[1])))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        np.multiply(x[j], y[k], out=out[i])
        out[i] -= x[k] * y[j]
    return out
