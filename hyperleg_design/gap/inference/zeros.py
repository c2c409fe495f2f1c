"""Zeros of sensors in single logs, as columns of the discrepancy whose deviation is known: those of
encoders that are set as logs begin (`zeroing`), and of torque sensors between gears and links.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.strength import motor_strengths
from hyperleg_design.gap.inference import nuisance_traces
from hyperleg_design.gap.inference.nuisance import TORQUE_ZERO, NuisanceParameter
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.filtering import FilteredLog
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.zeroing import zero_spread

Key = tuple[str, str, int]
"""Effect, place, and index of the parameter."""
OFFSET = next(effect.identifier for effect in EFFECTS.values() if effect.of_zeros)
"""The effect whose trace a wrong zero of an encoder leaves."""
OF_TORQUE = 0.005
"""Deviation of a torque sensor's zero over the torque that its motor is made for [-] (assumed: 0.15
Nm of 87 and of 12 Nm are usual, and 2 % of the largest torque as the accuracy of a data sheet)."""


@dataclass(frozen=True, eq=False)
class Zeros:
    """Zeros of sensors in single logs: parameters of which no other log tells anything."""

    names: tuple[tuple[str, str], ...]
    """Effect and place of each."""
    spread: np.ndarray
    """Of tests, then references, in the parameters' units `(logs, zeros)`."""
    tests: int
    """How many of the logs are under test."""

    @classmethod
    def of(cls, tests: Sequence[Signals], references: Sequence[Signals], subject: Subject) -> Zeros:
        """Compute them.

        Args:
            tests: conditioned logs under test.
            references: conditioned logs of the healthy robot.
            subject: the robot, with the friction that its logs show.
        """
        logs = (*tests, *references)
        encoders = [zero_spread(signals.log, subject) for signals in logs]
        torque_sensors = OF_TORQUE * motor_strengths(subject)
        sensed = [torque_sensors * signals.sensed_behind for signals in logs]
        names = [(OFFSET, joint) for joint in subject.joints]
        names += [(TORQUE_ZERO, motor) for motor in subject.motors]
        return cls(tuple(names), np.concatenate([encoders, sensed], 1), len(tests))

    def usual_with(self, usual: Mapping[Key, float]) -> dict[Key, float]:
        """Add what zeros of all logs under test are usually off to the usual errors of a robot.

        Args:
            usual: by effect, place, and index of the parameter, in its unit.

        Returns:
            The same with the larger ones of encoders.
        """
        larger = dict(usual)
        for name, spread in zip(self.names, self.spread[: self.tests].min(0), strict=True):
            if name[0] == OFFSET:
                larger[*name, 0] = math.hypot(usual[*name, 0], spread)
        return larger

    def columns(
        self, filtered_logs: Sequence[FilteredLog], samples: Samples, tested: bool
    ) -> np.ndarray:
        """Traces at one spread, a row for each zero of each log that may be off
        `(parameters, S)`.

        Args:
            filtered_logs: under test, or references.
            samples: of them.
            tested: whether they are under test.
        """
        logs, _ = np.nonzero(self.spread)
        columns = np.zeros((len(logs), len(samples.value)))
        first = 0 if tested else self.tests
        for log, (filtered, where) in enumerate(
            zip(filtered_logs, samples.where, strict=True), first
        ):
            own = np.flatnonzero(logs == log)
            zeros = [
                NuisanceParameter(effect, location, 0, spread)
                for (effect, location), spread in zip(
                    self.names, self.spread[log].tolist(), strict=True
                )
                if spread
            ]
            for row, traces in nuisance_traces.columns(filtered, zeros).items():
                columns[own, where[row]] = traces
        return columns
