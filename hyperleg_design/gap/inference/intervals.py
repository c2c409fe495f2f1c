"""Values of named causes with their intervals, in the effect's parameters and in words that people
use.
"""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.results.diagnosis import Value

NORMAL = 1.96
"""Standard deviations of a normal distribution's 95 % interval."""


OF_TORQUE = ("Nm", "kg")
"""Beginnings of units that scale with the torques of the drives."""


def intervals(
    cause: Cause,
    values: np.ndarray,
    deviation: np.ndarray,
    subject: Subject,
    torque_error: float = 0.0,
) -> dict[str, Value]:
    """State the values of a cause with 95 % intervals.

    Args:
        cause: the cause.
        values: of its parameters `(k,)`.
        deviation: standard deviations of the values `(k,)`.
        subject: the robot.
        torque_error: standard deviation of the scale of all torques [-].

    Returns:
        Values by the name of the parameter, and what follows from them, in the units of the place.
    """
    stated = {}
    effect = EFFECTS[cause.effect]
    for i, parameter in enumerate(effect.parameters):
        rough = effect.rough.get(parameter.name, 0.0) * abs(values[i])
        if parameter.unit.startswith(OF_TORQUE):
            rough = np.hypot(rough, torque_error * values[i])
        reach = NORMAL * np.hypot(deviation[i], rough)
        low, high = max(values[i] - reach, cause.low[i]), min(values[i] + reach, cause.high[i])
        unit = unit_at(subject, effect.kind, cause.location, parameter.unit)
        stated[parameter.name] = _value(values[i], low, high, unit)
    return stated | _derived(subject, cause, values, stated)


def _derived(
    subject: Subject, cause: Cause, values: np.ndarray, stated: dict[str, Value]
) -> dict[str, Value]:
    """The same in words that people use, with intervals from those of the parameters, each moved
    alone; nothing of what an end of these intervals does not have.
    """
    effect = EFFECTS[cause.effect]
    middle = effect.derived(cause.location, values, subject)
    below, above = dict.fromkeys(middle, 0.0), dict.fromkeys(middle, 0.0)
    for i, parameter in enumerate(effect.parameters):
        own, interval = np.arange(len(values)) == i, stated[parameter.name]
        ends = [np.where(own, end, values) for end in (interval.low, interval.high)]
        tried = [effect.derived(cause.location, end, subject) for end in ends]
        middle = {n: v for n, v in middle.items() if all(n in t for t in tried)}
        for name, (value, _) in middle.items():
            moves = [t[name][0] - value for t in tried]
            below[name] = float(np.hypot(below[name], min(*moves, 0.0)))
            above[name] = float(np.hypot(above[name], max(*moves, 0.0)))
    at = subject, effect.kind, cause.location
    derived = {
        name: _value(value, value - below[name], value + above[name], unit_at(*at, unit))
        for name, (value, unit) in middle.items()
    }
    return {
        name: value
        for name, value in derived.items()
        if np.isfinite([value.value, value.low, value.high]).all()
    }


def _value(value: float, low: float, high: float, unit: str) -> Value:
    """A value without negative zeros, which reports would print as -0."""
    return Value(float(value) + 0.0, float(low) + 0.0, float(high) + 0.0, unit)
