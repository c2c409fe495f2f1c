"""What is wrong with newcomers' robots in the words of the catalogue: the effect, what equals it,
and the parameter that is its size.
"""

EFFECTS = {
    "load": "payload",
    "dry": "coulomb_friction",
    "rough": "coulomb_friction",
    "viscous": "viscous_friction",
    "thick": "viscous_friction",
    "weak": "torque_constant",
    "late": "command_delay",
    "lag": "actuator_bandwidth",
    "zero": "encoder_offset",
    "gain": "controller_gain",
    "rotor": "rotor_inertia",
    "spring": "joint_spring",
    "breakaway": "stribeck_friction",
    "limit": "torque_saturation",
    "lossy": "load_dependent_friction",
    "soft": "transmission_elasticity",
    "play": "backlash",
}
"""In the catalogue; what stands not here is outside it."""
ALIKE = {
    "load": ("link_mass",),
    "viscous": ("controller_gain",),
    "thick": ("controller_gain",),
    "weak": ("transmission_ratio", "controller_gain"),
    "soft": ("backlash",),
    "play": ("transmission_elasticity",),
    "rough": ("stribeck_friction",),
}
"""Effects in the same place that logs without rotor speeds do not tell from it, or that differ only
in a shape at the lowest speeds."""
SIZES = {
    "load": "mass",
    "dry": "torque",
    "viscous": "damping",
    "weak": "scale",
    "late": "delay",
    "lag": "time_constant",
    "zero": "offset",
    "gain": "stiffness_scale",
    "spring": "stiffness",
    "lossy": "coefficient",
}
"""Parameter of the catalogue whose true value is the size of what is wrong."""
