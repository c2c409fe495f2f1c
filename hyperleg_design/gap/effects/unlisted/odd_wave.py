"""Torque at a joint that repeats with time, or with the motor's angle in proportion to the load."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placing import at_joint, motor_position
from hyperleg_design.gap.effects.unlisted.flexible import Flexible, parameters
from hyperleg_design.gap.effects.unlisted.inputs import relative_load
from hyperleg_design.gap.effects.waves import fitted_waves
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.sliding import sliding

TURNS = np.arange(1.0, 49.0)
"""Periods a turn of the motor that are tried [-]."""
FASTEST = 12.0
"""Frequency in time up to which waves are looked for [Hz] (assumed)."""
INPUTS = {"motor": "in proportion to the load, with the angle of its motor", "time": "with time"}
FEWEST = 64
"""Known ticks that tell waves."""


class OddWave(Flexible):
    """A joint takes a torque of two waves, (c cos x + s sin x) each: of the motor's angle times the
    load, or of time.

    Trace: that torque. The orders are those of the wave that fits each log best, and of the one
    that fits best beside it.
    """

    identifier: ClassVar[str] = "odd_wave"
    summary: ClassVar[str] = "a joint takes a torque that repeats with load and motor, or time"
    inputs: ClassVar[Mapping[str, str]] = INPUTS
    sentence: ClassVar[str] = "takes a torque that repeats"
    parameters: ClassVar[tuple[Parameter, ...]] = parameters(4, "Nm", INPUTS, ("first", "second"))

    @override
    def odds(self, location: str, subject: Subject, values: np.ndarray) -> float:
        """Each of the inputs is as likely, and each of the orders of both waves."""
        return super().odds(location, subject, values) - 2 * float(np.log(len(TURNS)))

    @override
    def describe(self, values: np.ndarray) -> str:
        sizes, orders = np.hypot(values[:4:2], values[1:4:2]), values[4:6]
        order = float(orders[np.argmax(sizes)])
        if self.input_of(values) == "time":
            return f"{super().describe(values)}, at {order / (2 * np.pi):.2g} Hz"
        return f"{super().describe(values)}, {order:.3g} times a turn"

    @override
    def variants(self, signals: Signals, location: str) -> np.ndarray:
        variants = super().variants(signals, location)
        joint = signals.subject.joints.index(location)
        residual = signals.residual["motion"][:, joint]
        known = np.isfinite(residual) & signals.valid
        if known.sum() < FEWEST:
            return variants[:0]
        q, v, a = (x[:, joint] for x in (signals.position, signals.velocity, signals.acceleration))
        way, load = sliding(signals)[:, joint], signals.rigid[:, joint]
        other = [np.ones_like(q), q, np.cos(q), np.sin(q), v, way, a, load]
        beside = np.linalg.qr(np.nan_to_num(np.stack(other, -1)[known]))[0]
        for row, name in zip(variants, INPUTS, strict=True):
            angle, factor, orders = _waves(signals, joint, name)
            taken = beside
            for place in (4, 5):
                gains, _ = fitted_waves(residual[known], angle[known], orders, taken, factor[known])
                row[place] = order = orders[np.argmax(gains)]
                turned = order * angle[known, None]
                wave = factor[known, None] * np.concatenate([np.cos(turned), np.sin(turned)], 1)
                taken = np.linalg.qr(np.concatenate([taken, wave], 1))[0]
        return variants

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        joint = signals.subject.joints.index(location)
        settings = np.atleast_2d(np.asarray(values, float))
        angle, factor, _ = _waves(signals, joint, self.input_of(settings))
        turned = settings[:, 4:6, None] * angle
        sizes = settings[:, :4].reshape(-1, 2, 2)
        torque = sizes[:, :, :1] * np.cos(turned) + sizes[:, :, 1:] * np.sin(turned)
        return at_joint(signals, joint, factor * torque.sum(1))


def _waves(signals: Signals, joint: int, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle and factor of the waves `(t,)` each, and the orders that are tried `(o,)`."""
    if name == "time":
        span = max(float(signals.time[-1] - signals.time[0]), 1e-9)
        orders = 2 * np.pi * np.arange(1.0, FASTEST * span) / span
        return signals.time - signals.time[0], np.ones(len(signals.time)), orders
    motor = int(np.argmax(np.abs(signals.subject.joint_from_motor[joint])))
    return motor_position(signals, motor), relative_load(signals, joint), TURNS
