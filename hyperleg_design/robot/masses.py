"""Masses that follow from the choice of motors, gears and lengths.

Law `components`: a segment weighs what the design declares for its reference build, plus the
actuators it houses now, less those it housed then, and its structure (the rest) grows in proportion
to the segment's length. An actuator weighs its motor plus a gear in proportion to the gear's peak
output torque; the stages behind the gears weigh what `gear` says. Another law is one function,
registered with `mass_law`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.laws import gear
from hyperleg_design.robot.laws.laws import Laws
from hyperleg_design.robot.mass.actuator import actuator_mass
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, SEGMENTS
from hyperleg_design.robot.trees.limb_masses import LimbMasses, limb_masses
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

_REFERENCE_PART = {
    "hip_yaw": "hip",
    "hip_roll": "hip",
    "hip_pitch": "hip",
    "knee": "knee",
    "ankle": "ankle",
    "toe": "toe",
}
"""Part of the reference build that each actuator stands for."""


@dataclass(frozen=True, eq=False)
class HousedMass:
    """Change of mass at one place in a segment, per leg."""

    segment: str
    fraction: Any
    """Where along thigh or shank, over the length from the upper joint [-], `(...)`; the pelvis has
    it at the hip."""
    change: Any
    """Against the reference build [kg], `(...)`."""


@dataclass(frozen=True, eq=False)
class MassTable:
    """Masses of a design or batch [kg], each `(...)`; legs are counted once."""

    pelvis: Any
    thigh: Any
    shank: Any
    foot: Any
    toe: Any
    housed: tuple[HousedMass, ...]
    """What differs from the reference build, for centres of mass and inertias."""
    structure: Mapping[str, Any]
    """Pelvis, thigh and shank without the actuators they house [kg]."""

    @property
    def leg(self) -> Any:
        """Mass of one leg [kg], `(...)`."""
        return self.thigh + self.shank + self.foot + self.toe

    @property
    def total(self) -> Any:
        """Mass of the whole robot [kg], `(...)`."""
        return self.pelvis + 2 * self.leg


Law = Callable[["HyperLeg"], MassTable]
_LAWS: Laws[Law] = Laws("masses")
mass_law = _LAWS.register
"""Registers a law of masses under the name that `masses.law` uses."""


@overload
def mass_table(design: TreeDesign) -> LimbMasses: ...
@overload
def mass_table(design: HyperLeg) -> MassTable: ...
def mass_table(design: HyperLeg | TreeDesign) -> MassTable | LimbMasses:
    """Masses of the segments, or of the links of a written-out tree, by the design's law.

    Args:
        design: a robot, or a batch of `n` robots.

    Returns:
        Masses of pelvis, segments, leg and robot [kg], `()` for a robot, `(n,)` for a
        batch. Of a design that writes its tree out, those of the trunk, one limb and the robot, and
        `links`, the inertials by name of the link.

    Raises:
        InputError: no such law.
    """
    if isinstance(design, TreeDesign):
        return limb_masses(design)
    return _LAWS.of(design)(design)


def built_mass(design: Any, actuator: Any) -> Any:
    """Compute the mass of an actuator as the design builds it.

    Args:
        design: gives the mass of gears per torque.
        actuator: section of the design with motor and gear.

    Returns:
        The mass [kg], `(...)`.
    """
    return actuator_mass(actuator.motor, actuator.gear, design.masses.gear_mass_per_torque)


def reference_mass(design: HyperLeg, name: str) -> Any:
    """Compute the mass of an actuator in the reference build.

    Args:
        design: a robot or batch.
        name: of the actuator, a field of `Actuators`.

    Returns:
        The mass [kg], `(...)`.
    """
    part = _REFERENCE_PART[name]
    motor, gear = (
        getattr(design.reference, f"{part}_motor"),
        getattr(design.reference, f"{part}_gear"),
    )
    return actuator_mass(motor, gear, design.masses.gear_mass_per_torque)


@mass_law("components")
def components(design: HyperLeg) -> MassTable:
    """Correct the declared masses for actuators, places and lengths that differ from the reference
    build.

    Args:
        design: a robot or batch.

    Returns:
        The mass table.
    """
    housed: list[HousedMass] = []
    load: dict[str, Any] = dict.fromkeys(SEGMENTS, 0.0)
    for name in ACTUATOR_OF_MOTOR:  # both ankle motors
        before = reference_mass(design, name)
        after = (
            built_mass(design, getattr(design.actuators, name))
            if design.actuators.toe_installed or name != "toe"
            else 0.0
        )
        if name == "toe":
            after = after + design.masses.thigh_ballast
        housed += _moved(design, name, before, after)
        place = getattr(design.reference.places, name).housed_in
        load[place] = load[place] + _legs(place) * before
    for joint, change in gear.gear_change(design).stage_mass.items():
        housed.append(HousedMass(*gear.STAGE_PLACES[joint], change))
    return _table(design, housed, load)


@mass_law("fixed")
def fixed(design: HyperLeg) -> MassTable:
    """Keep the declared masses, whatever motors and lengths; a toe motor that is not installed
    still counts, and ballast is as declared.

    Args:
        design: a robot or batch.

    Returns:
        The mass table.
    """
    lost = 0.0 if design.actuators.toe_installed else reference_mass(design, "toe")
    return _table(design, _moved(design, "toe", lost, design.masses.thigh_ballast), None)


def _legs(segment: str) -> int:
    """Legs whose actuators a segment carries."""
    return 2 if segment == "pelvis" else 1


def _moved(design: HyperLeg, name: str, before: Any, after: Any) -> list[HousedMass]:
    """Changes where an actuator was and where it is; one change where these are the same."""
    was, now = getattr(design.reference.places, name), getattr(design.actuators, name)
    if was.housed_in == now.housed_in and np.array_equal(
        was.position_fraction, now.position_fraction
    ):
        return [HousedMass(now.housed_in, now.position_fraction, after - before)]
    return [
        HousedMass(was.housed_in, was.position_fraction, -before),
        HousedMass(now.housed_in, now.position_fraction, after),
    ]


def _table(
    design: HyperLeg, housed: Iterable[HousedMass], load: Mapping[str, Any] | None
) -> MassTable:
    """Masses from changes and from the actuators in the reference build; no growth with length
    without the latter.
    """
    housed = tuple(housed)
    change: dict[str, Any] = dict.fromkeys(SEGMENTS, 0.0)
    for part in housed:
        change[part.segment] = change[part.segment] + _legs(part.segment) * part.change
    mass: dict[str, Any] = {}
    structure: dict[str, Any] = {}
    for name in ("pelvis", "thigh", "shank"):
        part = getattr(design, name)
        carried = load[name] if load is not None else 0.0
        grown = part.mass - carried
        if load is not None and name != "pelvis":
            grown = grown * (part.length / getattr(design.reference, f"{name}_length"))
        structure[name] = grown
        mass[name] = grown + (carried + change[name])
    return MassTable(
        foot=np.asarray(design.foot.mass)[()],
        toe=np.asarray(design.toe.mass)[()],
        housed=housed,
        structure=structure,
        **mass,
    )


def check_masses(design: HyperLeg, where: str) -> None:
    """Check that the masses add up and stay positive.

    Args:
        design: a robot or batch.
        where: file, for error messages.

    Raises:
        InputError: a segment lighter than what it carries, or a sum other than the printed one.
    """
    table = mass_table(design)
    for segment in ("pelvis", "thigh", "shank"):
        mass = np.asarray(getattr(table, segment))
        if np.any(mass <= 0):
            remedy = "the actuators it houses weigh more than the segment itself"
            raise InputError(where, f"{segment}.mass", float(np.min(mass)), remedy, bad=mass <= 0)
        hollow = np.asarray(table.structure.get(segment, 1.0)) <= 0
        if np.any(hollow):
            remedy = (
                "is less than the actuators that the reference build houses there; raise it "
                "or lower masses.gear_mass_per_torque"
            )
            raise InputError(
                where,
                f"{segment}.mass",
                float(np.min(design[f"{segment}.mass"])),
                remedy,
                bad=hollow,
            )
    carriers = design.hip.yaw_carrier_mass + design.hip.roll_carrier_mass
    empty = np.asarray(table.thigh) <= carriers
    if np.any(empty):
        raise InputError(
            where,
            "thigh.mass",
            float(np.min(table.thigh)),
            "leaves nothing for the thigh below the hip carriers",
            bad=empty,
        )


def check_printed(design: HyperLeg, where: str) -> None:
    """Check that the declared masses add up to the printed sums, where a file states them.

    Args:
        design: a robot or batch.
        where: file, for error messages.

    Raises:
        InputError: they do not.
    """
    leg = design.thigh.mass + design.shank.mass + design.foot.mass + design.toe.mass
    for field, computed in (
        ("expected_leg", leg),
        ("expected_total", design.pelvis.mass + 2 * leg),
    ):
        printed = getattr(design.masses, field)
        wrong = np.asarray((printed != 0) & (np.abs(computed - printed) > 1e-6))
        if np.any(wrong):
            printed, computed = (
                np.broadcast_to(v, wrong.shape)[wrong].flat[0] for v in (printed, computed)
            )
            raise InputError(
                where,
                f"masses.{field}",
                float(printed),
                f"the declared segments add up to {computed:.6g} kg; correct one or the other",
            )


def lapsed(design: HyperLeg, values: Iterable[str]) -> dict[str, float]:
    """List the printed sums that no longer hold when some leaves are replaced.

    Args:
        design: a robot or batch.
        values: dotted paths of the leaves.

    Returns:
        Paths of the sums, each with the value 0, which means no check.
    """
    leg = {f"{segment}.mass" for segment in SEGMENTS[1:]}
    parts = {"masses.expected_leg": leg, "masses.expected_total": leg | {"pelvis.mass"}}
    return {
        field: 0.0
        for field, masses in parts.items()
        if masses & set(values) and field not in values and np.any(design[field])
    }
