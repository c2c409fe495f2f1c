"""The sections of a design: typed parameters with units and bounds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from hyperleg_design.robot.parameters.fields import flag, number, text
from hyperleg_design.robot.parameters.values import Checked


@dataclass(frozen=True, eq=False, kw_only=True)
class Pelvis(Checked):
    """The trunk; its origin lies midway between the hip centres."""

    mass: Any = number("kg", 0.1, 200)
    """Mass [kg]."""
    height: Any = number("m", 0.02, 2)
    """Height from the hip-pitch axis to the top [m]."""
    depth: Any = number("m", 0.02, 1)
    """Front to back, of the drawn box [m]."""
    width: Any = number("m", 0.02, 1)
    """Left to right, of the drawn box [m]."""
    com: Any = number("m", -1, 1, size=3)
    """Centre of mass from the origin [m]."""
    gyration: Any = number("m", 0.001, 1, size=3)
    """Radii of gyration about the centre of mass [m]; inertia = mass * gyration^2."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Hip(Checked):
    """Three intersecting axes, yaw, roll, pitch; the two carriers between them belong to the
    thigh's mass.
    """

    spacing: Any = number("m", 0.02, 1)
    """Distance between the two hip centres [m]."""
    yaw_carrier_mass: Any = number("kg", 1e-3, 20)
    """Part that turns with yaw only [kg], counted in the thigh's mass."""
    roll_carrier_mass: Any = number("kg", 1e-3, 20)
    """Part that turns with yaw and roll only [kg], counted in the thigh's mass."""
    carrier_gyration: Any = number("m", 0.001, 0.5)
    """Radius of gyration of either carrier about each axis [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Segment(Checked):
    """Thigh or shank: a long segment that hangs from its upper joint."""

    mass: Any = number("kg", 0.01, 50)
    """Mass with the reference build's actuators [kg]."""
    length: Any = number("m", 0.05, 2)
    """Distance between its two joints [m]."""
    com_fraction: Any = number("", 0, 1)
    """Distance of the centre of mass below the upper joint, over the length [-]."""
    com_forward: Any = number("m", -0.5, 0.5)
    """Centre of mass ahead of the line between the joints [m]."""
    com_outward: Any = number("m", -0.5, 0.5)
    """Centre of mass outside the line between the joints [m]."""
    gyration_fraction: Any = number("", 0.01, 1, size=3)
    """Radii of gyration over the length, about x, y, z through the centre of mass [-]."""
    radius: Any = number("m", 0.005, 0.3)
    """Radius of the drawn capsule [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Foot(Checked):
    """The foot, from the ankle to the toe axis; pitch and roll axes of the ankle intersect."""

    mass: Any = number("kg", 0.01, 20)
    """Mass with the ankle's cross [kg]."""
    cross_mass: Any = number("kg", 1e-4, 5)
    """Part between ankle pitch and roll [kg], counted in the foot's mass."""
    cross_gyration: Any = number("m", 0.001, 0.2)
    """Radius of gyration of the cross about each axis [m]."""
    ankle_height: Any = number("m", 0.01, 0.5)
    """Ankle axis above the sole [m]."""
    heel_length: Any = number("m", 0.0, 0.5)
    """Heel behind the ankle axis [m]."""
    ball_length: Any = number("m", 0.01, 0.6)
    """Toe axis ahead of the ankle axis [m]."""
    width: Any = number("m", 0.01, 0.5)
    """Width of the sole [m]."""
    com: Any = number("m", -0.5, 0.5, size=3)
    """Centre of mass from the ankle [m], y outward."""
    gyration: Any = number("m", 0.001, 0.5, size=3)
    """Radii of gyration about the centre of mass [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Toe(Checked):
    """All that lies ahead of the toe axis."""

    mass: Any = number("kg", 0, 10)
    """Mass [kg]; zero only where the toe is locked."""
    joint: Any = text("active", "locked", "passive", default="active")
    """`active`, `locked` straight to the foot, or `passive`: a spring and a damper, no motor."""
    stiffness: Any = number("Nm/rad", 0, 1000, default=15.0)
    """Stiffness of the spring of a passive toe, which rests at the joint's default posture
    [Nm/rad]."""
    damping: Any = number("Nm s/rad", 0, 50, default=0.3)
    """Damping of a passive toe, added to the joint's viscous friction [Nm s/rad]."""
    length: Any = number("m", 0.005, 0.3)
    """Tip ahead of the toe axis [m]."""
    axis_height: Any = number("m", 0.002, 0.2)
    """Toe axis above the sole [m]."""
    com: Any = number("m", -0.2, 0.3, size=3)
    """Centre of mass from the toe axis [m], y outward."""
    gyration: Any = number("m", 0.001, 0.3, size=3)
    """Radii of gyration about the centre of mass [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Joint(Checked):
    """One joint of a leg, the same on both sides."""

    lower_deg: Any = number("deg", -180, 180)
    """Lower end of the range of motion [deg]."""
    upper_deg: Any = number("deg", -180, 180)
    """Upper end of the range of motion [deg]."""
    coulomb: Any = number("Nm", 0, 100)
    """Coulomb friction [Nm]."""
    viscous: Any = number("Nm s/rad", 0, 50)
    """Viscous friction [Nm s/rad]."""
    stiffness: Any = number("Nm/rad", 0, 5000)
    """Position gain of the joint controller [Nm/rad]."""
    damping: Any = number("Nm s/rad", 0, 500)
    """Velocity gain of the joint controller [Nm s/rad]."""
    default_deg: Any = number("deg", -180, 180)
    """Posture to which actions are added [deg]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Joints:
    """The seven joints of a leg."""

    hip_yaw: Joint
    hip_roll: Joint
    hip_pitch: Joint
    knee: Joint
    ankle_pitch: Joint
    ankle_roll: Joint
    toe: Joint


