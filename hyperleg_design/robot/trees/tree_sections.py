"""The sections of a design that writes its kinematic tree out: typed parameters with units and
bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hyperleg_design.robot.parameters.fields import flag, number, text
from hyperleg_design.robot.parameters.values import Checked


@dataclass(frozen=True, eq=False, kw_only=True)
class Trunk(Checked):
    """The link that the limbs hang from, and how it stands in the world."""

    link: Any = text()
    """Name of the root link."""
    motion: Any = text("floating", "fixed", default="floating")
    """`floating` for a robot that stands on its feet, `fixed` for one on a stand."""
    height: Any = number("m", -10, 10, default=0.0)
    """Height of the origin of a fixed root link above the floor [m]; a floating one stands on its
    pads."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LimbCopy(Checked):
    """One copy of the limb: everything but the trunk, moved and perhaps mirrored."""

    position: Any = number("m", -5, 5, size=3, default=(0.0, 0.0, 0.0))
    """Added to where the limb's first joints stand in the trunk's frame, after mirroring [m]."""
    mirror: Any = flag(default=False)
    """Whether y is mirrored: positions, inertias and axes, so that equal angles are mirrored
    postures."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkSection(Checked):
    """A rigid link; its frame is its joint's, and parallel to the trunk's unless a joint is
    turned.
    """

    mass: Any = number("kg", 0, 500)
    """Mass with the reference actuators [kg]; zero only behind a fixed joint."""
    com: Any = number("m", -5, 5, size=3, default=(0.0, 0.0, 0.0))
    """Centre of mass [m]."""
    gyration: Any = number("m", 0, 3, size=3, default=(0.0, 0.0, 0.0))
    """Radii of gyration about the centre of mass [m]; the inertia is mass * gyration^2."""
    inertia: Any = number("kg m^2", -1e3, 1e3, size=6, default=(0.0,) * 6)
    """xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2], added to that of `gyration`."""
    shape: Any = text("none", "box", "cylinder", "sphere", default="none")
    """Drawn primitive: a cylinder stands along z."""
    size: Any = number("m", 0, 5, size=3, default=(0.0, 0.0, 0.0))
    """Full sizes of a box, radius and length of a cylinder, or radius of a sphere [m]."""
    place: Any = number("m", -5, 5, size=3, default=(0.0, 0.0, 0.0))
    """Middle of the drawn primitive [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TreeJointSection(Checked):
    """A joint between two links."""

    parent: Any = text()
    """Link that it hangs from."""
    child: Any = text()
    """Link that it carries."""
    type: Any = text("revolute", "fixed", default="revolute")
    """`revolute`, or `fixed` for a joint that is locked at zero."""
    position: Any = number("m", -5, 5, size=3, default=(0.0, 0.0, 0.0))
    """Position of the child's frame in the parent's [m]."""
    turn_deg: Any = number("deg", -360, 360, size=3, default=(0.0, 0.0, 0.0))
    """Roll, pitch and yaw of the child's frame in the parent's, as in URDF [deg]."""
    axis: Any = number("", -1, 1, size=3, default=(0.0, 1.0, 0.0))
    """Unit vector in the child's frame [-]."""
    lower_deg: Any = number("deg", -720, 720, default=-180.0)
    """Lower end of the range of motion [deg]."""
    upper_deg: Any = number("deg", -720, 720, default=180.0)
    """Upper end of the range of motion [deg]."""
    default_deg: Any = number("deg", -720, 720, default=0.0)
    """Posture to which actions are added [deg]."""
    coulomb: Any = number("Nm", 0, 100, default=0.0)
    """Coulomb friction [Nm]."""
    viscous: Any = number("Nm s/rad", 0, 50, default=0.0)
    """Viscous friction [Nm s/rad]."""
    stiffness: Any = number("Nm/rad", 0, 10000, default=0.0)
    """Position gain of the joint controller [Nm/rad]."""
    damping: Any = number("Nm s/rad", 0, 1000, default=0.0)
    """Velocity gain of the joint controller [Nm s/rad]."""
    derate: Any = number("", 0.05, 1, default=1.0)
    """Fraction of the summed peak torque that the design counts on [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TreeActuator(Checked):
    """A motor with its gear, of one limb."""

    motor: Any = text(varies=True)
    """Name in the motor catalogue."""
    gear: Any = number("", 0.5, 500)
    """Reduction of the gear at the motor [-]."""
    housed_in: Any = text()
    """Link that carries it."""
    place: Any = number("m", -5, 5, size=3, default=(0.0, 0.0, 0.0))
    """Where in that link it sits [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceActuator(Checked):
    """The motor and gear for which the masses of the links are declared."""

    motor: Any = text()
    """Name in the motor catalogue."""
    gear: Any = number("", 0.5, 500)
    """Reduction of the gear [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rod(Checked):
    """A posture-dependent linkage: a crank on one link and a rod to another.

    The gear turns the crank; the rod keeps its length, that of the zero posture, whatever the
    joints between the two links do.
    """

    carrier: Any = text()
    """Link in which the crank turns."""
    end: Any = text()
    """Link that the rod pushes, behind one or more joints from the carrier."""
    axis: Any = number("", -1, 1, size=3, default=(0.0, 1.0, 0.0))
    """Unit vector about which the crank turns, in the carrier's frame [-]."""
    crank_axis: Any = number("m", -5, 5, size=3)
    """A point of that axis in the carrier's frame [m]."""
    crank_end: Any = number("m", -5, 5, size=3)
    """Where the rod is held by the crank, zero posture, in the carrier's frame [m]."""
    rod_end: Any = number("m", -5, 5, size=3)
    """Where the rod is held by the other link, in that link's frame [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PadSection(Checked):
    """A spherical pad that touches the ground."""

    link: Any = text()
    """Link that carries it."""
    position: Any = number("m", -5, 5, size=3)
    """Position of the pad's centre in the link's frame [m]."""
    radius: Any = number("m", 0, 0.3, default=0.0)
    """Radius of the pad [m]; zero stands for `contact.pad_radius`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TreeMassModel(Checked):
    """How masses follow from the choice of motors and gears."""

    law: Any = text("components", "fixed", default="components")
    """`components`: a link's mass changes by the actuators it houses now less the reference ones;
    `fixed`: the declared masses whatever the motors."""
    gear_mass_per_torque: Any = number("kg/Nm", 0, 0.2, default=0.01)
    """Gear mass over its peak output torque [kg/Nm]."""
    expected_total: Any = number("kg", 0, 5000, default=0.0)
    """Published mass of the robot, checked on loading; 0 for no check [kg]."""
