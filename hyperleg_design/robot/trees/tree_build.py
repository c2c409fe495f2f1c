"""The tree of a robot whose design writes it out: the limb once for each of its copies."""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.kinematic_tree import Link, Shape, Tree, TreeJoint
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.robot.trees import limb_masses, tree_limb
from hyperleg_design.robot.trees.tree_design import TreeDesign

MIRROR = np.array([1.0, -1.0, 1.0])
"""Mirrors positions in the plane y = 0; axes and turns, which are pseudovectors, take its
opposite."""
WORLD, WORLD_BODY = "world", "world_body"
"""A link that MuJoCo would take for its world, which neither moves nor carries joints, and the name
that it gets in models."""


def tree_of(design: TreeDesign) -> Tree:
    """Build the kinematic tree of a robot whose design describes its own tree.

    A mirrored copy of the limb has mirrored axes, so that equal angles are mirrored postures.

    Args:
        design: one robot.

    Returns:
        The tree.
    """
    own, root = str(design.trunk.link), model_link("", str(design.trunk.link))
    masses = limb_masses.limb_masses(design).links
    links = [_link(design, root, own, masses[own], mirror=False)]
    joints: list[TreeJoint] = []
    for copy, section in design.copy_sections.items():
        mirror = bool(section.mirror)
        for name in design.link_sections:
            if name != own:
                links.append(
                    _link(design, model_link(copy, name), name, masses[name], mirror=mirror)
                )
        joints += _joints(design, copy, np.asarray(section.position, float), mirror)
    order = {joint.child: index for index, joint in enumerate(joints, 1)}
    links.sort(key=lambda link: order.get(link.name, 0))
    return Tree(
        design.name,
        tuple(links),
        tuple(joints),
        base=root,
        floating=design.trunk.motion == "floating",
        height=float(design.trunk.height),
        limbs=design.copies,
        hyperleg=False,
    )


def model_link(copy: str, link: str) -> str:
    """Name a link of a limb as trees and models do.

    Args:
        copy: name of the limb, empty for the root link and where limbs are not copied.
        link: its name in the design.

    Returns:
        The name, which is never `WORLD`.
    """
    name = prefixed(copy, link)
    return WORLD_BODY if name == WORLD else name


def _link(design: TreeDesign, name: str, own: str, body: Any, *, mirror: bool) -> Link:
    signs = MIRROR if mirror else np.ones(3)
    section = design.link_sections[own]
    sizes = {"box": 3, "cylinder": 2, "sphere": 1}
    drawn: tuple[Shape, ...] = ()
    if section.shape in sizes:
        size = tuple(np.asarray(section.size, float)[: sizes[section.shape]].tolist())
        drawn = (Shape(str(section.shape), size, _three(section.place * signs)),)
    pads = tuple(
        Shape(
            "sphere",
            (float(tree_limb.pad_radius(design, pad)),),
            _three(np.asarray(pad.position, float) * signs),
        )
        for pad in design.pad_sections.values()
        if pad.link == own
    )
    return Link(
        name,
        float(body.mass),
        np.asarray(body.com) * signs,
        np.asarray(body.inertia) * np.outer(signs, signs),
        drawn,
        pads,
    )


def _joints(design: TreeDesign, copy: str, place: np.ndarray, mirror: bool) -> list[TreeJoint]:
    root = str(design.trunk.link)
    signs = MIRROR if mirror else np.ones(3)
    moving = list(design.joint_sections)
    effort = transmission.max_joint_torque(design)
    speed = transmission.single_joint_speed(design)
    coulomb, viscous = joint_friction(design)
    joints = []
    for name, joint in design.all_joints.items():
        at = np.asarray(joint.position, float) * signs
        if joint.parent == root:
            at = at + place
        index = moving.index(name) if name in moving else None
        joints.append(
            TreeJoint(
                name=prefixed(copy, name),
                parent=model_link("" if joint.parent == root else copy, str(joint.parent)),
                child=model_link(copy, str(joint.child)),
                position=_three(at),
                axis=_three(np.asarray(joint.axis, float) * signs * np.prod(signs)),
                fixed=index is None,
                lower=float(np.deg2rad(joint.lower_deg)),
                upper=float(np.deg2rad(joint.upper_deg)),
                effort=0.0 if index is None else float(effort[index]),
                velocity=0.0 if index is None else float(speed[index]),
                coulomb=float(joint.coulomb if index is None else coulomb[index]),
                viscous=float(joint.viscous if index is None else viscous[index]),
                default=float(np.deg2rad(joint.default_deg)),
                turn=_three(np.deg2rad(joint.turn_deg) * signs * np.prod(signs)),
            )
        )
    return joints


def _three(values: Any) -> tuple[float, float, float]:
    x, y, z = (float(v) + 0.0 for v in values)
    return x, y, z
