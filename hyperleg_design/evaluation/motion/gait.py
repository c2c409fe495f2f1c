"""Gait events and what follows from them, from the vertical forces on the feet of one walk.

A foot stands from the sample at which its load rises above a first threshold to that at which it
falls below a second, lower one (hysteresis); contacts and gaps shorter than a least time are not
counted. Samples are indices; arrays have time first unless stated.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

CYCLE_POINTS = 101
"""Number of points of a normalised gait cycle, 0 to 100 %, from a touchdown to the next touchdown
of the same foot."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Touchdowns after a swing, in order of time, of all feet; `(k,)` each."""

    foot: np.ndarray
    """Place in `Layout.feet`; of a biped 0 left, 1 right."""
    touchdown: np.ndarray
    """First sample of the contact."""
    heel_off: np.ndarray
    """First sample without load on the heel for the rest of the contact; `toe_off` where the heel
    stays loaded, `touchdown` where it never is."""
    toe_off: np.ndarray
    """First sample after the contact; -1 where the record ends before."""
    heel_lead: np.ndarray
    """Time from the first load on the heel to the first on the forefoot [s]: positive for a heel
    strike, 0 for a flat landing, negative for one on the toes; of one that is never loaded, as if
    it were at `toe_off`."""

    def __len__(self) -> int:
        return len(self.touchdown)

    def within(self, first: int, last: int) -> Steps:
        """Select the steps whose touchdown lies between two samples.

        Args:
            first: first sample that counts.
            last: first sample that does not count any more.

        Returns:
            The steps with `first <= touchdown < last`.
        """
        rows = (self.touchdown >= first) & (self.touchdown < last)
        return Steps(**{name: values[rows] for name, values in vars(self).items()})


def stance(load: Any, on: float, off: float, shortest: int = 1) -> np.ndarray:
    """Find when feet stand on the ground, from the load on them, with hysteresis.

    Args:
        load: vertical force [N], `(t, ...)`.
        on: force above which a contact begins [N].
        off: force below which it ends [N].
        shortest: contacts and gaps of fewer samples are not counted, unless cut by an end of the
            record.

    Returns:
        `(t, ...)`; before the first crossing, whether the first load is at least `off`.
    """
    load = np.asarray(load, float)
    known = (load > on) | (load < off)
    known[0] = True
    decided = np.where(known, load >= off, False)
    latest = np.where(known, np.arange(len(load)).reshape(-1, *[1] * (load.ndim - 1)), 0)
    stands = np.take_along_axis(decided, np.maximum.accumulate(latest, 0), 0)
    if shortest > 1:
        flat = stands.reshape(len(load), -1)
        for column in flat.T:
            _fill_short(column, False, shortest)
            _fill_short(column, True, shortest)
    return np.asarray(stands)


def _fill_short(values: np.ndarray, kind: bool, shortest: int) -> None:
    """Turn inner runs of `kind` with fewer samples than `shortest` around, in place; `(t,)`."""
    edges = np.flatnonzero(np.diff(values)) + 1
    for begin, end in pairwise(edges):
        if values[begin] == kind and end - begin < shortest:
            values[begin:end] = not kind


def find_steps(feet: np.ndarray, heel: np.ndarray, forefoot: np.ndarray, time_step: float) -> Steps:
    """Find the steps in the contacts of whole feet, heels and forefeet.

    Args:
        feet: whether each foot stands, `(t, F)`.
        heel: whether its heel is loaded, `(t, F)`.
        forefoot: whether the rest of it is, `(t, F)`.
        time_step: between samples [s].

    Returns:
        The steps of all feet, in the order of their touchdown.
    """
    rows = []
    for foot in range(feet.shape[1]):
        change = np.diff(feet[:, foot].astype(int))
        downs, ups = np.flatnonzero(change == 1) + 1, np.flatnonzero(change == -1) + 1
        for down in downs:
            later = ups[ups > down]
            up = int(later[0]) if len(later) else -1
            end = up if up > 0 else len(feet)
            loaded = np.flatnonzero(heel[down:end, foot])
            ahead = np.flatnonzero(forefoot[down:end, foot])
            heel_off = down + loaded[-1] + 1 if len(loaded) else down
            lead = (ahead[0] if len(ahead) else end - down) - (
                loaded[0] if len(loaded) else end - down
            )
            rows.append((foot, int(down), int(heel_off), up, lead * time_step))
    table = np.array(sorted(rows, key=lambda row: row[1]), float).reshape(-1, 5).T
    which, touchdown, off, toe = table[:4].astype(int)
    return Steps(which, touchdown, off, toe, table[4])


def whole_strides(steps: Steps, first: int, last: int, foot: int = 0) -> tuple[int, int] | None:
    """Find the longest stretch of whole strides of one foot between two samples.

    Args:
        steps: steps of all feet.
        first: first sample that counts.
        last: last sample that counts.
        foot: index of the foot.

    Returns:
        Samples of the first and the last touchdown; None without two touchdowns.
    """
    downs = steps.touchdown[
        (steps.foot == foot) & (steps.touchdown >= first) & (steps.touchdown <= last)
    ]
    return (int(downs[0]), int(downs[-1])) if len(downs) > 1 else None


def strides(steps: Steps, foot: int) -> tuple[np.ndarray, np.ndarray]:
    """List the strides of one foot.

    Args:
        steps: steps of all feet.
        foot: index of the foot.

    Returns:
        The first sample of each stride, and the sample after its last, `(k,)` each.
    """
    downs = steps.touchdown[steps.foot == foot]
    return downs[:-1], downs[1:]


