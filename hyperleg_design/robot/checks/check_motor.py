"""Whether the constants of a motor agree with one another."""

from __future__ import annotations

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.motor import HEAT_FACTOR, Motor

FAR = 1.5
"""Factor between no-load voltage and nominal voltage from which a unit is suspected [-]; of the
shipped motors none is past 1.23."""


def check_motor(motor: Motor) -> list[Finding]:
    """Compare the back-EMF at the no-load speed with the nominal voltage.

    In SI units the back-EMF constant equals the torque constant over direct current,
    `Kt / sqrt(f)` with the factor f of the power constant, so `Kt omega_0 / sqrt(f)` is the voltage
    without load.

    Args:
        motor: as its file describes it.

    Returns:
        A warning where the two differ by more than a factor `FAR`.
    """
    factor = HEAT_FACTOR[motor.current_convention] ** 0.5
    speed = motor.no_load_speed("vendor")
    fits = motor.nominal_voltage * factor / speed
    if 1 / FAR <= motor.torque_constant / fits <= FAR:
        return []
    message = (
        f"is {motor.torque_constant:.4g} Nm/A, {motor.torque_constant / fits:.3g} times what "
        f"nominal_voltage over no_load_speed_rpm gives ({fits:.3g} Nm/A)"
    )
    remedy = "correct the units of the three, or the current of the convention"
    return [Finding("warning", "constants.torque_constant", message, remedy)]
