"""What is wrong with newcomers' robots in the words of the catalogue: the effect, what equals it,
and the parameter that is its size.
"""

from __future__ import annotations

from collections.abc import Mapping

from hyperleg_design.validation.benchmark.case import Fault

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


def fault_of(
    what: str, places: tuple[str, ...], size: float, values: Mapping[str, float] | None = None
) -> Fault:
    """State one thing that is wrong in the words of the catalogue.

    Args:
        what: a key of `EFFECTS`, or the name of something that the catalogue lacks.
        places: names that count as its place, the proper one first.
        size: of what is wrong.
        values: true values by the catalogue's names where they are not just the size.

    Returns:
        The fault, with the effects that logs cannot tell from it.
    """
    if what not in EFFECTS:
        return Fault(what.replace(" ", "_"), (), listed=False)
    if what == "late":
        places = ("robot",)
    if values is None:
        values = {SIZES[what]: float(size)} if what in SIZES else {}
    return Fault(EFFECTS[what], places, values, tuple((e, places) for e in ALIKE.get(what, ())))
