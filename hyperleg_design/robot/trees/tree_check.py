"""Whether a design that writes its tree out is a robot: one tree, motors for every joint, bodies
that can be.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import motors
from hyperleg_design.robot.checks.refusal import check_batch, check_name, refuse
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.trees import limb_actuation, limb_masses
from hyperleg_design.robot.trees.rod_check import check_rods, spanned
from hyperleg_design.robot.trees.tree_design import TreeDesign

LARGEST_CONDITION = 1e6
"""Condition number of `joint_from_motor` from which it counts as singular."""
NO_REDUCTION = 1e-9
"""Reduction below which a motor does not move a joint, but for rounding [-]."""
MOVES = 0.01
"""Share of a joint in a motion that no motor drives, from which it is named."""


def ordered(
    joints: Mapping[str, tuple[str, str]], links: Iterable[str], root: str, where: str
) -> list[str]:
    """Order the joints with parents before children, depth first, and in the given order otherwise.

    Args:
        joints: parent and child link of each joint, by name.
        links: names of all links.
        root: the link that nothing carries.
        where: file, for errors.

    Returns:
        Names of the joints.

    Raises:
        InputError: a link that is not there, is carried twice, or hangs on nothing; a loop.
    """
    links = list(links)
    if root not in links:
        raise InputError(where, "trunk.link", root, _unknown_link(root, links))
    carried: dict[str, str] = {}
    for name, (parent, child) in joints.items():
        for end, link in (("parent", parent), ("child", child)):
            if link not in links:
                raise InputError(where, f"joints.{name}.{end}", link, _unknown_link(link, links))
        if child in carried:
            raise InputError(
                where,
                f"joints.{name}.child",
                child,
                f"is carried by the joint {carried[child]} already: a tree has no loops; leave one "
                f"joint out, and describe a parallel linkage under rods",
            )
        if child == root:
            raise InputError(
                where,
                f"joints.{name}.child",
                child,
                "is the root link (trunk.link), which nothing carries: a tree has no loops",
            )
        carried[child] = name
    for link in links:
        if link != root and link not in carried:
            raise InputError(
                where,
                f"links.{link}",
                None,
                f"hangs on nothing: it is a second root beside {root}; add a joint that carries it",
            )
    order: list[str] = []

    def visit(link: str) -> None:
        for name, (parent, child) in joints.items():
            if parent == link:
                order.append(name)
                visit(child)

    visit(root)
    for name, (parent, _) in joints.items():
        if name not in order:
            raise InputError(
                where,
                f"joints.{name}.parent",
                parent,
                f"leads back to itself instead of to the root link {root}: a tree has no loops",
            )
    return order


def _unknown_link(name: str, links: list[str]) -> str:
    return parameters.unknown(str(name), sorted(links), "link")


def check_tree_design(design: TreeDesign) -> None:
    """Check that a design that describes its own tree is a robot, and report the first misfit.

    Args:
        design: a robot or batch.

    Raises:
        InputError: names the field, its value and what would be right.
    """
    where = str(design.source or design.name)
    check_name(design, where)
    _check_limb_names(design, where)
    check_batch(design, where)
    links = design.link_sections
    ordered(
        {name: (str(j.parent), str(j.child)) for name, j in design.all_joints.items()},
        links,
        str(design.trunk.link),
        where,
    )
    for section, field in (
        ("actuators", "housed_in"),
        ("pads", "link"),
        ("rods", "carrier"),
        ("rods", "end"),
    ):
        for name, held in getattr(design, f"{section.removesuffix('s')}_sections").items():
            link = str(getattr(held, field))
            if link not in links:
                remedy = _unknown_link(link, list(links))
                raise InputError(where, f"{section}.{name}.{field}", link, remedy)
    _check_joints(design, where)
    check_rods(design, where)
    _check_motors(design, where)
    _check_bodies(design, where)
    _check_actuation(design, where)
    _check_printed(design, where)
    joint_friction(design)  # an unknown law of friction or gears is an error here
    rotor_inertia(design)


def _check_limb_names(design: TreeDesign, where: str) -> None:
    names = [copy for copy in design.copies if copy]
    for copy in names:
        if any(other != copy and other.startswith(f"{copy}_") for other in names):
            remedy = "is the start of another limb's name; choose names that differ"
            raise InputError(where, f"limbs.{copy}", None, remedy)


def _check_joints(design: TreeDesign, where: str) -> None:
    if not design.joint_sections:
        raise InputError(where, "joints", None, "has no joint that moves")
    for name, joint in design.all_joints.items():
        lower, upper, default = (
            np.asarray(v, float) for v in (joint.lower_deg, joint.upper_deg, joint.default_deg)
        )
        place = f"joints.{name}"
        _unit(where, f"{place}.axis", joint.axis)
        if joint.type == "fixed":
            continue
        remedy = "must lie below upper_deg; the range is reversed or empty"
        refuse(where, f"{place}.lower_deg", lower < upper, lower, remedy)
        remedy = "must lie within lower_deg .. upper_deg"
        inside = (lower <= default) & (default <= upper)
        refuse(where, f"{place}.default_deg", inside, default, remedy)
    for name, rod in design.rod_sections.items():
        _unit(where, f"rods.{name}.axis", rod.axis)


def _unit(where: str, field: str, axis: Any) -> None:
    length = np.linalg.norm(np.asarray(axis, float), axis=-1)
    remedy = "expects a vector of length 1"
    refuse(where, field, np.abs(length - 1) < 1e-4, axis, remedy)


def _check_motors(design: TreeDesign, where: str) -> None:
    for name, actuator in design.actuator_sections.items():
        for motor in np.unique(actuator.motor):
            motors.find_motor(str(motor), where, f"actuators.{name}.motor")
        reference = design.reference_sections[name]
        motors.find_motor(str(reference.motor), where, f"reference.{name}.motor")


def _replaced(design: TreeDesign) -> list[str]:
    """Motors whose mass, with their gears, the links gain over that of the reference build."""
    if design.masses.law != "components":
        return []
    return [
        name
        for name, actuator in design.actuator_sections.items()
        if np.any(np.asarray(actuator.motor) != design.reference_sections[name].motor)
        or np.any(np.asarray(actuator.gear) != design.reference_sections[name].gear)
    ]


def _check_bodies(design: TreeDesign, where: str) -> None:
    masses = limb_masses.limb_masses(design).links
    for name, body in masses.items():
        principal = np.linalg.eigvalsh(body.inertia)
        scale = np.maximum(principal[..., 2], 1e-12)
        real = (principal[..., 0] >= -1e-9 * scale) & (
            principal[..., 2] <= (principal[..., 0] + principal[..., 1]) * (1 + 1e-6) + 1e-12
        )
        remedy = (
            "are principal moments of inertia that no body has: none is negative, and the largest "
            "is at most the sum of the other two; "
        )
        taken = [n for n in _replaced(design) if design.actuator_sections[n].housed_in == name]
        remedy += (
            f"the link as it is described cannot contain the reference motor and gear of "
            f"{', '.join(taken)}, which are taken out of it; correct one of the two, or keep all "
            "masses as they are with masses: {law: fixed}"
            if taken
            else "check gyration, inertia and the units"
        )
        refuse(where, f"links.{name}", real, principal.round(9), remedy)
    fixed = {j.child for j in design.all_joints.values() if j.type == "fixed"}
    for name, joint in design.joint_sections.items():
        own = [joint.child]
        for link in own:
            own += [
                j.child for j in design.all_joints.values() if j.parent == link and j.child in fixed
            ]
        mass = sum((np.asarray(masses[link].mass) for link in own), start=np.zeros(()))
        remedy = f"moves with the joint {name} and has no mass; give it some, or fix the joint"
        refuse(where, f"links.{joint.child}.mass", mass > 0, mass, remedy)
        if len(own) == 1:  # a fixed child beside it is at another place
            inertia = masses[joint.child].inertia
            remedy = "expects the radii of gyration of a link that moves, unless inertia is given"
            gyration = design.link_sections[joint.child].gyration
            extended = np.any(inertia > 0, axis=(-2, -1))
            refuse(where, f"links.{joint.child}.gyration", extended, gyration, remedy)


def _check_actuation(design: TreeDesign, where: str) -> None:
    joints, columns = list(design.joint_sections), list(design.actuator_sections)
    matrix = limb_actuation.joint_from_motor(design)
    for index, name in enumerate(joints):
        if np.all(np.abs(matrix[..., index, :]) < NO_REDUCTION):
            for rod in design.rod_sections:
                if name in spanned(design, rod):
                    remedy = (
                        f"does not turn the joint {name} in the default posture, where the rod "
                        f"points at the axis of that joint or along it; move its points"
                    )
                    raise InputError(where, f"rods.{rod}", None, remedy)
            raise InputError(
                where,
                f"joints.{name}",
                None,
                f"has no motor; let one of {parameters.some(columns)} drive it under transmission "
                f"or rods, or set its type to fixed",
            )
    if len(columns) < len(joints):
        raise InputError(
            where,
            "actuators",
            len(columns),
            f"motors cannot hold {len(joints)} joints; give each joint a motor of its own or more",
        )
    undriven, sizes, _ = np.linalg.svd(matrix)
    good = sizes[..., -1] * LARGEST_CONDITION > sizes[..., 0]
    if np.all(good):
        return
    first = np.unravel_index(np.argmin(good), good.shape)
    motion = undriven[first][:, len(joints) - 1]
    together = [n for n, share in zip(joints, motion, strict=True) if abs(share) > MOVES]
    raise InputError(
        where,
        "transmission",
        None,
        f"joint_from_motor is singular: {' and '.join(together)} cannot be driven apart; check "
        f"transmission, rods and gears",
        bad=~good,
    )


def _check_printed(design: TreeDesign, where: str) -> None:
    """Whether the declared masses add up to the published one, as long as nobody replaced any."""
    printed = np.asarray(design.masses.expected_total, float)
    root = str(design.trunk.link)
    total = sum(
        (
            np.asarray(link.mass, float) * (1 if name == root else len(design.copies))
            for name, link in design.link_sections.items()
        ),
        start=np.zeros(()),
    )
    remedy = f"the links add up to {float(np.max(total)):.6g} kg; correct one or the other"
    good = (printed == 0) | (np.abs(total - printed) < 1e-6)
    refuse(where, "masses.expected_total", good, printed, remedy)
