"""Effects whose traces are all sums of a few known ones, however their parameters enter."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals


class SpannedEffect(Effect):
    """An effect that is not linear in its parameters, but in others. A search finds these first, by
    a linear fit, and begins at values of its own that come near.
    """

    @abstractmethod
    def span(self, signals: Signals, location: str) -> dict[str, np.ndarray]:
        """Traces of which each of its own is a sum, at their usual sizes.

        Args:
            signals: a conditioned log, `t` ticks.
            location: one of `locations`.

        Returns:
            By name of the residual `(p, t, rows)`.
        """

    @abstractmethod
    def in_span(self, location: str, subject: Subject, values: np.ndarray) -> np.ndarray:
        """How much of each trace of its span the trace at some values holds.

        Args:
            location: one of `locations`.
            subject: the robot.
            values: of its parameters `(s, parameters)`.

        Returns:
            `(s, p)`.
        """

    @abstractmethod
    def nearest(self, location: str, subject: Subject, sizes: np.ndarray) -> np.ndarray:
        """Values whose traces come near a sum of those of its span.

        Args:
            location: one of `locations`.
            subject: the robot.
            sizes: how much of each there is `(p,)`.

        Returns:
            `(s, parameters)`, inside the bounds, each worth a try.
        """
