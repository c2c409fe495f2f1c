"""Sets of effects that some experiment tells apart from others, by identifier."""

from __future__ import annotations

FRICTION = frozenset(
    {"coulomb_friction", "viscous_friction", "stribeck_friction", "load_dependent_friction"}
)
"""Effects of joints that rub."""
INERTIAL = frozenset({"payload", "link_mass", "link_com"})
"""Masses and where they are."""
LATE = frozenset({"command_delay", "actuator_bandwidth"})
"""What comes late."""
SCALING = frozenset(
    {"torque_constant", "transmission_ratio", "thermal_derating", "controller_gain", "voltage_sag"}
)
"""What scales the torque at a joint."""
WITHOUT_DRIVE = INERTIAL | {"viscous_friction", "coulomb_friction", "joint_spring", "rotor_inertia"}
"""What a joint shows while its drive is off."""
WITH_LOAD = INERTIAL | {"encoder_offset", "joint_spring", "load_dependent_friction"}
"""What changes with a known load otherwise than a scale of the torque does."""
IN_DRIVES = LATE | SCALING - {"transmission_ratio"} | {"torque_saturation"}
"""What changes the torque that a motor gives, before anything that acts at its joints."""
AT_JOINTS = {"rotor_inertia", "joint_spring", "encoder_offset", "cogging"}
"""What is neither friction nor a mass."""
BEYOND_COMMANDS = (
    FRICTION
    | INERTIAL
    | AT_JOINTS
    | {"torque_constant", "thermal_derating"}
    | {"transmission_ratio", "backlash", "transmission_elasticity"}
)
"""What acts behind the torque that a drive measures, and not on what is asked of it."""
BESIDE_TRANSMISSIONS = FRICTION | INERTIAL | IN_DRIVES | AT_JOINTS
"""What leaves the speeds of rotors and joints in their nominal ratio."""
