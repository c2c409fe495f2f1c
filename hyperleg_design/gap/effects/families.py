"""Groups of effects, by identifier: what experiments tell apart, and on what effects act.

A new effect that belongs to a group is entered here; its class may then name the group in
`told_apart`.
"""

from __future__ import annotations

FRICTION = frozenset(
    {"coulomb_friction", "viscous_friction", "stribeck_friction", "load_dependent_friction"}
)
"""Effects that are friction of joints."""
INERTIAL = frozenset({"payload", "link_mass", "link_com"})
"""Masses and centres of mass of links."""
LATE = frozenset({"command_delay", "actuator_bandwidth"})
"""Delays and lags of the drives."""
SCALING = frozenset(
    {"torque_constant", "transmission_ratio", "thermal_derating", "controller_gain", "voltage_sag"}
)
"""Effects that scale the torque at a joint."""
WITHOUT_DRIVE = INERTIAL | {"viscous_friction", "coulomb_friction", "joint_spring", "rotor_inertia"}
"""Effects that show while the drive of a joint is off."""
WITH_LOAD = INERTIAL | {"encoder_offset", "joint_spring", "load_dependent_friction"}
"""Effects that a known load shows, because it changes them in another way than a scale of the
torque."""
IN_DRIVES = LATE | SCALING - {"transmission_ratio"} | {"torque_saturation"}
"""Effects on the torque that a motor gives; effects at the joints act on what is left of it."""
AT_JOINTS = {"rotor_inertia", "joint_spring", "encoder_offset", "cogging"}
"""Further effects at joints, neither friction nor masses of links."""
BEYOND_COMMANDS = (
    FRICTION
    | INERTIAL
    | AT_JOINTS
    | {"torque_constant", "thermal_derating"}
    | {"transmission_ratio", "backlash", "transmission_elasticity"}
)
"""Effects between the torque that a drive measures and the motion of the joints."""
BESIDE_TRANSMISSIONS = FRICTION | INERTIAL | IN_DRIVES | AT_JOINTS
"""Effects under which rotors and joints keep their nominal ratio of speeds."""
