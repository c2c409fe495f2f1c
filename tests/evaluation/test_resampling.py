"""Resampling of trainings and trials."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation import resampling
from hyperleg_design.evaluation.statistics import estimate


def drawn(rng, seeds, trials, between, within, mean=0.0):
    return [mean + between * rng.normal() + within * rng.normal(size=trials) for _ in range(seeds)]


def test_plain_percentiles_would_not_cover():
    """Why the correction is there: percentiles of a bootstrap over five seeds miss far more than
    one in twenty.
    """
    rng = np.random.default_rng(2)
    hits = []
    for _ in range(300):
        groups = drawn(rng, 5, 10, 1.0, 0.1)
        means = resampling.resampled_means(groups, 400, rng)
        low, high = np.quantile(means, [0.025, 0.975])
        hits.append(low <= 0 <= high)
    assert np.mean(hits) < 0.9


def test_groups_of_unequal_length_are_drawn_from_their_own_values():
    groups = [np.array([1.0, 2.0]), np.array([5.0] * 7), np.array([9.0])]
    rng = np.random.default_rng(8)
    for which, expected in ((0, 1.5), (1, 5.0), (2, 9.0)):
        drawn_means = resampling._drawn_means(
            [[g] for g in groups], np.full((20_000, 3), which), rng
        )
        assert drawn_means.mean() == pytest.approx(expected, abs=0.01)
        assert drawn_means.var() == pytest.approx(
            0.25 / 2 / 3 if which == 0 else 0, rel=0.05, abs=1e-12
        )


def test_memory_stays_small_and_pieces_fit_together(monkeypatch):
    groups = drawn(np.random.default_rng(9), 5, 10, 1, 1)
    whole = estimate(groups, resamples=2000)
    monkeypatch.setattr(resampling, "_DRAWS", 500)
    assert estimate(groups, resamples=2000) == whole
