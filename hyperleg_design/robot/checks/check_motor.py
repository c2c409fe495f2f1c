"""Whether the constants of a motor agree with one another."""

from __future__ import annotations

from hyperleg_design.robot.checks.finding import Finding
from hyperleg_design.robot.motor import HEAT_FACTOR, Motor

FAR = 1.5
"""Factor between no-load voltage and nominal voltage from which a unit is suspected [-]; of the
shipped motors none is past 1.23."""


def check_motor(motor: Motor) -> list[Finding]:
    """Compare the back-EMF at the no-load speed with the nominal voltage, and the stall torque with
    the peak torque.

    In SI units the back-EMF constant equals the torque constant over direct current,
    `Kt / sqrt(f)` with the factor f of the power constant, so `Kt omega_0 / sqrt(f)` is the voltage
    without load.

    Args:
        motor: as its file describes it.

    Returns:
        A warning where the two voltages differ by more than a factor `FAR`; else one where the
        stall torque that resistance, torque constant and no-load speed give is below the peak
        torque, which no drive then reaches.
    """
    return _of_back_emf(motor) or _of_stall(motor)


def _of_back_emf(motor: Motor) -> list[Finding]:
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


def _of_stall(motor: Motor) -> list[Finding]:
    stall, peak = motor.stall_torque("vendor"), motor.peak_torque("vendor")
    if stall >= peak:
        return []
    message = (
        f"is {peak:.4g} Nm, more than the stall torque of {stall:.4g} Nm that resistance, "
        f"torque_constant and no_load_speed_rpm give at {motor.nominal_voltage:g} V"
    )
    remedy = "correct their units, resistance (phase or line_line), or the peak torque"
    return [Finding("warning", "constants.peak_torque", message, remedy)]
