"""Thermal margin of the motors and its penalty, in both readings of the paper's formula.

The paper prints `h = h_th - EMA(tau / tau_cont)^2`, which leaves open what is squared:

    ema_of_square:  h = h_th - e,    e a moving average of (tau / tau_cont)^2: what heats a motor
    square_of_ema:  h = h_th - e^2,  e a moving average of tau / tau_cont, sign and all, as printed

and penalises `[-(dh/dt + h / T)]+`, with T the time constant of the average. With the same T the
first reading forgets itself: `de/dt = (x - e) / T` gives `-(dh/dt + h / T) = (x - h_th) / T`, the
present overload alone.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.simulation.settings import Thermal


class ThermalState:
    """Moving averages of all motors."""

    def __init__(self, settings: Thermal, shape: tuple[int, ...]) -> None:
        self.settings = settings
        self.average = np.zeros(shape)
        """Of the relative torque, squared or not, `(n, K)`."""

    def reset(self, ids: np.ndarray) -> None:
        """Let the motors of some simulations start cold.

        Args:
            ids: indices of the simulations.
        """
        self.average[ids] = 0.0

    @property
    def margin(self) -> np.ndarray:
        """Margin h of each motor, `(n, K)` [-]; negative where a motor is overloaded."""
        squared = self.average if self.settings.reading == "ema_of_square" else self.average**2
        return np.asarray(self.settings.threshold - squared)

    def advance(self, relative_torque: np.ndarray, duration: float) -> np.ndarray:
        """Go on by one policy step.

        Args:
            relative_torque: tau / tau_cont within the step, `(s, n, K)`.
            duration: of the step [s].

        Returns:
            Sum over motors of `[-(dh/dt + h / T)]+` [1/s], `(n,)`, margin and rate taken at the
            beginning of the step.
        """
        time_constant = self.settings.time_constant
        if self.settings.reading == "ema_of_square":
            load = np.einsum("snk,snk->nk", relative_torque, relative_torque) / len(relative_torque)
            excess = (load - self.settings.threshold) / time_constant
            self.average += (duration / time_constant) * (load - self.average)
        else:
            load = np.add.reduce(relative_torque, 0) / len(relative_torque)
            rate = (load - self.average) / time_constant
            excess = 2 * self.average * rate - self.margin / time_constant
            self.average += duration * rate
        return np.asarray(np.maximum(excess, 0.0).sum(-1))
