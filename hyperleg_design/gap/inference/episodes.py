"""Rare episodes of residuals much larger than the rest of their row: drives at their limits,
collisions, a cable that snags.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.base import Base
    from hyperleg_design.gap.inference.samples import Samples

ROBUST_FREEDOM = 4.0
"""Of the Student distribution that finds episodes."""
EPISODE = 6.0
"""Residual over the robust scale of its group from which there is an episode."""
NEAR_EPISODE = 0.15
"""Time around such a sample that belongs to the episode [s]."""
ROUNDS = 4
"""Of weighing anew."""
MOST_EPISODES = 0.3
"""Share of a row above which there are no episodes but noise that is larger than thought."""


def episodes(base: Base) -> np.ndarray:
    """Samples in rare episodes of residuals much larger than the rest of their row `(S,)` of bool.

    They are found after a fit of the nuisance parameters with Student weights, which such episodes
    do not bend.
    """
    from scipy.linalg import cho_factor, cho_solve

    samples = base.samples
    session = samples.session[samples.part]
    weight, left = np.ones(len(base.value)), base.value.copy()
    plain = np.abs(base.value) / np.sqrt(samples.share)
    scale = np.ones(samples.groups)
    size = len(base.errors)
    own = [
        [np.flatnonzero((samples.row == row) & (session == s)) for row in range(len(samples.rows))]
        for s in range(samples.sessions)
    ]
    shown = [one[:-1] for one in base.layout.shown]
    errors = [
        [base.errors[np.ix_(columns, mine)] for columns, mine in zip(shown, of, strict=True)]
        for of in own
    ]
    for _ in range(ROUNDS):
        for s in range(samples.sessions):
            normal, right = base.prior.precision.copy(), np.zeros(size)
            for columns, mine, some in zip(shown, own[s], errors[s], strict=True):
                weighed = some * (weight[mine] / scale[samples.group[mine]])
                normal[np.ix_(columns, columns)] += weighed @ some.T
                right[columns] += weighed @ base.value[mine]
            solved = cho_solve(cho_factor(normal, check_finite=False), right)
            for columns, mine, some in zip(shown, own[s], errors[s], strict=True):
                left[mine] = base.value[mine] - solved[columns] @ some
        plain = np.abs(left) / np.sqrt(samples.share)
        for group in range(samples.groups):
            scale[group] = _spread(plain[samples.group == group]) ** 2
        weight = (ROBUST_FREEDOM + 1) / (ROBUST_FREEDOM + plain**2 / scale[samples.group])
    found = np.zeros(len(left), bool)
    large = (plain > EPISODE * np.sqrt(scale[samples.group])) & (
        samples.group_band[samples.group] > 0
    )
    log = samples.log[samples.part]
    for key in np.unique(samples.row[large] * (log.max() + 1) + log[large]).tolist():
        row, number = divmod(key, int(log.max()) + 1)
        mine = (samples.row == row) & (log == number)
        times = np.sort(samples.time[mine & large])
        after = np.clip(np.searchsorted(times, samples.time[mine]), 0, len(times) - 1)
        near = np.minimum(
            np.abs(times[after] - samples.time[mine]),
            np.abs(times[np.maximum(after - 1, 0)] - samples.time[mine]),
        )
        found[mine] = near <= NEAR_EPISODE
    for row in range(len(samples.rows)):
        mine = samples.row == row
        if mine.any() and found[mine].mean() > MOST_EPISODES:
            found[mine] = False
    return found


def _spread(values: np.ndarray) -> float:
    """Standard deviation of what is usual among absolute values, half the floor's at least."""
    return max(float(np.median(values)) / 0.6745, 0.5)


BIN = 0.05
"""Time within which what happens is together [s]."""


def together(samples: Samples, left: np.ndarray, residual_name: str = "drive") -> float:
    """Share of the time in which at least two, and half of all drives do not do what they were
    told, all at once.

    Limits and gear teeth belong to one drive; commands that get lost on their way belong to all.

    Args:
        samples: of all logs.
        left: what a model leaves of every sample, weighted `(S,)`.
        residual: whose rows tell; of `motion`, what joints do where nobody measured what their
            drives give.
    """
    drives = [i for i, row in enumerate(samples.rows) if row.residual_name == residual_name]
    if len(drives) < 2:
        return 0.0
    plain = np.abs(left) / np.sqrt(samples.share)
    log, band = samples.log[samples.part], samples.group_band[samples.group]
    place = (samples.time / BIN).astype(int) + log * (int(samples.time.max() / BIN) + 1)
    count, seen = np.zeros(int(place.max()) + 1), np.zeros(int(place.max()) + 1, bool)
    for row in drives:
        own, wild = samples.row == row, np.zeros(len(count), bool)
        seen[place[own]] = True
        for number in set(band[own].tolist()) - {0}:
            mine = own & (band == number)
            wild[place[mine & (plain > EPISODE * _spread(plain[mine]))]] = True
        count += wild
    return float((count[seen] >= max(len(drives) / 2, 2)).mean())


def of_time(samples: Samples, row: int) -> float:
    """Share of a row that is in episodes."""
    own = samples.row == row
    return float(
        samples.share[own & samples.episodic[samples.group]].sum()
        / max(samples.share[own].sum(), 1e-300)
    )
