"""Where the links of a robot are in a posture; enough for pictures, without a dynamics library."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hyperleg_design.robot.kinematics.kinematic_tree import Tree, TreeJoint

Pose = tuple[np.ndarray, np.ndarray]
"""Rotation `(3, 3)` and position `(3,)` [m] in the base's frame."""


def axis_rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Compute the rotation by an angle about an axis (Rodrigues).

    Args:
        axis: unit vector, `(3,)`.
        angle: [rad].

    Returns:
        The rotation matrix, `(3, 3)`.
    """
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def link_poses(tree: Tree, angles: Mapping[str, float] | None = None) -> dict[str, Pose]:
    """Compute the pose of every link in the frame of the base.

    Args:
        tree: the robot.
        angles: joint angles [rad] by joint name; zero where not named.

    Returns:
        Rotation `(3, 3)` and position `(3,)` [m] of each link, by name.

    Raises:
        KeyError: an angle for a joint that the tree does not move.
    """
    angles = dict(angles or {})
    unknown = set(angles) - {j.name for j in tree.moving}
    if unknown:
        raise KeyError(f"no moving joint {sorted(unknown)[0]!r}")
    poses: dict[str, Pose] = {tree.base: (np.eye(3), np.zeros(3))}
    for joint in tree.joints:
        rotation, position = poses[joint.parent]
        if any(joint.turn):
            poses[joint.child] = _turned(joint, rotation, position, angles.get(joint.name, 0.0))
            continue
        turn = axis_rotation(np.array(joint.axis), angles.get(joint.name, 0.0))
        poses[joint.child] = (rotation @ turn, position + rotation @ np.array(joint.position))
    return poses


def _turned(joint: TreeJoint, rotation: np.ndarray, position: np.ndarray, angle: float) -> Pose:
    """Pose behind a joint whose frame is turned in its parent's."""
    roll, pitch, yaw = joint.turn
    x, y, z = np.eye(3)
    turn = axis_rotation(z, yaw) @ axis_rotation(y, pitch) @ axis_rotation(x, roll)
    own = rotation @ turn @ axis_rotation(np.array(joint.axis), angle)
    return own, position + rotation @ np.array(joint.position)


def default_angles(tree: Tree) -> dict[str, float]:
    """Collect the angles of the default posture.

    Args:
        tree: the robot.

    Returns:
        Angles [rad] by joint name.
    """
    return {joint.name: joint.default for joint in tree.moving}


def lowest_point(tree: Tree, poses: Mapping[str, Pose]) -> float:
    """Find the height of the lowest pad.

    Args:
        tree: the robot.
        poses: of all links, in the frame of the base.

    Returns:
        The height in the frame of the base [m]; without pads, that of the lowest link's origin.
    """
    heights = [
        float((poses[link.name][0] @ np.array(pad.position) + poses[link.name][1])[2]) - pad.size[0]
        for link in tree.links
        for pad in link.pads
    ]
    return min(heights or [float(position[2]) for _, position in poses.values()])
