"""Which joints and links of a robot are mirror images of each other in the plane y = 0.

Links are matched from the base outward in the zero posture. Joints j and k, hanging from links that
are images of each other, are images if their places are, `p_k = (x, -y, z)_j`, and so are their
axes, which are pseudovectors, `a_k = s (-x, y, -z)_j` with a sign s of plus or minus one. Then an
angle q of j has the mirror image s q of k. HyperLeg's right axes mirror its left ones, so all of
its signs are 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot.kinematics.posture import Pose, link_poses

if TYPE_CHECKING:
    from hyperleg_design.robot.kinematics.kinematic_tree import Tree, TreeJoint

PLACE = 2e-3
"""How far from its mirror image a joint may stand [m]; CAD models are not exact."""
AXIS = 1e-2
"""How far an axis may lie from its mirror image [-]."""
ANGLE = 1e-3
"""How far default angles may differ from their mirror images [rad]."""
_PLACES = np.array([1.0, -1.0, 1.0])


def mirrored_joints(tree: Tree) -> tuple[tuple[int, float], ...] | None:
    """Place among the moving joints and sign of each one's mirror image.

    Args:
        tree: the robot.

    Returns:
        `(place, sign)` of each moving joint, `(J,)`; None where the robot or its default posture is
        not symmetric.
    """
    images = _images(tree)
    if images is None:
        return None
    order = {joint.name: index for index, joint in enumerate(tree.moving)}
    mirrored = []
    for joint in tree.moving:
        other, sign = images[joint.name]
        if abs(other.default - sign * joint.default) > ANGLE:
            return None
        mirrored.append((order[other.name], sign))
    return tuple(mirrored)


def mirrored_order(tree: Tree, links: Sequence[str]) -> tuple[int, ...] | None:
    """Find the mirror image of each link among given ones.

    Args:
        tree: the robot.
        links: names of links.

    Returns:
        Index of each link's mirror image; None where one has none.
    """
    images = _images(tree)
    if images is None:
        return None
    of_link = {tree.base: tree.base} | {
        joint.child: images[joint.name][0].child for joint in tree.joints if joint.name in images
    }
    places = [of_link.get(link) for link in links]
    if not set(places) <= set(links):
        return None
    return tuple(list(links).index(place) for place in places if place is not None)


def _images(tree: Tree) -> dict[str, tuple[TreeJoint, float]] | None:
    """Mirror image and sign of the joints by name; None where one that moves has none.

    Links that are fixed to others need no image: sensors are often on one side only.
    """
    poses = link_poses(tree)
    image_of = {tree.base: tree.base}
    images: dict[str, tuple[TreeJoint, float]] = {}
    taken: set[str] = set()
    for joint in tree.joints:
        for other in tree.joints:
            hangs = other.parent == image_of.get(joint.parent) and other.fixed == joint.fixed
            if other.name in taken or not hangs:
                continue
            sign = _sign(joint, other, poses)
            if sign:
                images[joint.name] = (other, sign)
                image_of[joint.child] = other.child
                taken.add(other.name)
                break
        else:
            if not joint.fixed:
                return None
    return images


def _sign(joint: TreeJoint, other: TreeJoint, poses: dict[str, Pose]) -> float:
    """Plus or minus one where a joint is another one's mirror image; zero where it is not."""
    (turn, place), (other_turn, other_place) = poses[joint.child], poses[other.child]
    if np.linalg.norm(place * _PLACES - other_place) > PLACE:
        return 0.0
    if joint.fixed:
        return 1.0
    image, axis = -_PLACES * (turn @ np.array(joint.axis)), other_turn @ np.array(other.axis)
    for sign in (1.0, -1.0):
        if np.linalg.norm(image - sign * axis) < AXIS:
            return sign
    return 0.0
