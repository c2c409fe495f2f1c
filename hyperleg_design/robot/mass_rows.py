"""The mass table of a robot: links, the segments that the paper prints, a leg, the whole robot."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot.posture import link_poses
from hyperleg_design.robot.tree import Link, build_tree

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

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
    """Inertial of one part."""

    kind: str
    """`segment`, `link`, `leg` or `robot`."""
    name: str
    count: int
    """How many of it the robot has; the right leg's mirror the left's."""
    mass: float
    """Of one [kg]."""
    com: np.ndarray
    """Centre of mass [m] `(3,)`: of a link or segment from its upper joint, of leg and robot from
    the pelvis's origin."""
    principal: np.ndarray
    """Principal moments of inertia about the centre of mass, smallest first [kg m^2] `(3,)`."""


def mass_rows(design: Design) -> list[MassRow]:
    """Rows of the mass table: segments, leg and robot in the zero posture, then links.

    Raises:
        InputError: a batch of designs.
    """
    tree = build_tree(design)
    places = {
        name: position for name, (_, position) in link_poses(tree).items()
    }  # frames are parallel in the zero posture
    left = [link for link in tree.links if link.name.startswith("left_")]

    def row(kind: str, name: str, count: int, links: Iterable[Link], origin: np.ndarray) -> MassRow:
        return MassRow(
            kind, name, count, *_together([(link, places[link.name] - origin) for link in links])
        )

    rows = [
        row(
            "segment",
            name,
            1 if name == "pelvis" else 2,
            [tree.link(n) for n in links],
            places[links[0]],
        )
        for name, links in SEGMENT_LINKS.items()
    ]
    rows.append(row("leg", "leg", 2, left, np.zeros(3)))
    rows.append(row("robot", "robot", 1, tree.links, np.zeros(3)))
    for link in [tree.link("pelvis"), *left]:
        count = 1 if link.name == "pelvis" else 2
        rows.append(row("link", link.name.removeprefix("left_"), count, [link], places[link.name]))
    return rows


def _together(parts: list[tuple[Link, np.ndarray]]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, centre of mass and principal moments of links at offsets, frames parallel."""
    mass = sum(link.mass for link, _ in parts)
    if mass == 0:
        return 0.0, np.zeros(3), np.zeros(3)
    com = sum((link.mass * (offset + link.com) for link, offset in parts), start=np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for link, offset in parts:
        arm = offset + link.com - com
        inertia += link.inertia + link.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, com, np.linalg.eigvalsh(inertia)
