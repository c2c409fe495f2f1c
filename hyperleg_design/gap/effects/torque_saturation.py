"""Drives that give less torque than the model allows."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.placing import before_measurement, commanded, driven_motors, is_commanded, limited, motor_strength
from hyperleg_design.simulation.alteration import Alteration, Limits, Live, Tick

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject

NEVER = 1000.0
"""Limit that stands for none [Nm]: no motor on its own side of the transmission reaches it."""
_QUANTILES = (0.97, 0.9, 0.8, 0.6)


class TorqueSaturation(Effect):
    """A drive stops at a torque below the limit of the model.

    Trace, by the rule of `placing`: the command within the lower limit minus the command within the nominal ones. A log without
    commands cannot show it.
    """

    identifier: ClassVar[str] = "torque_saturation"
    kind: ClassVar[str] = "motor"
    summary: ClassVar[str] = "a drive limits its torque (or current) to less than the model's limit"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("limit", "Nm", NEVER, 1e-3, NEVER, 0.4 * NEVER, "drives' current limits of 50-80 % of the peak (assumed); `usual` knows the motor"),
    )

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Motors."""
        return driven_motors(subject)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """See `Effect.trace`."""
        motor = signals.subject.motors.index(location)
        if not is_commanded(signals, motor):
            return {}
        asked = commanded(signals, motor)
        limit = np.atleast_2d(np.asarray(values, float))[:, :1]
        change = np.where(limit < NEVER, limited(signals, motor, asked, peak=limit) - limited(signals, motor, asked), 0.0 * asked)
        return before_measurement(signals, {motor: change})

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`."""
        return LowerLimit(location, np.asarray(values, float)[..., 0])

    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """From no limit to 60 % of the torque that the motor is made for."""
        return np.array([NEVER - 0.6 * motor_strength(subject, subject.motors.index(location))])

    def example(self, location: str, subject: Subject, size: float = 1.0) -> np.ndarray:
        """A limit that slow motion reaches, the lower the larger."""
        return np.array([0.1 * motor_strength(subject, subject.motors.index(location)) / max(size, 0.1)])

    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """Torques that the command of this log exceeds ever more often."""
        motor = signals.subject.motors.index(location)
        if not is_commanded(signals, motor):
            return super().starts(signals, location)
        asked = np.abs(limited(signals, motor, commanded(signals, motor)))
        return np.clip(np.nanquantile(asked, _QUANTILES), self.parameters[0].low, NEVER)[:, None]


@dataclass(frozen=True, eq=False)
class LowerLimit(Alteration):
    """Largest torque of a motor, where it is below the machine's."""

    motor: str
    limit: Any
    """`()` or `(n,)` [Nm]."""


class _Lower(Live):
    alteration: LowerLimit

    def prepare(self) -> None:
        self.place = self.machine.motor(self.alteration.motor)

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        peak = np.array(np.broadcast_to(limits.peak_torque, (self.count, len(self.machine.motors))), float)
        limit = np.asarray(self.alteration.limit, float)
        peak[:, self.place] = np.where(limit < NEVER, np.minimum(peak[:, self.place], limit), peak[:, self.place])
        return dataclasses.replace(limits, peak_torque=peak)


LowerLimit.live = _Lower
