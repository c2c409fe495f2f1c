"""How joints and motors are loaded in a stretch of a trial: stops, vibration, use of the motors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hyperleg_design.evaluation.motion import bearing

if TYPE_CHECKING:
    from hyperleg_design.evaluation.motion.motor_use import MotorUse
    from hyperleg_design.evaluation.rollout import Trial

WHOLE = slice(None)


def load_measures(trial: Trial, use: MotorUse, part: slice = WHOLE) -> dict[str, float]:
    """Compute the measures of the most loaded joint and motor.

    Args:
        trial: the recorded trial.
        use: of its motors in that stretch.
        part: samples of the stretch; all of them by default.

    Returns:
        The measures by name, those of `measures.BEARING` but for `largest_tilt`.
    """
    layout, position, velocity = (
        trial.layout,
        trial.joint_position[part],
        trial.joint_velocity[part],
    )
    return {
        "stop_share": float(bearing.stop_share(position, layout.lower, layout.upper).max()),
        **bearing.stop_measures(
            position,
            velocity,
            None if trial.stop_torque is None else trial.stop_torque[part],
            layout.lower,
            layout.upper,
        ),
        "vibration": float(bearing.vibration(velocity, trial.time_step).max()),
        "limit_share": float(use.limit_share.max()),
        "continuous_use": float(use.continuous_use.max()),
        "thermal_peak": float(use.thermal_peak.max()),
    }
