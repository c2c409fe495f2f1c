"""Sole pads of a robot as points that can push on the floor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.robot.kinematics.tree import Tree

if TYPE_CHECKING:
    from hyperleg_design.robot.models import RigidBodyModel

HEEL, BALL, TIP = "heel", "ball", "tip"
"""Rows of pads under a foot, from behind; the tip's are on the toe plate."""


@dataclass(frozen=True)
class Pad:
    """One spherical contact pad of a foot."""

    name: str
    """`left_heel_0` and the like."""
    side: str
    row: str
    """`heel`, `ball` or `tip`."""
    link: str
    position: tuple[float, float, float]
    """Position of the pad's centre in the link's frame [m]."""
    radius: float
    """Radius [m]."""


def sole_pads(tree: Tree) -> tuple[Pad, ...]:
    """List the pads of all feet.

    Args:
        tree: the robot.

    Returns:
        Pads of the left foot, heel, ball, tip, then of the right; two in each row. For other
        robots, limb by limb.
    """
    pads = []
    if not tree.hyperleg:
        return _limb_pads(tree)
    for link in tree.links:
        side = link.name.split("_")[0]
        for index, shape in enumerate(link.pads):
            row = TIP if link.name.endswith("toe_plate") else (HEEL, BALL)[index // 2]
            pads.append(
                Pad(
                    f"{side}_{row}_{index % 2}", side, row, link.name, shape.position, shape.size[0]
                )
            )
    return tuple(pads)


def _limb_pads(tree: Tree) -> tuple[Pad, ...]:
    """Pads of a tree that is written out, limb by limb; those of the root link belong to none."""
    pads = []
    for link in tree.links:
        limb = next((n for n in tree.limbs if n and link.name.startswith(f"{n}_")), tree.limbs[0])
        for index, shape in enumerate(link.pads):
            pads.append(
                Pad(
                    f"{link.name}_{index}",
                    "" if link.name == tree.base else limb,
                    "",
                    link.name,
                    shape.position,
                    shape.size[0],
                )
            )
    return tuple(pads)


def contact_points(model: RigidBodyModel, q: np.ndarray) -> np.ndarray:
    """Compute the lowest point of each pad; on level floor, a sphere touches there.

    Args:
        model: rigid-body model of the robot.
        q: configuration, `(nq,)`.

    Returns:
        The points in the world [m], `(pads, 3)`.
    """
    points, _ = contact_kinematics(model, q)
    return points


def contact_kinematics(model: RigidBodyModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest points of the pads and their Jacobians.

    Args:
        model: floating or fixed robot.
        q: its configuration, `(nq,)`.

    Returns:
        Points in the world [m], `(pads, 3)`, and the velocity of the body's material there over
        `v`, world axes, `(pads, 3, nv)`.
    """
    import pinocchio as pin

    pin.computeJointJacobians(model.model, model.data, q)
    pin.updateFramePlacements(model.model, model.data)
    pads = sole_pads(model.tree)
    points, jacobians = np.zeros((len(pads), 3)), np.zeros((len(pads), 3, model.model.nv))
    link = ""
    rotation, origin, twist = np.eye(3), np.zeros(3), np.zeros((6, model.model.nv))
    for index, pad in enumerate(pads):
        if pad.link != link:
            link = pad.link
            frame = model.model.getFrameId(link)
            place = model.data.oMf[frame]
            rotation, origin = np.array(place.rotation), np.array(place.translation)
            twist = np.array(
                pin.getFrameJacobian(model.model, model.data, frame, pin.LOCAL_WORLD_ALIGNED)
            )
        offset = rotation @ np.array(pad.position) - np.array([0.0, 0.0, pad.radius])
        points[index] = origin + offset
        jacobians[index] = twist[:3] + np.cross(twist[3:].T, offset).T  # v + w x r
    return points, jacobians
