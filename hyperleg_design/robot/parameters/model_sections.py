"""The sections of a design that say how it is modelled: masses, friction, gears, stops, contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hyperleg_design.robot.parameters.fields import number, text
from hyperleg_design.robot.parameters.values import Checked


@dataclass(frozen=True, eq=False, kw_only=True)
class MassModel(Checked):
    """How masses follow from the choice of motors, gears and lengths."""

    law: Any = text(default="components")
    """Name of a registered law: `components`, or `fixed` for the declared masses whatever the
    motors."""
    gear_mass_per_torque: Any = number("kg/Nm", 0, 0.2)
    """Gear mass over its peak output torque [kg/Nm]."""
    thigh_ballast: Any = number("kg", 0, 20, default=0.0)
    """Dead mass at the toe motor's place, to match the mass of another variant [kg]."""
    expected_total: Any = number("kg", 0, 500, default=0.0)
    """Printed mass of the reference build, checked on loading; 0 for no check [kg]."""
    expected_leg: Any = number("kg", 0, 100, default=0.0)
    """Printed mass of one leg of the reference build, checked on loading; 0 for no check [kg]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrictionModel(Checked):
    """How joint friction follows from motors and reductions."""

    law: Any = text(default="declared")
    """Name of a registered law: `reflected`, or `declared` for the joints' own numbers whatever the
    motors and reductions."""
    motor_share: Any = number("", 0, 1, default=0.5)
    """Part of the declared friction that belongs to motors and gears and is reflected through the
    reductions [-]; the rest belongs to the joint."""


@dataclass(frozen=True, eq=False, kw_only=True)
class GearModel(Checked):
    """What other reductions than the reference build's change in the gears."""

    law: Any = text(default="declared")
    """Name of a registered law: `catalogue`, or `declared` for no change."""
    inertia_per_torque: Any = number("kg m^2/Nm^(5/3)", 0, 1e-5, default=0.0)
    """Inertia of a gear at its rotor over its peak output torque to the power 5/3."""
    stage_mass_per_torque: Any = number("kg/Nm", 0, 0.2, default=0.0)
    """Mass of belt, pulleys and levers behind the gears over the peak torque at the joint
    [kg/Nm]."""
    loss_per_doubling: Any = number("", 0, 0.1, default=0.0)
    """Part of the transmitted power that is lost for each doubling of the reduction [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StopModel(Checked):
    """Stops at the ends of the joints' ranges of motion; MuJoCo's `solreflimit` and
    `solimplimit`.
    """

    time_constant: Any = number("s", 0.0005, 0.2, default=0.02)
    """Time constant of the stop's spring and damper [s]; MuJoCo keeps it at two simulation steps or
    more."""
    damping_ratio: Any = number("", 0.05, 5, default=1.0)
    """Damping ratio of the stop's spring and damper [-]."""
    impedance: Any = number("", 0.5, 0.9999, default=0.95)
    """MuJoCo's impedance d of a stop under load [-]: the spring's rest penetration under a steady
    load falls in proportion to 1 - d."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact(Checked):
    """Sole pads and the contact of the pads with the ground."""

    friction: Any = number("", 0, 5)
    """Sliding friction coefficient [-]."""
    torsional_friction: Any = number("m", 0, 0.5)
    """Torsional friction coefficient [m]."""
    pad_radius: Any = number("m", 0.002, 0.1)
    """Radius of the spherical sole pads [m]."""
    time_constant: Any = number("s", 0.001, 0.2)
    """Time constant of the contact's spring and damper [s]."""
    damping_ratio: Any = number("", 0.05, 5)
    """Damping ratio of the contact's spring and damper [-]."""