def cadence(steps: Steps, time_step: float) -> float:
    """Compute the number of steps over time, between the first and the last touchdown.

    Args:
        steps: steps of all feet.
        time_step: time between samples [s].

    Returns:
        The cadence [1/s]; NaN where there is no time between the touchdowns.
    """
    if len(steps) < 2 or steps.touchdown[-1] == steps.touchdown[0]:
        return np.nan
    return float((len(steps) - 1) / ((steps.touchdown[-1] - steps.touchdown[0]) * time_step))


def alternation(steps: Steps) -> float:
    """Compute the share of steps that another foot makes than the one before.

    Args:
        steps: steps of all feet.

    Returns:
        The share [-]: 1 for walking, 0 for hopping on one leg, NaN with fewer than two steps.
    """
    return float(np.mean(np.diff(steps.foot) != 0)) if len(steps) > 1 else np.nan


def event_shares(steps: Steps) -> dict[str, float]:
    """Compute when in a stride the heel and the toe leave the floor.

    Args:
        steps: steps of all feet.

    Returns:
        Means over the whole strides of all feet [-]: `duty_factor`, toe-off over stride, and
        `heel_off`, heel-off over stride. NaN without a whole stride.
    """
    duty, heel = [], []
    for foot in np.unique(steps.foot):
        mine = np.flatnonzero(steps.foot == foot)
        for i, following in pairwise(mine):
            stride = steps.touchdown[following] - steps.touchdown[i]
            duty.append((steps.toe_off[i] - steps.touchdown[i]) / stride)
            heel.append((steps.heel_off[i] - steps.touchdown[i]) / stride)
    return {
        "duty_factor": float(np.mean(duty)) if duty else np.nan,
        "heel_off": float(np.mean(heel)) if heel else np.nan,
    }


def support_shares(feet: np.ndarray) -> dict[str, float]:
    """Compute the shares of time with two feet, one foot and no foot on the floor.

    Args:
        feet: whether each foot stands at each sample, `(t, F)`.

    Returns:
        `double_support`, `single_support` and `flight` [-]; NaN without samples.
    """
    standing = feet.sum(-1)
    names = ("flight", "single_support", "double_support")
    return {
        name: float(np.mean(standing == count)) if len(feet) else np.nan
        for count, name in enumerate(names)
    }


def step_vectors(steps: Steps, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Length and width of steps that follow one of the other foot [m].

    The direction of travel is from the place of the same foot's touchdown before to that after, so
    a walk may curve.

    Args:
        steps: k steps.
        places: of the stepping foot at its touchdown, on the floor, `(k, 2)` [m].

    Returns:
        Length along the direction of travel and width across it, of each step that has both
        neighbours of the other foot.
    """
    length, width = [], []
    for i in range(1, len(steps) - 1):
        if steps.foot[i - 1] == steps.foot[i] or steps.foot[i + 1] == steps.foot[i]:
            continue
        travel = places[i + 1] - places[i - 1]
        stride = np.hypot(*travel)
        if stride < 1e-6:
            continue
        along = travel / stride
        step = places[i] - places[i - 1]
        length.append(float(step @ along))
        width.append(float(abs(step[0] * along[1] - step[1] * along[0])))
    return np.array(length), np.array(width)


def slip_per_step(
    steps: Steps, pad_load: np.ndarray, pad_slip: np.ndarray, pad_foot: np.ndarray, time_step: float
) -> np.ndarray:
    """Compute how far the foot slides over the floor in each whole contact.

    This is the integral of the pads' sliding speed, their mean weighted by load: the length of the
    way, to and fro. A step of the simulation moves with the velocity at its end, so the speed with
    which a foot meets the floor, before any force could brake it, is not slip.

    Args:
        steps: k steps.
        pad_load: vertical force on each pad [N], `(t, P)`.
        pad_slip: sliding speed of each touching pad [m/s], `(t, P)`.
        pad_foot: foot of each pad, `(P,)`.
        time_step: between samples [s].

    Returns:
        The way of each step [m], `(k,)`; NaN where the record ends before toe-off.
    """
    ways = np.full(len(steps), np.nan)
    for foot in np.unique(steps.foot):
        mine = pad_foot == foot
        load = pad_load[:, mine]
        total = load.sum(-1)
        weighted = np.einsum("tp,tp->t", load, pad_slip[:, mine])
        speed = np.divide(weighted, total, out=np.zeros(len(total)), where=total > 0)
        way = np.concatenate([[0.0], np.cumsum(speed) * time_step])
        for i in np.flatnonzero((steps.foot == foot) & (steps.toe_off > 0)):
            ways[i] = way[steps.toe_off[i] + 1] - way[steps.touchdown[i] + 1]
    return ways


def cycles(signal: np.ndarray, steps: Steps, foot: int, points: int = CYCLE_POINTS) -> np.ndarray:
    """A signal over each stride of a foot, touchdown to touchdown, at equal shares of the stride.

    Args:
        signal: `(t, m)`.
        steps: steps.
        foot: 0 left, 1 right.
        points: from 0 to 100 %.

    Returns:
        `(strides, points, m)`
    """
    begins, ends = strides(steps, foot)
    share = np.linspace(0.0, 1.0, points)
    resampled = np.empty((len(begins), points, signal.shape[1]))
    for i, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        at = begin + share * (end - begin)
        low = np.minimum(at.astype(int), len(signal) - 2)
        part = (at - low)[:, None]
        resampled[i] = (1 - part) * signal[low] + part * signal[low + 1]
    return resampled
