"""What a motor with its gear weighs."""

from __future__ import annotations

from typing import Any

from hyperleg_design.robot import motors


def actuator_mass(motor: Any, gear: Any, gear_mass_per_torque: Any) -> Any:
    """Mass of motor and gear [kg]: m_motor + k * gear * peak torque, `(...)`."""
    weight = motors.gather(motor, lambda m: m.mass)
    peak = motors.gather(motor, lambda m: m.peak_torque())
    return weight + gear_mass_per_torque * gear * peak
