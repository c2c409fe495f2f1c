"""Drives that give less torque than the model allows."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence, Set
from typing import ClassVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from typing_extensions import override

from hyperleg_design.gap.effects.excitation import Need
from hyperleg_design.gap.effects.families import BEYOND_COMMANDS
from hyperleg_design.gap.effects.kinds import MotorEffect
from hyperleg_design.gap.effects.parameter import Parameter
from hyperleg_design.gap.effects.placed import MotorHooks
from hyperleg_design.gap.effects.placing import (
    before_measurement,
    commanded,
    is_commanded,
    limited,
)
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.memoized import memoized
from hyperleg_design.simulation.alteration import Tick
from hyperleg_design.simulation.drives.limits import Limits

_QUANTILES = (0.97, 0.9, 0.8, 0.6)
_NEEDED = 0.95
LEAST = 0.03
"""Limit over the torque that the motor is made for (assumed: current limits of 5 % are set by
nobody)."""
HELD, SENSED = 3, 1.1
"""Ticks in a row in which a measured torque is no outlier, and how much too large a sensor may tell
it [-] (assumed)."""
NEAR = 0.95
"""Largest limit over the model's [-]: simulators cut the torque after the error of a torque
constant, drives the current before it (assumed)."""
SOURCE = "drives' current limits of 50-80 % of the peak (assumed); `usual` knows the motor"


def _limit(inverse: np.ndarray) -> np.ndarray:
    """Limit [Nm], infinite where there is none."""
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.maximum(inverse, 0.0))


@memoized
def _held(signals: Signals) -> np.ndarray:
    """Largest torque of each motor that was measured for `HELD` ticks in a row `(m,)` [Nm]."""
    assert signals.measured is not None
    torque = np.nan_to_num(np.abs(signals.measured))
    return np.asarray(sliding_window_view(torque, HELD, 0).min(-1).max(0))


class _Lower(MotorHooks):
    inverse_limit: np.ndarray

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        peak = np.array(
            np.broadcast_to(limits.peak_torque, (self.count, len(self.machine.motors))), float
        )
        peak[:, self.place] = np.minimum(peak[:, self.place], _limit(self.inverse_limit))
        return dataclasses.replace(limits, peak_torque=peak)


class TorqueSaturation(MotorEffect):
    """A drive stops at a torque below the limit of the model: at 1 / inverse_limit, so that 0 is no
    limit.

    Trace, by the rule of `placing`: the command within the lower limit minus the command within the
    nominal ones. A log without commands cannot show it.
    """

    identifier: ClassVar[str] = "torque_saturation"
    summary: ClassVar[str] = "a drive limits its torque (or current) to less than the model's limit"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter("inverse_limit", "1/Nm", 0.0, 0.0, 1e3, 0.1, SOURCE),
    )
    hooks: ClassVar[type[MotorHooks]] = _Lower
    holds_back: ClassVar[bool] = True
    needs: ClassVar[Need] = Need(
        lambda motion: motion.swinging,
        "commands of different size",
        "commands hardly change",
        asked=True,
    )
    told_apart: ClassVar[Mapping[str, Set[str]]] = {"log torque or current": BEYOND_COMMANDS}

    @override
    def trace(self, signals: Signals, location: str, values: np.ndarray) -> dict[str, np.ndarray]:
        motor = signals.subject.motors.index(location)
        if not is_commanded(signals, motor):
            return {}
        asked = commanded(signals, motor)
        limit = _limit(np.atleast_2d(np.asarray(values, float))[:, :1])
        lower = limited(signals, motor, asked, peak=limit)
        return before_measurement(signals, {motor: lower - limited(signals, motor, asked)})

    @override
    def usual(self, location: str, subject: Subject) -> np.ndarray:
        """A limit of 60 % of the torque that the motor is made for."""
        return np.array([1 / (0.6 * self.strength(location, subject))])

    @override
    def example(self, location: str, subject: Subject, size: float = 1.0) -> np.ndarray:
        """A limit that slow motion reaches, the lower the larger."""
        return np.array([size / (0.1 * self.strength(location, subject))])

    @override
    def bounds(self, location: str, subject: Subject) -> np.ndarray:
        """A drive that gives next to nothing is no limited one."""
        low, high = super().bounds(location, subject)
        return np.array([low, np.minimum(high, 1 / (LEAST * self.strength(location, subject)))])

    @override
    def shown_bounds(self, logs: Sequence[Signals], location: str) -> np.ndarray:
        """No limit is below the torque that was measured, or by an error of the sensor, and none is
        so near the model's that an error of the torque constant makes the difference.
        """
        low, high = super().shown_bounds(logs, location)
        motor = logs[0].subject.motors.index(location)
        for signals in logs:
            if signals.measured is not None:
                high = np.minimum(high, SENSED / max(float(_held(signals)[motor]), 1e-9))
        most = NEAR * float(logs[0].subject.torque_limit[motor])
        return np.array([np.maximum(low, 1 / most), high])

    @override
    def starts(self, signals: Signals, location: str) -> np.ndarray:
        """The torque that the motion hardly ever needs more than, and torques that the command of
        this log exceeds ever more often.
        """
        motor = signals.subject.motors.index(location)
        if not is_commanded(signals, motor):
            return super().starts(signals, location)
        asked = np.abs(limited(signals, motor, commanded(signals, motor)))
        needed = np.abs(applied(signals.subject.motor_from_joint[motor : motor + 1], signals.rigid))
        limits = np.append(np.nanquantile(needed, _NEEDED), np.nanquantile(asked, _QUANTILES))
        most = self.bounds(location, signals.subject)[1]
        return np.minimum(1 / np.maximum(limits, 1e-9), most)[:, None]

    @override
    def derived(
        self, location: str, values: np.ndarray, subject: Subject
    ) -> dict[str, tuple[float, str]]:
        """Compute the torque limit of the motor."""
        return {"limit": (float(_limit(values[0])), "Nm")}
