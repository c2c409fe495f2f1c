"""How motors are used: operating points against their envelopes, torque, heat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope, torque_limits
from hyperleg_design.sizing.thermal import rms_torque, thermal_use

if TYPE_CHECKING:
    from hyperleg_design.evaluation.rollout import Trial

AT_LIMIT = 1e-6
"""Share of the peak torque within which a motor is at its limit."""


@dataclass(frozen=True, eq=False)
class MotorUse:
    """How every motor of all limbs is used in a trial, `(K,)` each."""

    motors: tuple[str, ...]
    """Names with the limb's in front."""
    rms_torque: np.ndarray
    """Root mean square of the torque [Nm]."""
    peak_torque: np.ndarray
    """Largest magnitude [Nm]."""
    peak_speed: np.ndarray
    """Largest magnitude [rad/s]."""
    limit_share: np.ndarray
    """Share of time on the edge of the envelope [-]."""
    continuous_use: np.ndarray
    """RMS over rated torque [-]."""
    thermal_peak: np.ndarray
    """Largest moving average over 3 s of the squared relative torque, from cold [-]."""
    thermal_peak_printed: np.ndarray
    """Largest square of the moving average of the relative torque, as the paper prints it, from
    cold [-]."""


def motor_use(trial: Trial, first: int = 0, last: int | None = None) -> MotorUse:
    """Compute how the motors are used between two samples.

    Args:
        trial: the recorded trial.
        first: first sample that counts.
        last: first sample that does not count any more; all by default.

    Returns:
        Torque, speed, and use of the limits of each motor. Heat is averaged from the start of the
        trial on, because a winding remembers it.
    """
    limbs, own = len(trial.layout.limbs), trial.layout.leg_motors
    envelope = motor_envelope(trial.design)
    rated = np.tile(motor_arrays(trial.design).rated_torque[:own], limbs)
    part = slice(first, last)
    torque, speed = trial.motor_torque[part], trial.motor_velocity[part]
    heat = thermal_use(trial.motor_torque[:last], rated, trial.time_step)
    rms = rms_torque(torque)
    return MotorUse(
        motors=trial.layout.motors,
        rms_torque=rms,
        peak_torque=np.abs(torque).max(0),
        peak_speed=np.abs(speed).max(0),
        limit_share=at_limit(
            envelope, torque.reshape(-1, limbs, own), speed.reshape(-1, limbs, own)
        )
        .mean(0)
        .reshape(-1),
        continuous_use=rms / rated,
        thermal_peak=heat.peak("ema_of_square"),
        thermal_peak_printed=heat.peak("square_of_ema"),
    )


def at_limit(envelope: MotorEnvelope, motor_torque: Any, motor_velocity: Any) -> np.ndarray:
    """Decide whether operating points lie on the edge of the envelope.

    Args:
        envelope: of the motors.
        motor_torque: `(..., motors)` [Nm].
        motor_velocity: `(..., motors)` [rad/s].

    Returns:
        True on the edge, `(..., motors)`.
    """
    torque = np.asarray(motor_torque, float)
    lower, upper = torque_limits(envelope, motor_velocity)
    slack = AT_LIMIT * envelope.peak_torque
    return np.asarray((torque >= upper - slack) | (torque <= lower + slack))
