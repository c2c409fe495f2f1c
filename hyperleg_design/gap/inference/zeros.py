"""Zeros of encoders that are set as logs begin, as columns of the discrepancy whose deviation is
known (`zeroing`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import nuisance_traces
from hyperleg_design.gap.inference.nuisance import NuisanceParameter
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.filtering import FilteredLog
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.gap.signals.zeroing import zero_spread

Key = tuple[str, str, int]
"""Effect, place, and index of the parameter."""
OFFSET = next(effect.identifier for effect in EFFECTS.values() if effect.of_zeros)
"""The effect whose trace a wrong zero leaves."""


@dataclass(frozen=True, eq=False)
class Zeros:
    """Zeros of encoders that are set as a log begins: a parameter for each log, which no other log
    tells anything of.
    """

    joints: tuple[str, ...]
    spread: np.ndarray
    """Of tests, then references `(logs, n)` [rad]."""
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
        spread = np.array([zero_spread(signals.log, subject) for signals in logs])
        return cls(subject.joints, spread, len(tests))

    def usual_with(self, usual: Mapping[Key, float]) -> dict[Key, float]:
        """Add what zeros of all logs under test are usually off to the usual errors of a robot.

        Args:
            usual: by effect, place, and index of the parameter, in its unit.

        Returns:
            The same with the larger ones of encoders.
        """
        larger = dict(usual)
        for joint, spread in zip(self.joints, self.spread[: self.tests].min(0), strict=True):
            larger[OFFSET, joint, 0] = math.hypot(usual[OFFSET, joint, 0], spread)
        return larger

    def columns(
        self, filtered_logs: Sequence[FilteredLog], samples: Samples, tested: bool
    ) -> np.ndarray:
        """Traces at one spread, a row for each log and joint whose zero is set
        `(parameters, S)`.

        Args:
            filtered_logs: under test, or references.
            samples: of them.
            tested: whether they are under test.
        """
        logs, joints = np.nonzero(self.spread)
        columns = np.zeros((len(logs), len(samples.value)))
        first = 0 if tested else self.tests
        for log, (filtered, where) in enumerate(
            zip(filtered_logs, samples.where, strict=True), first
        ):
            own = np.flatnonzero(logs == log)
            zeros = [
                NuisanceParameter(OFFSET, self.joints[j], 0, float(self.spread[log, j]))
                for j in joints[own]
            ]
            for row, traces in nuisance_traces.columns(filtered, zeros).items():
                columns[own, where[row]] = traces
        return columns
