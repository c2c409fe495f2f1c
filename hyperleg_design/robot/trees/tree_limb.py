"""Where the links of one limb of a design that writes its tree out are, batched.

Frames follow URDF: a joint at `position` in its parent's frame, turned by `turn_deg` (roll, pitch,
yaw), then turned about its axis by its angle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.robot.trees.tree_design import TreeDesign

Frame = tuple[np.ndarray, np.ndarray]
"""Rotation `(..., 3, 3)` and position `(..., 3)` [m] in the root link's frame."""


def axis_rotation(axis: Any, angle: Any) -> np.ndarray:
    """Compute rotations by angles about axes (Rodrigues).

    Args:
        axis: unit vectors, `(..., 3)`.
        angle: [rad], `(...)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    axis, angle = np.asarray(axis, float), np.asarray(angle, float)[..., None, None]
    cross = skew(axis)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross))


def skew(vector: np.ndarray) -> np.ndarray:
    """Compute the matrix of a cross product.

    Args:
        vector: `(..., 3)`.

    Returns:
        `(..., 3, 3)`, such that the matrix times b is the vector times b (cross product).
    """
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    return np.stack(
        [np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2
    )


def turned(turn_deg: Any) -> np.ndarray:
    """Compute the rotation Rz Ry Rx of roll, pitch and yaw, as in URDF.

    Args:
        turn_deg: roll, pitch, yaw [deg], `(..., 3)`.

    Returns:
        Rotation matrices, `(..., 3, 3)`.
    """
    roll, pitch, yaw = np.moveaxis(np.deg2rad(np.asarray(turn_deg, float)), -1, 0)
    x, y, z = np.eye(3)
    return axis_rotation(z, yaw) @ axis_rotation(y, pitch) @ axis_rotation(x, roll)


def default_position(design: TreeDesign) -> np.ndarray:
    """Collect the default posture of one limb.

    Args:
        design: a robot or batch.

    Returns:
        Joint angles [rad], `(..., joints)`.
    """
    return of_joints(design, "default_deg") * np.pi / 180


def of_joints(design: TreeDesign, field: str) -> np.ndarray:
    """Collect a number of each joint that moves.

    Args:
        design: a robot or batch.
        field: name of the number.

    Returns:
        The numbers, `(..., joints)`.
    """
    values = [np.asarray(getattr(j, field), float) for j in design.joint_sections.values()]
    return np.stack(np.broadcast_arrays(*values), -1)


def link_frames(design: TreeDesign, position: np.ndarray | None = None) -> dict[str, Frame]:
    """Compute the frames of the root link and of the links of one unmirrored limb.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`; zero by default.

    Returns:
        Rotation and position in the root's frame, by name of the link.
    """
    moving = list(design.joint_sections)
    frames: dict[str, Frame] = {str(design.trunk.link): (np.eye(3), np.zeros(3))}
    for name, joint in design.all_joints.items():
        rotation, place = frames[joint.parent]
        own = rotation @ turned(joint.turn_deg)
        if position is not None and name in moving:
            own = own @ axis_rotation(joint.axis, position[..., moving.index(name)])
        offset = (rotation @ np.asarray(joint.position, float)[..., None])[..., 0]
        frames[joint.child] = (own, place + offset)
    return frames


def ancestors(design: TreeDesign, link: str) -> list[str]:
    """List the joints between the root link and a link.

    Args:
        design: a robot or batch.
        link: name of the link.

    Returns:
        Names of the joints, from the root.
    """
    parents = {joint.child: name for name, joint in design.all_joints.items()}
    chain: list[str] = []
    while link in parents:
        chain.append(parents[link])
        link = design.all_joints[parents[link]].parent
    return chain[::-1]


def descendants(design: TreeDesign, joint: str) -> list[str]:
    """List all links that a joint moves.

    Args:
        design: a robot or batch.
        joint: name of the joint.

    Returns:
        Names of the links.
    """
    return [
        other.child
        for other in design.all_joints.values()
        if joint in ancestors(design, other.child)
    ]


def trunk_links(design: TreeDesign) -> tuple[str, ...]:
    """List the links of the trunk: the root link, and all that fixed joints bolt to it.

    Args:
        design: a robot or batch.

    Returns:
        Names of the links, the root first.
    """
    links = [str(design.trunk.link)]
    for joint in design.all_joints.values():
        if joint.type == "fixed" and joint.parent in links:
            links.append(str(joint.child))
    return tuple(links)


def copied(copy: Any, place: np.ndarray, *, move: bool = False) -> np.ndarray:
    """Transform a place of the limb to that of a copy of the limb.

    Args:
        copy: section of the copy, which may be mirrored.
        place: in the frame of the limb [m], `(..., 3)`.
        move: whether the place is in the frame of the trunk, so that it moves with the copy.

    Returns:
        The place [m], `(..., 3)`.
    """
    mirror = np.array([1.0, -1.0 if copy.mirror else 1.0, 1.0])
    return np.asarray(place * mirror + (np.asarray(copy.position, float) if move else 0.0))


def pad_points(design: TreeDesign, position: np.ndarray | None = None) -> np.ndarray:
    """Compute the lowest points of the pads of one limb.

    Args:
        design: a robot or batch.
        position: joint angles [rad], `(..., joints)`; zero by default.

    Returns:
        The points in the frame of the root [m], `(..., pads, 3)`; `(0, 3)` without pads.
    """
    frames = link_frames(design, position)
    points = []
    for pad in design.pad_sections.values():
        rotation, place = frames[pad.link]
        centre = place + (rotation @ np.asarray(pad.position, float)[..., None])[..., 0]
        radius = pad_radius(design, pad)
        drop = np.stack(np.broadcast_arrays(0.0, 0.0, radius), -1)
        points.append(centre - drop)
    return np.stack(np.broadcast_arrays(*points), -2) if points else np.zeros((0, 3))


def pad_heights(design: TreeDesign) -> dict[str, np.ndarray]:
    """Compute how far the pads of all limbs are above the lowest of them in the default posture.

    Args:
        design: a robot or batch.

    Returns:
        Heights of the lowest points of the pads [m], `(...)`, by name of the pad, after that of its
        limb; without pads of the trunk.
    """
    points, trunk = pad_points(design, default_position(design)), trunk_links(design)
    heights = {
        prefixed(copy, name): points[..., row, 2] + np.asarray(section.position, float)[..., 2]
        for copy, section in design.copy_sections.items()
        for row, (name, pad) in enumerate(design.pad_sections.items())
        if pad.link not in trunk
    }
    if not heights:
        return {}
    lowest = np.min(np.stack(np.broadcast_arrays(*heights.values())), 0)
    return {name: height - lowest for name, height in heights.items()}


def pad_radius(design: TreeDesign, pad: Any) -> Any:
    """Look up the radius of a pad; by default that of the design's contact.

    Args:
        design: a robot or batch.
        pad: section of the pad.

    Returns:
        The radius [m], `(...)`.
    """
    return np.where(np.asarray(pad.radius) > 0, pad.radius, design.contact.pad_radius)


def standing_height(design: TreeDesign, position: np.ndarray | None = None) -> np.ndarray:
    """Compute the height of the root link's origin above the floor where the lowest pad stands on
    it.

    Args:
        design: a robot or batch.
        position: joint angles of each limb [rad], `(..., joints)`; zero by default.

    Returns:
        The height [m], `(...)`.
    """
    if design.trunk.motion == "fixed" or not design.pad_sections:
        return np.asarray(design.trunk.height, float)
    drop = -pad_points(design, position)[..., 2].min(-1)
    lowest = [
        -np.asarray(copy.position, float)[..., 2] + drop for copy in design.copy_sections.values()
    ]
    return np.asarray(np.max(np.stack(np.broadcast_arrays(*lowest)), 0))
