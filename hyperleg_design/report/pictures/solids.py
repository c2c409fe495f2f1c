"""Solids that a robot is drawn with: links, sole pads and motors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.report.pictures.picture import Solid
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.posture import axis_rotation, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import SIGN, Tree, build_tree
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, MOTORS, SIDES

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.trees.tree_design import TreeDesign

FRAME, DARK, PAD = "#c9cdd4", "#8b93a1", "#2b2d33"
TOE = {"active": "#e07b39", "locked": "#9aa0aa"}
MOTOR_COLOUR = {
    "hip_yaw": "#4c72b0",
    "hip_roll": "#4c72b0",
    "hip_pitch": "#4c72b0",
    "knee": "#55a868",
    "ankle": "#8172b3",
    "toe": "#e07b39",
}

ROD = 0.04
"""Radius of a rod that stands for a link without a drawing, over its length [-]."""


def robot_solids(
    design: RobotDesign,
    *,
    angles: Mapping[str, float] | None = None,
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    yaw: float = 0.0,
    opacity: float = 1.0,
    motors: bool = True,
    tree: Tree | None = None,
    pelvis: tuple[np.ndarray, np.ndarray] | None = None,
) -> list[Solid]:
    """Place the solids of a robot that stands with its lowest sole pad at the height of `offset`,
    or whose pelvis has a given pose.

    Args:
        design: one robot.
        angles: joint angles [rad] by joint name, zero where not named.
        offset: of the point below the pelvis's origin [m].
        yaw: turn of the whole robot [rad].
        opacity: 0 to 1.
        motors: draw the motors where the design houses them.
        tree: the design's tree, if it is already there.
        pelvis: rotation `(3, 3)` and position [m] of the pelvis in the world, instead of `offset`
            and `yaw`.

    Returns:
        The solids in the world.
    """
    tree = tree or build_tree(design)
    poses = link_poses(tree, angles)
    base = (
        np.zeros(3)
        if pelvis is not None
        else np.asarray(offset, float) - np.array([0.0, 0.0, lowest_point(tree, poses)])
    )
    solids = []
    for link, own in link_solids(design, tree, opacity=opacity, motors=motors).items():
        rotation, position = poses[link]
        solids += [
            replace(
                s,
                rotation=rotation @ s.rotation,
                position=base + position + rotation @ s.position,
            )
            for s in own
        ]
    if pelvis is not None:
        turn, place = pelvis
        return [
            replace(s, rotation=turn @ s.rotation, position=place + turn @ s.position)
            for s in solids
        ]
    if not yaw:
        return solids
    turn, centre = axis_rotation(np.array([0.0, 0.0, 1.0]), yaw), np.asarray(offset, float)
    return [
        replace(s, rotation=turn @ s.rotation, position=centre + turn @ (s.position - centre))
        for s in solids
    ]


def link_solids(
    design: RobotDesign, tree: Tree, *, opacity: float = 1.0, motors: bool = True
) -> dict[str, list[Solid]]:
    """Collect the solids of each link in the link's own frame.

    A link of a written-out tree that has no drawing, as in robots from a URDF, gets rods from its
    origin to its joints and pads, or to its centre of mass where it has neither.

    Args:
        design: one robot of any family.
        tree: of the design.
        opacity: 0 to 1.
        motors: draw the motors where the design houses them.

    Returns:
        Solids by link.
    """
    toe = TOE.get(str(design["toe.joint"]), TOE["locked"]) if tree.hyperleg else FRAME
    solids: dict[str, list[Solid]] = {}
    for link in tree.links:
        own = solids.setdefault(link.name, [])
        for shape in link.visuals:
            kind = "capsule" if shape.kind == "cylinder" and tree.hyperleg else shape.kind
            colour = FRAME
            if link.name.endswith("toe_plate"):
                colour = toe
            elif shape.kind == "sphere":
                colour = DARK
            fade = 0.35 if kind in ("capsule", "cylinder") and motors else opacity
            own.append(
                Solid(
                    kind,
                    shape.size,
                    np.eye(3),
                    np.array(shape.position),
                    colour,
                    min(opacity, fade),
                )
            )
        own += [
            Solid("sphere", pad.size, np.eye(3), np.array(pad.position), PAD, opacity)
            for pad in link.pads
        ]
    if motors:
        add = _motor_solids if tree.hyperleg else _tree_motor_solids
        for name, solid in add(cast("Any", design), tree, opacity):
            solids[name].append(solid)
    if not tree.hyperleg:
        for link in tree.links:
            if not link.visuals:
                joints = [joint for joint in tree.joints if joint.parent == link.name]
                ends = [np.array(joint.position) for joint in joints]
                ends += [np.array(pad.position) for pad in link.pads]
                for end in ends or [link.com]:
                    solids[link.name] += _rod(end, opacity)
    return solids


def _rod(end: np.ndarray, opacity: float) -> list[Solid]:
    """A rod from the origin of a link to a point of it; none where they coincide."""
    length = float(np.linalg.norm(end))
    if length < 1e-6:
        return []
    size = (ROD * length, length)
    return [Solid("cylinder", size, _z_along(end), end / 2, FRAME, min(opacity, 0.6))]


def _z_along(vector: np.ndarray) -> np.ndarray:
    """A rotation whose z axis points along a vector, `(3, 3)`."""
    along = vector / np.linalg.norm(vector)
    aside = np.linalg.svd(along[None])[2][1]
    return np.column_stack([aside, np.cross(along, aside), along])


def _motor_radius(mass: float) -> float:
    """Of a disc of 6500 kg/m^3, steel and copper, that is 0.8 of its radius thick [m]."""
    return float(np.cbrt(mass / (6500 * np.pi * 0.8)))


_ACROSS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Turns a cylinder's z axis onto y."""


