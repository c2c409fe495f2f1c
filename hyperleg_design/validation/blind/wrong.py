"""What is wrong with a plant: an effect of the catalogue or an oddity outside it, its place and its
size in the plant's own terms.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

CATALOGUE = (
    "coulomb_friction",
    "viscous_friction",
    "stribeck_friction",
    "load_dependent_friction",
    "torque_constant",
    "torque_saturation",
    "thermal_derating",
    "voltage_sag",
    "command_delay",
    "actuator_bandwidth",
    "rotor_inertia",
    "transmission_elasticity",
    "backlash",
    "transmission_ratio",
    "encoder_offset",
    "controller_gain",
    "payload",
    "link_mass",
    "link_com",
    "cogging",
    "joint_spring",
    "imu_bias",
    "ground_friction",
    "ground_compliance",
)
"""Identifiers of the effects that a diagnosis knows; written out here, not imported, so that the
trial checks them."""

WALKING_ONLY = ("imu_bias", "ground_friction", "ground_compliance")
"""Effects that a fixed base cannot show."""

ODDITIES = (
    "torque_ripple",
    "friction_patch",
    "hysteresis",
    "packet_loss",
    "tilted_gravity",
    "periodic_push",
    "hardening_spring",
    "cross_coupling",
    "sensor_drift",
    "fluid_drag",
    "encoder_eccentricity",
)
"""Effects outside the catalogue; a diagnosis that names one of its own for them is wrong."""


@dataclass(frozen=True)
class Wrong:
    """One effect at one place."""

    effect: str
    """One of `CATALOGUE` or `ODDITIES`."""
    location: str
    """Joint, motor, link, foot, `imu`, `battery` or `robot`."""
    size: float
    """In the unit that the plants give this effect."""
    shape: Mapping[str, float]
    """What else it needs, such as the order of cogging."""

    @property
    def listed(self) -> bool:
        """Whether the catalogue has it."""
        return self.effect in CATALOGUE


@dataclass(frozen=True)
class Size:
    """How large an effect can be."""

    unit: str
    smallest: float
    largest: float


SIZES: dict[str, Size] = {
    # friction at a joint, over its mean nominal torque capacity
    "coulomb_friction": Size("of the joint's peak torque", 0.002, 0.25),
    "viscous_friction": Size("of the joint's peak torque at 1 rad/s", 0.002, 0.3),
    "stribeck_friction": Size("of the joint's peak torque", 0.004, 0.3),
    "load_dependent_friction": Size("of the transmitted torque", 0.01, 0.45),
    "torque_constant": Size("1 - true torque / declared", 0.03, 0.35),
    "torque_saturation": Size("1 - true limit / the log's own largest torque", 0.02, 0.75),
    "thermal_derating": Size("1 / (100 K)", 0.05, 0.9),
    "voltage_sag": Size(
        "share of the voltage lost at the log's largest power, and at rest", 0.03, 0.75
    ),
    "command_delay": Size("s", 0.001, 0.030),
    "actuator_bandwidth": Size("time constant, s", 0.001, 0.040),
    "rotor_inertia": Size("share of the nominal rotor's", 0.1, 3.0),
    "transmission_elasticity": Size("nominal stiffness over true", 1.5, 400.0),
    "backlash": Size("rad at the joint", 0.0005, 0.06),
    "transmission_ratio": Size("true ratio over nominal - 1", 0.01, 0.2),
    "encoder_offset": Size("rad", 0.004, 0.12),
    "controller_gain": Size("true gain over nominal - 1", 0.02, 0.6),
    "payload": Size("kg", 0.01, 5.0),
    "link_mass": Size("true mass over nominal - 1", 0.06, 0.8),
    "link_com": Size("m", 0.002, 0.12),
    "cogging": Size("of the motor's peak torque", 0.002, 0.3),
    "joint_spring": Size("of the joint's peak torque per rad", 0.005, 0.6),
    "torque_ripple": Size("of the motor's torque", 0.02, 0.7),
    "friction_patch": Size("of the joint's peak torque", 0.005, 0.4),
    "hysteresis": Size("of the joint's peak torque", 0.005, 0.4),
    "packet_loss": Size("share of time", 0.01, 0.5),
    "tilted_gravity": Size("rad", 0.01, 0.35),
    "periodic_push": Size("of the joint's peak torque", 0.01, 0.6),
    "hardening_spring": Size("of the joint's peak torque per rad^3", 0.02, 8.0),
    "cross_coupling": Size("of the joint's peak torque per rad of another joint", 0.01, 1.0),
    "sensor_drift": Size("rad/s", 0.0003, 0.02),
    "fluid_drag": Size("of the joint's peak torque at 1 rad/s", 0.002, 0.5),
    "encoder_eccentricity": Size("rad", 0.002, 0.1),
}
"""Units of `Wrong.size` and the range in which a case's size is sought."""
