"""Thermal use of motors: torque against what they hold for ever, averaged as a winding averages its
heat.

Heat goes with squared torque, so a motor is used continuously by `rms(tau) / tau_rated`, and from
moment to moment by a moving average over the paper's 3 s of the relative torque x = tau /
tau_rated. The paper prints `EMA(tau / tau_cont)^2`, which can be read in two ways, and both are
kept:

    ema_of_square = EMA(x^2)        what heats a winding
    square_of_ema = EMA(x)^2        as printed, sign and all

The average obeys T de/dt = x - e. For samples that hold over a step dt its exact solution is

    e[k] = e[k-1] + alpha (x[k] - e[k-1])        alpha = 1 - exp(-dt / T)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError

TIME_CONSTANT = 3.0
"""Time constant of the moving average [s] (paper, thermal reward)."""

READINGS = ("ema_of_square", "square_of_ema")
"""Both readings of the paper's formula."""


@dataclass(frozen=True, eq=False)
class ThermalUse:
    """How far motors are used thermally; 1 is the limit of what they hold for ever."""

    rms_torque: np.ndarray
    """Root mean square of the torque [Nm], `(..., m)`."""
    continuous_use: np.ndarray
    """RMS over rated torque [-], `(..., m)`."""
    ema_of_square: np.ndarray
    """Moving average of the squared relative torque at the end of each step [-], `(..., t, m)`."""
    square_of_ema: np.ndarray
    """Square of the moving average of the relative torque at the end of each step [-], `(..., t,
    m)`."""

    def peak(self, reading: str = "ema_of_square") -> np.ndarray:
        """Find the largest use over time.

        Args:
            reading: one of `READINGS`.

        Returns:
            The use [-], `(..., m)`.
        """
        return np.asarray(getattr(self, _reading(reading)).max(-2))


def rms_torque(motor_torque: Any) -> np.ndarray:
    """Compute the root of the mean squared torque over time.

    Args:
        motor_torque: [Nm], `(..., t, m)`.

    Returns:
        [Nm], `(..., m)`.
    """
    torque = np.asarray(motor_torque, float)
    return np.sqrt(np.mean(torque**2, -2))


def moving_average(
    samples: Any,
    time_step: float,
    time_constant: float = TIME_CONSTANT,
    *,
    start: Any = 0.0,
    periodic: bool = False,
) -> np.ndarray:
    """Exponential moving average of samples that hold over a step, exact, at the end of each step.

    Args:
        samples: `(..., t, m)`.
        time_step: between samples [s].
        time_constant: of the average, T [s].
        start: average before the first sample, `(..., m)`; nothing by default: cold motors.
        periodic: whether the samples are one cycle of an endless repetition; the start is then that
            of the steady state.

    Returns:
        `(..., t, m)`

    Raises:
        InputError: no samples, or a step or time constant that is not positive.
    """
    values = np.asarray(samples, float)
    if values.ndim < 2 or 0 in values.shape[-2:]:
        raise InputError(
            "thermal",
            "samples",
            list(values.shape),
            "is the shape found; expects samples over time of each motor, (..., t, m)",
        )
    for field, value in (("time_step", time_step), ("time_constant", time_constant)):
        if not (np.isfinite(value) and value > 0):
            raise InputError("thermal", field, value, "expects a positive number in s")
    if periodic:
        final = _filtered(
            values, time_step, time_constant, np.zeros(values.shape[:-2] + values.shape[-1:])
        )[..., -1, :]
        # a cycle forgets exp(-n dt / T) of its start and adds `final`
        start = final / -np.expm1(-values.shape[-2] * time_step / time_constant)
    return _filtered(values, time_step, time_constant, start)


def _filtered(values: np.ndarray, time_step: float, time_constant: float, start: Any) -> np.ndarray:
    from scipy.signal import lfilter

    keep = np.exp(-time_step / time_constant)
    first = np.broadcast_to(np.asarray(start, float), values.shape[:-2] + values.shape[-1:])[
        ..., None, :
    ]
    result, _ = lfilter(
        [-np.expm1(-time_step / time_constant)], [1.0, -keep], values, axis=-2, zi=keep * first
    )
    return np.asarray(result)


def thermal_use(
    motor_torque: Any,
    rated_torque: Any,
    time_step: float,
    time_constant: float = TIME_CONSTANT,
    *,
    periodic: bool = False,
) -> ThermalUse:
    """Thermal use of motors over time.

    Args:
        motor_torque: [Nm], `(..., t, m)`.
        rated_torque: continuous torque [Nm], `(..., m)`.
        time_step: between samples [s].
        time_constant: of the moving averages [s].
        periodic: whether the samples are one cycle of an endless repetition (a gait); else motors
            begin cold.

    Returns:
        Use of each motor; 1 where it is as hot as at its rated torque for ever.

    Raises:
        InputError: as `moving_average`; a rated torque that is not positive.
    """
    torque, rated = np.asarray(motor_torque, float), _rated(rated_torque)
    if not np.all(np.isfinite(torque)):
        raise InputError(
            "thermal",
            "motor_torque",
            float(torque[~np.isfinite(torque)][0]),
            "expects finite numbers in Nm",
        )
    if torque.ndim < 2:
        raise InputError(
            "thermal",
            "motor_torque",
            list(torque.shape),
            "is the shape found; expects samples over time of each motor, (..., t, m)",
        )
    relative = torque / (rated[..., None, :] if rated.ndim else rated)
    rms = rms_torque(torque)
    return ThermalUse(
        rms_torque=rms,
        continuous_use=rms / rated,
        ema_of_square=moving_average(relative**2, time_step, time_constant, periodic=periodic),
        square_of_ema=moving_average(relative, time_step, time_constant, periodic=periodic) ** 2,
    )


def _rated(value: Any) -> np.ndarray:
    rated = np.asarray(value, float)
    if not np.all(np.isfinite(rated) & (rated > 0)):
        raise InputError(
            "thermal", "rated_torque", rated.tolist(), "expects positive numbers in Nm"
        )
    return rated


def _reading(name: str) -> str:
    if name not in READINGS:
        raise InputError("thermal", "reading", name, f"expects one of {', '.join(READINGS)}")
    return name
