"""What a motor with its gear weighs."""

from __future__ import annotations

from typing import Any

from hyperleg_design.robot import motors


def actuator_mass(motor: Any, gear: Any, gear_mass_per_torque: Any) -> Any:
    """Compute the mass of a motor with its gear: m_motor + k * gear * peak torque.

    Args:
        motor: name of the motor, or an array of names, `(...)`.
        gear: reduction of the gear [-], `(...)`.
        gear_mass_per_torque: k, mass of the gear per output torque [kg/Nm], `(...)`.

    Returns:
        The mass [kg], `(...)`.
    """
    weight = motors.gather(motor, lambda m: m.mass)
    peak = motors.gather(motor, lambda m: m.peak_torque())
    return weight + gear_mass_per_torque * gear * peak