def _motor_solids(design: Design, tree: Tree, opacity: float) -> Iterator[tuple[str, Solid]]:
    """Motors of HyperLeg's legs as discs of their mass, each with the link that houses it."""
    from hyperleg_design.robot.motors import motor_arrays

    mass = motor_arrays(design).mass
    for side in SIDES:
        for index, motor in enumerate(MOTORS):
            if motor not in transmission.motor_names(design):
                continue
            name = ACTUATOR_OF_MOTOR[index]
            actuator = getattr(design.actuators, name)
            radius = _motor_radius(mass[index])
            if actuator.housed_in == "pelvis":
                link = "pelvis"
                lift = {"hip_yaw": 0.05, "hip_roll": 0.0, "hip_pitch": 0.0}.get(name, 0.1)
                turn = {
                    "hip_yaw": np.eye(3),
                    "hip_roll": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
                }.get(name, _ACROSS)
                place = np.array(
                    [0.07 if name == "hip_roll" else 0.0, SIGN[side] * design.hip.spacing / 2, lift]
                )
            else:
                link, turn = f"{side}_{actuator.housed_in}", _ACROSS
                shift = {"ankle_left": 0.016, "ankle_right": -0.016}.get(motor, 0.0)
                outward = 0.06 if name == "hip_pitch" else 0.0
                depth = actuator.position_fraction * getattr(design, actuator.housed_in).length
                place = np.array([0.0, SIGN[side] * outward + shift * 1.4, -depth])
            thickness = radius * (0.8 if name != "ankle" else 0.7)
            yield (
                link,
                Solid("cylinder", (radius, thickness), turn, place, MOTOR_COLOUR[name], opacity),
            )


def _tree_motor_solids(
    design: TreeDesign, tree: Tree, opacity: float
) -> Iterator[tuple[str, Solid]]:
    """Motors of a robot that writes its tree out as discs of their mass about the axis that they
    turn, each with its link.
    """
    from hyperleg_design.robot.motors import find_motor
    from hyperleg_design.robot.trees.tree_build import model_link
    from hyperleg_design.robot.trees.tree_limb import copied

    colours = tuple(dict.fromkeys(MOTOR_COLOUR.values()))
    axes = {name: _turned_axis(design, name) for name in design.actuator_sections}
    for copy, section in design.copy_sections.items():
        for index, (name, actuator) in enumerate(design.actuator_sections.items()):
            in_root = actuator.housed_in == design.trunk.link
            link = tree.base if in_root else model_link(copy, str(actuator.housed_in))
            place = copied(section, np.asarray(actuator.place, float), move=in_root)
            radius = _motor_radius(find_motor(str(actuator.motor)).mass)
            yield (
                link,
                Solid(
                    "cylinder",
                    (radius, 0.8 * radius),
                    _z_along(copied(section, axes[name])),
                    place,
                    colours[index % len(colours)],
                    opacity,
                ),
            )


def _turned_axis(design: TreeDesign, motor: str) -> np.ndarray:
    """Axis of the crank or joint that a motor drives most, in the frame of its housing, `(3,)`."""
    from hyperleg_design.robot.trees.tree_limb import link_frames

    if motor in design.rod_sections:
        rod = design.rod_sections[motor]
        axis, link = rod.axis, str(rod.carrier)
    else:
        name = max(design.joint_sections, key=lambda joint: abs(float(design.ratio(motor, joint))))
        axis, link = design.all_joints[name].axis, str(design.all_joints[name].child)
    frames = link_frames(design)
    housing = frames[str(design.actuator_sections[motor].housed_in)][0]
    return np.asarray(housing.T @ frames[link][0] @ np.asarray(axis, float))
