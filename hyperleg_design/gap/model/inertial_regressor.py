"""How the torques that a motion needs depend on the inertial parameters of the links."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.recursion import (
    fixed_motion,
    fixed_wrench,
    frame_motions,
    inertial_wrench,
    on_parent,
    with_products,
)
from hyperleg_design.gap.model.rigid import base_start
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
    ticks, columns = q.shape[1], 10
    sin, cos = np.sin(q), np.cos(q)
    motion = frame_motions(tree, q, v, a, sin, cos, base_start(subject, base, ticks), chain)
    pose = tree.link_rotation[place], tree.link_offset[place]
    own = with_products(fixed_motion(*pose) @ motion[int(tree.link_joint[place])])
    units = np.stack([inertial_wrench(unit) for unit in np.eye(columns)], 1)
    # ten wrenches, each carried down the chain like any other
    wrench = fixed_wrench(*pose) @ (units @ own).reshape(6, -1)
    torque = np.zeros((ticks, tree.count, columns))
    for j in reversed(chain):
        torque[:, j] = wrench[5 if tree.hinge[j] else 2].reshape(columns, ticks).T
        turned = (np.tile(x, columns) for x in (q[j], sin[j], cos[j]))
        wrench = on_parent(tree, j, wrench, *turned)
    return torque, wrench.reshape(6, columns, ticks).transpose(2, 0, 1)
