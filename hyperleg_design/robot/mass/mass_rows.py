"""The mass table of a robot: links, the segments that the paper prints, a leg, the whole robot."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot.kinematics.kinematic_tree import Link, Tree, mass_of
from hyperleg_design.robot.kinematics.posture import Pose, link_poses
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

SEGMENT_LINKS = {
    "pelvis": ("pelvis",),
    "thigh": ("left_hip_yaw_carrier", "left_hip_roll_carrier", "left_thigh"),
    "shank": ("left_shank",),
    "foot": ("left_ankle_cross", "left_foot"),
    "toe": ("left_toe_plate",),
}
"""Links that each printed segment is made of; the left leg's, and the right mirrors it."""


@dataclass(frozen=True, eq=False)
class MassRow:
    """Mass, centre of mass and inertia of one part, as one row of the mass table."""

    kind: str
    """`segment`, `link`, `leg` (`limb` of a tree that is written out) or `robot`."""
    name: str
    count: int
    """How many of it the robot has."""
    mass: float
    """Mass of a single part of this kind [kg]."""
    com: np.ndarray
    """Centre of mass [m] `(3,)`: of a link or segment from its upper joint, of leg and robot from
    the pelvis's origin."""
    principal: np.ndarray
    """Principal moments of inertia about the centre of mass, smallest first [kg m^2] `(3,)`."""


def mass_rows(design: RobotDesign) -> list[MassRow]:
    """Compute the rows of the mass table.

    Args:
        design: one robot.

    Returns:
        Rows of segments, leg and robot in the zero posture, then of links.

    Raises:
        InputError: a batch of designs.
    """
    tree = build_tree(design)
    poses = link_poses(tree)
    first, copies = design.copies[0], len(design.copies)
    start = f"{first}_" if first else ""
    links = [link for link in tree.links if link.name != tree.base and link.name.startswith(start)]
    bolted = _bolted(tree)
    limb = [link for link in links if link.name not in bolted]

    def row(kind: str, name: str, count: int, parts: Iterable[Link], origin: np.ndarray) -> MassRow:
        return MassRow(kind, name, count, *_together([(k, poses[k.name]) for k in parts], origin))

    rows = [
        row(
            "segment",
            name,
            1 if name == "pelvis" else 2,
            [tree.link(n) for n in names],
            poses[names[0]][1],
        )
        for name, names in ({} if isinstance(design, TreeDesign) else SEGMENT_LINKS).items()
    ]
    kind = "limb" if isinstance(design, TreeDesign) else "leg"
    rows.append(row(kind, kind, copies, limb, np.zeros(3)))
    rows.append(row("robot", "robot", 1, tree.links, np.zeros(3)))
    for link in [tree.link(tree.base), *links]:
        count = 1 if link.name == tree.base else copies
        name = link.name if link.name == tree.base else link.name.removeprefix(start)
        rows.append(row("link", name, count, [link], poses[link.name][1]))
    return rows


def _bolted(tree: Tree) -> set[str]:
    """Names of the base and of the links that fixed joints bolt to it."""
    names = {tree.base}
    for joint in tree.joints:
        if joint.fixed and joint.parent in names:
            names.add(joint.child)
    return names


def _together(
    parts: list[tuple[Link, Pose]], origin: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass from an origin and principal moments of links at their poses."""
    mass = mass_of(link for link, _ in parts)
    if mass == 0:
        return 0.0, np.zeros(3), np.zeros(3)
    places = [(place - origin) + rotation @ link.com for link, (rotation, place) in parts]
    com = (
        sum((k.mass * at for (k, _), at in zip(parts, places, strict=True)), start=np.zeros(3))
        / mass
    )
    inertia = np.zeros((3, 3))
    for (link, (rotation, _)), at in zip(parts, places, strict=True):
        arm = at - com
        inertia += rotation @ link.inertia @ rotation.T + link.mass * (
            arm @ arm * np.eye(3) - np.outer(arm, arm)
        )
    return mass, com, np.linalg.eigvalsh(inertia)
