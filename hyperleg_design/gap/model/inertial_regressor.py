"""How the torques that a motion needs depend on the inertial parameters of the links."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.newton_euler import (
    Motion,
    base_start,
    child_motion,
    cross,
    to_parent,
)
from hyperleg_design.gap.model.subject import Subject


def regressors(
    subject: Subject,
    position: np.ndarray,
    velocity: np.ndarray,
    acceleration: np.ndarray,
    base: BaseMotion | None,
    link: str,
) -> tuple[np.ndarray, np.ndarray]:
    """Compute joint torques and the base's wrench over the ten inertial parameters of one link.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        velocity: [rad/s], `(t, n)`.
        acceleration: [rad/s^2], `(t, n)`.
        base: motion of a floating base; None for a fixed one.
        link: name of the link.

    Returns:
        Torques `(t, n, 10)` and wrench `(t, 6, 10)`, each per unit of the parameters.
    """
    tree = subject.tree
    place = tree.link(link)
    chain = tree.chain(int(tree.link_joint[place]))
    q, v, a = (
        np.ascontiguousarray(x.T) for x in (position - tree.reference, velocity, acceleration)
    )
    ticks = q.shape[1]
    motion = Motion(*(np.broadcast_to(x, (3, ticks)) for x in base_start(subject, base, ticks)))
    sin, cos = np.sin(q), np.cos(q)
    for j in chain:
        motion = child_motion(tree, j, motion, q[j], v[j], a[j], sin[j], cos[j])
    arm, into = tree.link_offset[place][:, None], tree.link_rotation[place].T
    linear = (
        motion.linear + cross(motion.angular, arm) + cross(motion.spin, cross(motion.spin, arm))
    )
    block = _body_regressor(Motion(into @ motion.spin, into @ motion.angular, into @ linear))
    columns = block.shape[1]
    # Ten wrenches, each carried down the chain like any other.
    force, moment = block[:3].reshape(3, -1), block[3:].reshape(3, -1)
    force, moment = into.T @ force, into.T @ moment
    moment = moment + cross(arm, force)
    torque = np.zeros((ticks, tree.count, columns))
    for j in reversed(chain):
        own = moment if tree.hinge[j] else force
        torque[:, j] = own[2].reshape(columns, ticks).T
        force, moment = to_parent(
            tree,
            j,
            force,
            moment,
            np.tile(q[j], columns),
            np.tile(sin[j], columns),
            np.tile(cos[j], columns),
        )
    return torque, np.concatenate([force, moment]).reshape(6, columns, ticks).transpose(2, 0, 1)


def _body_regressor(motion: Motion) -> np.ndarray:
    """Force and moment over the ten parameters of a body in its own frame `(6, 10, t)`."""
    spin, angular, linear = motion.spin, motion.angular, motion.linear
    block = np.zeros((6, 10, linear.shape[1]))
    block[:3, 0] = linear
    for column, axis in enumerate(np.eye(3)):
        first = axis[:, None]
        block[:3, 1 + column] = cross(angular, first) + cross(spin, cross(spin, first))
        block[3:, 1 + column] = cross(first, linear)
    for column, (i, j) in enumerate(((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))):
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        block[3:, 4 + column] = unit @ angular + cross(spin, unit @ spin)
    return block