@dataclass(frozen=True, eq=False, kw_only=True)
class Actuator(Checked):
    """A motor with its gear; the ankle has two of the same."""

    motor: Any = text(varies=True)
    """Name in the motor catalogue."""
    gear: Any = number("", 1, 500)
    """Reduction of the gear at the motor [-]."""
    housed_in: Any = text("pelvis", "thigh", "shank")
    """Segment that carries it."""
    position_fraction: Any = number("", 0, 1, default=0.0)
    """Where along thigh or shank it sits, over the length from the upper joint [-]."""
    derate: Any = number("", 0.05, 1)
    """Fraction of the summed peak torque that the design counts on at the joint [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Actuators:
    """The actuators of a leg."""

    hip_yaw: Actuator
    hip_roll: Actuator
    hip_pitch: Actuator
    knee: Actuator
    ankle: Actuator
    toe: Actuator
    toe_installed: Any = flag(default=True)
    """Whether the toe's motor is there."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reductions(Checked):
    """Total reductions in one posture, with the reference build's gears: magnitudes of the entries
    of `joint_from_motor`.
    """

    knee: Any = number("", 0.1, 1000)
    """Knee over each of the knee, ankle and toe motors [-]."""
    ankle_pitch: Any = number("", 0.1, 1000)
    """Ankle pitch over each ankle motor [-]."""
    ankle_roll: Any = number("", 0.1, 1000)
    """Ankle roll over each ankle motor [-]."""
    toe_ankle_pitch: Any = number("", 0, 1000)
    """Ankle pitch over the toe motor [-]."""
    toe: Any = number("", 0.1, 1000)
    """Toe over the toe motor [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkageScale(Checked):
    """Factors on the reductions behind the gears, in every posture: what another pulley or lever
    would do.
    """

    knee: Any = number("", 0.05, 20, default=1.0)
    """Factor on the reductions of the knee [-]."""
    ankle_pitch: Any = number("", 0.05, 20, default=1.0)
    """Factor on the reductions from the ankle motors to ankle pitch [-]."""
    ankle_roll: Any = number("", 0.05, 20, default=1.0)
    """Factor on the reductions of ankle roll [-]."""
    toe_ankle_pitch: Any = number("", 0, 20, default=1.0)
    """Factor on the reduction from the toe motor to ankle pitch [-]; zero decouples the toe motor
    from the ankle."""
    toe: Any = number("", 0.05, 20, default=1.0)
    """Factor on the reduction of the toe [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Linkage(Checked):
    """What the posture-dependent model assumes between and beyond the two printed postures."""

    walking_ankle_pitch_deg: Any = number("deg", -60, 60)
    """Ankle pitch at which the walking reductions hold [deg]; the standing ones hold at zero."""
    walking_toe_deg: Any = number("deg", -65, 65)
    """Toe angle at which the walking reductions hold [deg]."""
    crank_length: Any = number("m", 0.005, 0.2)
    """Crank of each four-bar [m]; only its ratio to the other bars matters."""
    ankle_ground_length: Any = number("m", 0.02, 1)
    """Distance between the axes of the shank's four-bars, knee to ankle [m]."""
    toe_ground_length: Any = number("m", 0.02, 0.5)
    """Distance between the axes of the foot's four-bar, ankle to toe [m]."""
    toe_crank_deg: Any = number("deg", -60, 60)
    """Angle of the foot's crank from the perpendicular to its ground bar, standing [deg]."""
    idler_limit_deg: Any = number("deg", 20, 90)
    """Turn of the toe's idler at the ankle, either way, past which its ratio stays constant
    [deg]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Transmission(Checked):
    """Cooperative actuation of the leg."""

    walking: Reductions
    standing: Reductions
    linkage: Linkage
    scale: LinkageScale = field(default_factory=LinkageScale)
    posture: Any = text("walking", "standing", default="walking")
    """Printed posture whose reductions the models use."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Electrical(Checked):
    """Battery, bus voltage and efficiency of the drivers."""

    constants: Any = text("paper", "vendor", default="paper")
    """Motor constants: the paper's preset where a motor has one, or the vendor's."""
    voltage_ratio: Any = number("", 0.2, 3, default=1.0)
    """Bus voltage over the voltage of the motors' no-load speeds [-]."""
    efficiency_out: Any = number("", 0.05, 1)
    """Efficiency of the driver from battery to motor [-]."""
    efficiency_regen: Any = number("", 0, 1)
    """Efficiency of the driver from motor to battery [-]."""
