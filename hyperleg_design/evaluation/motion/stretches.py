"""Where the time of a T-test goes: straights and turns, one after the other.

A turn is the time within `NEAR` of its waypoint, from coming in before the waypoint is reached to
leaving afterwards; straights are what lies between. Together they are the whole run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.protocols import course

if TYPE_CHECKING:
    from hyperleg_design.evaluation.protocol import TTestProtocol

NEAR = 1.5
"""Distance from a waypoint that counts as its turn [m]; assumed, under half of the shortest leg."""


@dataclass(frozen=True)
class Stretch:
    """A straight or a turn of one run."""

    name: str
    """Such as `A to B` or `turn at B`; a waypoint that is passed twice has its number behind."""
    time: float
    """[s]"""
    way: float
    """Of the pelvis [m]."""
    slowest: float
    """Least speed of the pelvis, mean over `WINDOW` [m/s]."""
    fastest: float
    """Largest speed of the pelvis, mean over `WINDOW` [m/s]."""

    @property
    def mean_speed(self) -> float:
        """Way over time [m/s]."""
        return self.way / self.time if self.time else np.nan


WINDOW = 0.2
"""Over which speed is averaged, so that steps do not count as slow and fast [s]; assumed."""


def stretches(path: np.ndarray, protocol: TTestProtocol, step: float) -> list[Stretch]:
    """Straights and turns of a run that arrived.

    Args:
        path: of the pelvis in the frame of the start, once a policy step, from the start to the
            arrival `(t, 2)` [m].
        protocol: the course.
        step: between samples [s].

    Returns:
        In order; their times sum to (t - 1) steps. Empty where the run did not reach all waypoints
        but the last, whose arrival ends the path.
    """
    path = np.asarray(path, float)
    points, names = protocol.course, protocol.order
    reached = course.arrivals(path, points, protocol.arrival)
    if len(path) < 3 or np.any(reached[:-1] < 0):
        return []
    speed = _smooth(np.linalg.norm(np.diff(path, axis=0), axis=-1) / step, step)
    bounds, labels = [0], []
    for k, at in enumerate(reached[:-1], start=1):
        far = np.linalg.norm(path - points[k], axis=-1) > NEAR
        before = np.flatnonzero(far[: at + 1])
        after = np.flatnonzero(far[at:])
        enter = int(before[-1]) + 1 if len(before) else 0
        leave = int(at + after[0]) if len(after) else len(path) - 1
        visit = names[1 : k + 1].count(names[k])
        again = f" ({visit})" if names[1:-1].count(names[k]) > 1 else ""
        labels += [f"{names[k - 1]} to {names[k]}", f"turn at {names[k]}{again}"]
        bounds += [max(enter, bounds[-1]), max(leave, enter, bounds[-1])]
    labels.append(f"{names[-2]} to {names[-1]}")
    bounds.append(len(path) - 1)
    parts = []
    for label, begin, end in zip(labels, bounds[:-1], bounds[1:], strict=True):
        own = speed[begin:end]
        parts.append(
            Stretch(
                label,
                (end - begin) * step,
                course.path_length(path[begin : end + 1]),
                float(own.min()) if len(own) else np.nan,
                float(own.max()) if len(own) else np.nan,
            )
        )
    return parts


def _smooth(values: np.ndarray, step: float) -> np.ndarray:
    """Moving mean over `WINDOW`; shorter at the ends."""
    half = max(int(WINDOW / step / 2), 0)
    sums = np.concatenate([[0.0], np.cumsum(values)])
    place = np.arange(len(values))
    low, high = np.maximum(place - half, 0), np.minimum(place + half + 1, len(values))
    return np.asarray((sums[high] - sums[low]) / (high - low))
