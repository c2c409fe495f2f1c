"""Zeros of encoders that are set as logs begin, as columns of the discrepancy whose deviation is
known (`zeroing`).
"""

from __future__ import annotations

from collections.abc import Sequence
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

OFFSET = next(effect.identifier for effect in EFFECTS.values() if effect.of_zeros)
"""The effect whose trace a wrong zero leaves."""


@dataclass(frozen=True, eq=False)
class Zeros:
    """Zeros of encoders that are set as a log begins: a parameter for each log, which no other log
    tells anything of.
    """

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
        return cls(np.array([zero_spread(s.log, subject) for s in logs]), len(tests))

    @property
    def usual(self) -> np.ndarray:
        """Spread of the zeros of all logs under test `(n,)` [rad]."""
        return np.asarray(self.spread[: self.tests].min(0))

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
        places = [tuple(place) for place in np.argwhere(self.spread > 0).tolist()]
        columns = np.zeros((len(places), len(samples.value)))
        first = 0 if tested else self.tests
        for number, (filtered, where) in enumerate(zip(filtered_logs, samples.where, strict=True)):
            own = [i for i, (log, _) in enumerate(places) if log == first + number]
            joints = filtered.signals.subject.joints
            zeros = [
                NuisanceParameter(OFFSET, joints[places[i][1]], 0, float(self.spread[places[i]]))
                for i in own
            ]
            for row, traces in nuisance_traces.columns(filtered, zeros).items():
                columns[own, where[row]] = traces
        return columns
