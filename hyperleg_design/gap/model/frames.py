"""Where the links and joints of a robot are, for many ticks at once."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.mechanism import BASE, Mechanism
from hyperleg_design.gap.model.subject import Subject


def link_poses(
    subject: Subject, position: np.ndarray, links: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Where links stand in the base's frame (the world's, of a fixed base).

    Args:
        subject: the robot.
        position: `(t, n)` [rad].
        links: places among `subject.links` `(k,)`.

    Returns:
        Axes `(t, k, 3, 3)` and origins `(t, k, 3)` [m].
    """
    tree = subject.tree
    frames = joint_frames(tree, position)
    ticks = len(position)
    axes, origins = np.empty((ticks, len(links), 3, 3)), np.empty((ticks, len(links), 3))
    for row, link in enumerate(links):
        carrier = int(tree.link_joint[link])
        rotation, origin = (
            (np.eye(3)[None], np.zeros((1, 3))) if carrier == BASE else frames[carrier]
        )
        axes[:, row] = rotation @ tree.link_rotation[link]
        origins[:, row] = origin + rotation @ tree.link_offset[link]
    return axes, origins


def joint_frames(tree: Mechanism, position: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Compute the frames of all joints in the base's frame.

    Args:
        tree: the robot.
        position: [rad], `(t, n)`.

    Returns:
        Axes `(t, 3, 3)` and origin `(t, 3)` [m] of each joint's frame.
    """
    frames: list[tuple[np.ndarray, np.ndarray]] = []
    angle = position - tree.reference
    for j in range(tree.count):
        above, origin = (
            (np.eye(3)[None], np.zeros((1, 3)))
            if tree.parent[j] == BASE
            else frames[tree.parent[j]]
        )
        axes, origin = above @ tree.rotation[j], origin + above @ tree.offset[j]
        if tree.hinge[j]:
            sin, cos = np.sin(angle[:, j])[:, None], np.cos(angle[:, j])[:, None]
            axes = np.stack(
                [
                    axes[..., 0] * cos + axes[..., 1] * sin,
                    axes[..., 1] * cos - axes[..., 0] * sin,
                    np.broadcast_to(axes[..., 2], (len(angle), 3)),
                ],
                -1,
            )
        else:
            axes, origin = (
                np.broadcast_to(axes, (len(angle), 3, 3)),
                origin + axes[..., 2] * angle[:, j, None],
            )
        frames.append((axes, np.broadcast_to(origin, (len(angle), 3))))
    return frames
