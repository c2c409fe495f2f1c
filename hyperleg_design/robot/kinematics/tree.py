"""The kinematic tree of one robot: the single source of URDF, Pinocchio and MuJoCo models, and of
pictures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.kinematic_tree import Link, Shape, Tree, TreeJoint
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.mass.inertials import LEG_LINKS, inertials
from hyperleg_design.robot.names import JOINTS, SIDES
from hyperleg_design.robot.trees.tree_build import tree_of
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

__all__ = ["SIGN", "Link", "Shape", "Tree", "TreeJoint", "build_tree"]

SIGN = {"left": 1.0, "right": -1.0}


def build_tree(design: RobotDesign) -> Tree:
    """Build the kinematic tree of one robot.

    Args:
        design: one robot, of any family.

    Returns:
        The tree.

    Raises:
        InputError: a batch of designs.
    """
    if design.batch_shape:
        raise InputError(
            design.name, "", None, "holds a batch of designs; take one of them for a model"
        )
    if isinstance(design, TreeDesign):
        return tree_of(design)
    return _hyperleg(cast("Design", design))


def _hyperleg(design: Design) -> Tree:
    """The tree of a pelvis and two mirrored legs."""
    links: list[Link] = []
    joints: list[TreeJoint] = []
    actuation = _actuation(design)
    for side in SIDES:
        sign = SIGN[side]
        links_of_leg = inertials(design, sign)
        if side == "left":
            body = links_of_leg["pelvis"]
            links.append(
                Link("pelvis", float(body.mass), body.com, body.inertia, _visuals(design, "pelvis"))
            )
        for name in LEG_LINKS:
            body = links_of_leg[name]
            links.append(
                Link(
                    f"{side}_{name}",
                    float(body.mass),
                    body.com,
                    body.inertia,
                    _visuals(design, name),
                    _pads(design, name),
                )
            )
        joints += _leg_joints(design, side, sign, actuation)
    return Tree(design.name, tuple(links), tuple(joints))


def _actuation(design: Design) -> tuple[np.ndarray, ...]:
    """Coulomb friction [Nm], viscous friction [Nms/rad], largest torque [Nm] and speed [rad/s] of
    the joints of a leg, each `(7,)`.
    """
    posture = str(design.transmission.posture)
    return (
        *joint_friction(design),
        transmission.max_joint_torque(design, posture),
        transmission.single_joint_speed(design, posture),
    )


def _leg_joints(
    design: Design, side: str, sign: float, actuation: tuple[np.ndarray, ...]
) -> list[TreeJoint]:
    """The joints of one leg; `actuation` is that of either leg (`_actuation`)."""
    moving = transmission.joint_names(design)
    coulomb, viscous, effort, speed = actuation
    positions = {
        "hip_yaw": (0.0, sign * design.hip.spacing / 2, 0.0),
        "knee": (0.0, 0.0, -design.thigh.length),
        "ankle_pitch": (0.0, 0.0, -design.shank.length),
        "toe": (design.foot.ball_length, 0.0, -(design.foot.ankle_height - design.toe.axis_height)),
    }
    axes = {
        "hip_yaw": (0.0, 0.0, -sign),
        "hip_roll": (sign, 0.0, 0.0),
        "ankle_roll": (sign, 0.0, 0.0),
    }
    joints = []
    parent = "pelvis"
    for index, (name, child) in enumerate(zip(JOINTS, LEG_LINKS, strict=True)):
        joint: Any = getattr(design.joints, name)
        fixed = name not in moving
        still = fixed or not np.isfinite(speed[index])  # no motor moves a passive toe
        joints.append(
            TreeJoint(
                name=f"{side}_{name}",
                parent=parent,
                child=f"{side}_{child}",
                position=positions.get(name, (0.0, 0.0, 0.0)),
                axis=axes.get(name, (0.0, 1.0, 0.0)),
                fixed=fixed,
                lower=float(np.deg2rad(joint.lower_deg)),
                upper=float(np.deg2rad(joint.upper_deg)),
                effort=0.0 if still else float(effort[index]),
                velocity=0.0 if still else float(speed[index]),
                coulomb=float(coulomb[index]),
                viscous=float(viscous[index]),
                default=float(np.deg2rad(joint.default_deg)),
            )
        )
        parent = f"{side}_{child}"
    return joints


def _visuals(design: Design, link: str) -> tuple[Shape, ...]:
    if link == "pelvis":
        size = (design.pelvis.depth, design.pelvis.width, design.pelvis.height)
        return (Shape("box", size, (0.0, 0.0, design.pelvis.height / 2)),)
    if link in ("thigh", "shank"):
        part = getattr(design, link)
        tube = Shape("cylinder", (part.radius, part.length), (0.0, 0.0, -part.length / 2))
        return (tube, Shape("sphere", (part.radius,), (0.0, 0.0, 0.0)))
    if link == "hip_roll_carrier":
        return (Shape("sphere", (design.thigh.radius * 1.1,), (0.0, 0.0, 0.0)),)
    if link == "ankle_cross":
        return (Shape("sphere", (design.shank.radius * 0.9,), (0.0, 0.0, 0.0)),)
    if link == "foot":
        foot, thick = design.foot, design.toe.axis_height * 1.6
        length = foot.heel_length + foot.ball_length
        return (
            Shape(
                "box",
                (length, foot.width, thick),
                ((foot.ball_length - foot.heel_length) / 2, 0.0, -foot.ankle_height + thick / 2),
            ),
        )
    if link == "toe_plate":
        toe, thick = design.toe, design.toe.axis_height * 1.4
        return (
            Shape(
                "box",
                (toe.length, design.foot.width, thick),
                (toe.length / 2, 0.0, -toe.axis_height + thick / 2),
            ),
        )
    return ()


def _pads(design: Design, link: str) -> tuple[Shape, ...]:
    radius = design.contact.pad_radius
    half = max(design.foot.width / 2 - radius, 0.0)
    if link == "foot":
        height = -design.foot.ankle_height + radius
        places = [(-design.foot.heel_length + radius, height), (design.foot.ball_length, height)]
    elif link == "toe_plate":
        places = [(design.toe.length - radius, -design.toe.axis_height + radius)]
    else:
        return ()
    return tuple(
        Shape("sphere", (radius,), (x, sign * half, z)) for x, z in places for sign in (1.0, -1.0)
    )
