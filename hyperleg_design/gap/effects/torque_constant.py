"""Motors that give another torque than their current says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.gap.effects.effect import Effect, Parameter
from hyperleg_design.gap.effects.placing import at_motor, driven_motors
from hyperleg_design.simulation.alteration import Alteration, Live, Tick

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.subject import Subject


class TorqueConstant(Effect):
    """A motor's torque is `scale` times the one believed, from its current and the declared constant, or as commanded.

    Trace: (1 - scale) times the believed torque.
    """

    identifier: ClassVar[str] = "torque_constant"
    kind: ClassVar[str] = "motor"
    summary: ClassVar[str] = "a motor gives more or less torque than its current and its data sheet say"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("scale", "", 1.0, 0.3, 2.0, 0.08, "8 % off on a dynamometer (EMBiR)"),)
    linear: ClassVar[bool] = True

    def locations(self, subject: Subject) -> tuple[str, ...]:
        """Motors."""
        return driven_motors(subject)

    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """See `Effect.trace`."""
        motor = signals.subject.motors.index(location)
        return at_motor(signals, motor, (1.0 - np.atleast_2d(values)[:, :1]) * signals.believed[:, motor])

    def alteration(self, location: str, values: np.ndarray, subject: Subject) -> Alteration:
        """See `Effect.alteration`."""
        return ScaledTorque(location, np.asarray(values, float)[..., 0])


@dataclass(frozen=True, eq=False)
class ScaledTorque(Alteration):
    """Torque of a motor over the one that its drive takes itself to give."""

    motor: str
    scale: Any
    """`()` or `(n,)` [-]."""


class _Scaled(Live):
    alteration: ScaledTorque

    def prepare(self) -> None:
        self.place = self.machine.motor(self.alteration.motor)

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        torque[:, self.place] *= self.alteration.scale
        return torque


ScaledTorque.live = _Scaled
