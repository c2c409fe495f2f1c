"""What the links of one limb of a tree that is written out weigh, batched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.mass.actuator import actuator_mass
from hyperleg_design.robot.mass.bodies import Inertial, shifted
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import copied, descendants, link_frames, trunk_links


@dataclass(frozen=True, eq=False)
class LimbMasses:
    """Masses of a robot with its tree written out [kg], each `(...)`."""

    trunk: Any
    """Mass of the root link and of all that is fixed to it, of every limb [kg]."""
    limb: Any
    """Mass of one limb: of the links that move against the root link [kg]."""
    total: Any
    links: Mapping[str, Inertial]
    """Inertials of the root link and of one unmirrored limb, in their own frames."""


def limb_masses(design: TreeDesign) -> LimbMasses:
    """Compute the masses and inertias of a limb by the design's law.

    The law `components` adds a point mass to each link at the place of its motor: the mass of the
    motor with its gear minus that of the reference motor with its gear. A motor in the root link
    counts once for each limb.

    Args:
        design: a robot or batch.

    Returns:
        Links of one limb, their sum, and the mass of the robot.

    Raises:
        InputError: that leaves a link without mass.
    """
    links = {name: _declared(section) for name, section in design.link_sections.items()}
    root = str(design.trunk.link)
    if design.masses.law == "components":
        per_torque = design.masses.gear_mass_per_torque
        for name, actuator in design.actuator_sections.items():
            reference = design.reference_sections[name]
            change = actuator_mass(actuator.motor, actuator.gear, per_torque) - actuator_mass(
                reference.motor, reference.gear, per_torque
            )
            if not np.any(change):
                continue
            places = [np.asarray(actuator.place, float)]
            if actuator.housed_in == root:
                places = [
                    copied(copy, places[0], move=True) for copy in design.copy_sections.values()
                ]
            for place in places:
                links[actuator.housed_in] = with_point(links[actuator.housed_in], change, place)
            heavy = np.asarray(links[actuator.housed_in].mass) > 0
            if not np.all(heavy):
                raise InputError(
                    design.source or design.name,
                    f"links.{actuator.housed_in}.mass",
                    None,
                    f"is less than the reference actuator {name} that leaves it",
                    bad=~heavy,
                )
    bolted = trunk_links(design)
    copied_links = [name for name in links if name != root]
    fixed = _sum(links, [name for name in copied_links if name in bolted])
    limb = _sum(links, [name for name in copied_links if name not in bolted])
    own, copies = np.asarray(links[root].mass), len(design.copies)
    total = own + copies * _sum(links, copied_links)
    return LimbMasses(own + copies * fixed, limb, total, links)


def _sum(links: Mapping[str, Inertial], names: list[str]) -> Any:
    """Mass of some links together [kg]."""
    return sum((np.asarray(links[name].mass) for name in names), start=np.zeros(()))


def with_point(body: Inertial, mass: Any, place: np.ndarray) -> Inertial:
    """Add a point mass to a body, or take it away.

    Args:
        body: mass, centre of mass and inertia.
        mass: of the point [kg], `(...)`; negative to take it away.
        place: of the point [m], `(..., 3)`.

    Returns:
        The changed body.
    """
    total = np.asarray(body.mass + mass, float)
    safe = np.where(total > 0, total, 1.0)[..., None]
    moment = np.asarray(body.mass)[..., None] * body.com + np.asarray(mass)[..., None] * place
    com = np.where(total[..., None] > 0, moment / safe, body.com)
    inertia = body.inertia + shifted(body.mass, body.com - com) + shifted(mass, place - com)
    return Inertial(total, com, inertia)


def _declared(section: Any) -> Inertial:
    mass = np.asarray(section.mass, float)
    diagonal = mass[..., None] * np.asarray(section.gyration, float) ** 2
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(section.inertia, float), -1, 0)
    stated = np.stack(
        [np.stack([xx, xy, xz], -1), np.stack([xy, yy, yz], -1), np.stack([xz, yz, zz], -1)], -2
    )
    return Inertial(mass, np.asarray(section.com, float), diagonal[..., None] * np.eye(3) + stated)


def behind(
    design: TreeDesign, joint: str, position: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """What moves with a joint, taken as one body.

    Args:
        design: a robot or batch.
        joint: its name.
        position: joint angles [rad]; zero by default.

    Returns:
        Mass [kg] `(...)`, centre of mass in the root's frame [m], inertia about the joint's axis
        [kg m^2] `(...)`, and the joint's axis in the root's frame `(..., 3)`.
    """
    frames, masses = link_frames(design, position), limb_masses(design).links
    section = design.all_joints[joint]
    rotation, origin = frames[section.child]
    axis = (rotation @ np.asarray(section.axis, float)[..., None])[..., 0]
    total, moment, about = np.zeros(()), np.zeros(3), np.zeros(())
    for link in descendants(design, joint):
        turn, place = frames[link]
        body = masses[link]
        com = place + (turn @ np.asarray(body.com)[..., None])[..., 0]
        own = turn @ body.inertia @ np.swapaxes(turn, -1, -2)
        arm = np.cross(axis, com - origin)
        total = total + body.mass
        moment = moment + np.asarray(body.mass)[..., None] * com
        about = about + np.einsum("...i,...ij,...j->...", axis, own, axis)
        about = about + body.mass * np.sum(arm**2, -1)
    return total, moment / np.maximum(total, 1e-12)[..., None], about, axis
