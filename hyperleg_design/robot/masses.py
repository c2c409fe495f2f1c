"""Masses that follow from the choice of motors, gears and lengths.

Law `components`: a segment weighs what the design declares for its reference build, plus the difference between the
actuators it houses now and then, and its structure (the rest) grows in proportion to the segment's length.
An actuator weighs its motor plus a gear in proportion to the gear's peak output torque. Another law is one function,
registered with `mass_law`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot import motors
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, SEGMENTS

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.sections import Actuator

_REFERENCE_PART = {"hip_yaw": "hip", "hip_roll": "hip", "hip_pitch": "hip", "knee": "knee", "ankle": "ankle", "toe": "toe"}
"""Part of the reference build that each actuator stands for."""


@dataclass(frozen=True, eq=False)
class HousedMass:
    """Change of mass at one actuator's place in a segment, per leg."""

    segment: str
    change: Any
    """Against the reference build [kg], `(...)`."""
    actuator: str


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
    thigh_structure: Any
    """Thigh without what it houses [kg]."""

    @property
    def leg(self) -> Any:
        """One leg [kg]."""
        return self.thigh + self.shank + self.foot + self.toe

    @property
    def total(self) -> Any:
        """The robot [kg]."""
        return self.pelvis + 2 * self.leg


Law = Callable[["Design"], MassTable]
_LAWS: dict[str, Law] = {}


def mass_law(name: str) -> Callable[[Law], Law]:
    """Register a law of masses under the name that `masses.law` uses."""

    def register(law: Law) -> Law:
        _LAWS[name] = law
        return law

    return register


def mass_table(design: Design) -> MassTable:
    """Masses of the segments by the design's law.

    Raises:
        InputError: no such law.
    """
    if design.masses.law not in _LAWS:
        raise InputError(design.source or design.name, "masses.law", design.masses.law, f"expects one of {', '.join(sorted(_LAWS))}")
    return _LAWS[design.masses.law](design)


def actuator_mass(motor: Any, gear: Any, gear_mass_per_torque: Any) -> Any:
    """Mass of motor and gear [kg]: m_motor + k * gear * peak torque, `(...)`."""
    weight = motors.gather(motor, lambda m: m.mass)
    peak = motors.gather(motor, lambda m: m.peak_torque())
    return weight + gear_mass_per_torque * gear * peak


def built_mass(design: Design, actuator: Actuator) -> Any:
    """Mass of an actuator as the design builds it [kg]."""
    return actuator_mass(actuator.motor, actuator.gear, design.masses.gear_mass_per_torque)


def reference_mass(design: Design, name: str) -> Any:
    """Mass of an actuator in the reference build [kg]; `name` as in `Actuators`."""
    part = _REFERENCE_PART[name]
    motor, gear = getattr(design.reference, f"{part}_motor"), getattr(design.reference, f"{part}_gear")
    return actuator_mass(motor, gear, design.masses.gear_mass_per_torque)


@mass_law("components")
def components(design: Design) -> MassTable:
    """Declared masses, corrected for other actuators and lengths than the reference build's."""
    change: dict[str, Any] = dict.fromkeys(SEGMENTS, 0.0)
    reference_load: dict[str, Any] = dict.fromkeys(SEGMENTS, 0.0)
    housed = []
    for name in ACTUATOR_OF_MOTOR:  # both ankle motors
        actuator = getattr(design.actuators, name)
        before = reference_mass(design, name)
        installed = design.actuators.toe_installed or name != "toe"
        after = built_mass(design, actuator) if installed else 0.0
        if name == "toe":
            after = after + design.masses.thigh_ballast
        legs = 2 if actuator.housed_in == "pelvis" else 1
        change[actuator.housed_in] = change[actuator.housed_in] + legs * (after - before)
        reference_load[actuator.housed_in] = reference_load[actuator.housed_in] + legs * before
        housed.append(HousedMass(actuator.housed_in, after - before, name))

    def segment(name: str) -> tuple[Any, Any]:
        part = getattr(design, name)
        structure = part.mass - reference_load[name]
        grown = structure * (part.length / getattr(design.reference, f"{name}_length"))
        return grown + (reference_load[name] + change[name]), grown

    thigh, structure = segment("thigh")
    shank, _ = segment("shank")
    return MassTable(
        pelvis=design.pelvis.mass + change["pelvis"],
        thigh=thigh,
        shank=shank,
        foot=np.asarray(design.foot.mass)[()],
        toe=np.asarray(design.toe.mass)[()],
        housed=tuple(housed),
        thigh_structure=structure,
    )


@mass_law("fixed")
def fixed(design: Design) -> MassTable:
    """The declared masses, whatever the motors; a missing toe motor still counts, ballast as declared."""
    lost = 0.0 if design.actuators.toe_installed else reference_mass(design, "toe")
    thigh = design.thigh.mass - lost + design.masses.thigh_ballast
    return MassTable(design.pelvis.mass, thigh, design.shank.mass, design.foot.mass, design.toe.mass, (), thigh)


def check_masses(design: Design, where: str) -> None:
    """Whether the masses add up and stay positive.

    Raises:
        InputError: a segment lighter than what it carries, or a sum other than the printed one.
    """
    table = mass_table(design)
    for segment in ("pelvis", "thigh", "shank"):
        mass = np.asarray(getattr(table, segment))
        if np.any(mass <= 0):
            raise InputError(where, f"{segment}.mass", float(np.min(mass)), "the actuators it houses weigh more than the segment itself")
    if np.any(np.asarray(table.thigh_structure) <= 0):
        remedy = "is less than the reference actuators that the thigh houses; raise it or lower masses.gear_mass_per_torque"
        raise InputError(where, "thigh.mass", float(np.min(design.thigh.mass)), remedy)
    carriers = design.hip.yaw_carrier_mass + design.hip.roll_carrier_mass
    if np.any(np.asarray(table.thigh) <= carriers):
        raise InputError(where, "thigh.mass", float(np.min(table.thigh)), "leaves nothing for the thigh below the hip carriers")


def check_printed(design: Design, where: str) -> None:
    """Whether the declared masses add up to the printed sums, where a file gives those.

    Raises:
        InputError: they do not.
    """
    leg = design.thigh.mass + design.shank.mass + design.foot.mass + design.toe.mass
    for field, found in (("expected_leg", leg), ("expected_total", design.pelvis.mass + 2 * leg)):
        printed = getattr(design.masses, field)
        if printed and abs(found - printed) > 1e-6:
            raise InputError(where, f"masses.{field}", printed, f"the declared segments add up to {found:.6g} kg; correct one or the other")
