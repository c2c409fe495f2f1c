"""Pads on which a robot stands: their points, their rolling, and torques of forces on them."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.frames import joint_frames, link_poses
from hyperleg_design.gap.model.mechanism import Mechanism
from hyperleg_design.gap.model.subject import Subject


def contact_torque(
    subject: Subject,
    position: np.ndarray,
    rotation: np.ndarray | None,
    force: np.ndarray,
    lift: np.ndarray | float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """What forces of the ground do at the joints and at the base.

    Args:
        subject: the robot, with P pads.
        position: `(t, n)` [rad].
        rotation: world from base `(t, 3, 3)`; none of a fixed base.
        force: on each pad, in the world `(t, P, 3)` [N]; it acts where the pad's sphere is lowest,
        lift: or so far above that, `()` or `(t, P)` [m].

    Returns:
        Generalised torque J^T f `(t, n)` [Nm], and force and moment on the base in its own frame
        `(t, 6)`.
    """
    tree = subject.tree
    rotation = np.broadcast_to(np.eye(3), (len(position), 3, 3)) if rotation is None else rotation
    into = np.swapaxes(rotation, -1, -2)
    local = np.einsum("tij,tpj->tpi", into, force)
    points = (
        pad_points(subject, position, rotation)
        + np.asarray(lift)[..., None] * rotation[:, None, 2, :]
    )
    frames = joint_frames(tree, position)
    torque = np.zeros((len(position), tree.count))
    for row, pad in enumerate(subject.pads):
        for j in tree.chain_to(pad.link):
            lever = joint_lever(tree, frames, j, points[:, row])
            torque[:, j] += np.einsum("ti,ti->t", lever, local[:, row])
    moment = np.cross(points, local).sum(1)
    return torque, np.concatenate([local.sum(1), moment], -1)


def joint_lever(
    tree: Mechanism, frames: list[tuple[np.ndarray, np.ndarray]], joint: int, point: np.ndarray
) -> np.ndarray:
    """Compute the torque at a joint of unit forces at a point beyond it.

    Args:
        tree: the robot.
        frames: of its joints, `joint_frames`.
        joint: index of the joint.
        point: in the base's frame `(t, 3)` [m].

    Returns:
        Along each axis of the base `(t, 3)` [m]; of a joint that slides, its axis [-].
    """
    axes, origin = frames[joint]
    return np.cross(axes[..., 2], point - origin) if tree.hinge[joint] else axes[..., 2]


def pad_points(subject: Subject, position: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Compute the lowest point of each pad.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.
        rotation: world from base, `(t, 3, 3)`.

    Returns:
        The points in the base's frame [m], `(t, P, 3)`.
    """
    axes, origins = link_poses(subject, position, np.array([p.link for p in subject.pads], int))
    centre = origins + np.einsum("tpij,pj->tpi", axes, np.array([p.position for p in subject.pads]))
    return centre - np.array([p.radius for p in subject.pads])[:, None] * rotation[:, None, 2, :]


def pad_rolling(
    subject: Subject, position: np.ndarray, rotation: np.ndarray, step: float
) -> np.ndarray:
    """Compute the velocity of each pad's lowest point relative to its centre: a pad that rolls does
    not slide.

    Args:
        subject: the robot.
        position: of the joints `(t, n)` [rad].
        rotation: world from base `(t, 3, 3)`.
        step: between ticks [s].

    Returns:
        The velocity in the world's frame [m/s], `(t, P, 3)`.
    """
    axes = (
        rotation[:, None]
        @ link_poses(subject, position, np.array([p.link for p in subject.pads], int))[0]
    )
    down = np.array([0.0, 0.0, -1.0]) * np.array([p.radius for p in subject.pads])[:, None]
    return np.einsum("tpij,tpkj,pk->tpi", np.gradient(axes, step, axis=0), axes, down)
