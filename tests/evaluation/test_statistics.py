"""Intervals cover as often as they say, effect sizes are the textbook's, verdicts know what they
cannot know.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import effect_size, resampling, statistics
from hyperleg_design.evaluation.statistics import difference, estimate, share


def drawn(rng, seeds, trials, between, within, mean=0.0):
    return [mean + between * rng.normal() + within * rng.normal(size=trials) for _ in range(seeds)]


@pytest.mark.parametrize(
    ("between", "within", "most"), [(1.0, 0.1, 0.98), (1.0, 1.0, 0.99), (0.3, 1.0, 1.0)]
)
def test_the_interval_covers_the_truth_as_often_as_it_says(between, within, most):
    rng = np.random.default_rng(1)
    found = [
        estimate(drawn(rng, 5, 10, between, within, 3.0), resamples=400, seed=i) for i in range(300)
    ]
    covered = np.mean([f.low <= 3.0 <= f.high for f in found])
    assert 0.92 <= covered <= most


@pytest.mark.parametrize("paired", [False, True])
def test_no_difference_is_told_about_one_time_in_twenty(paired):
    rng = np.random.default_rng(3)
    told = []
    for i in range(300):
        common = rng.normal(size=5)
        a = [c * paired + x for c, x in zip(common, drawn(rng, 5, 10, 0.5, 0.5), strict=True)]
        b = [c * paired + x for c, x in zip(common, drawn(rng, 5, 10, 0.5, 0.5), strict=True)]
        told.append(
            difference(a, b, paired=paired, resamples=400, seed=i).verdict == statistics.DIFFERS
        )
    assert np.mean(told) <= 0.085


def test_a_clear_difference_is_told_and_a_faint_one_is_not():
    rng = np.random.default_rng(4)
    a, b, c = (drawn(rng, 5, 10, 0.1, 0.1, m) for m in (10.0, 12.0, 10.02))
    clear, faint = difference(a, b), difference(a, c)
    assert clear.verdict == statistics.DIFFERS
    assert clear.low < -2 < clear.high < 0
    assert clear.relative == pytest.approx(-2 / 12, abs=0.02)
    assert clear.cliffs_delta == -1
    assert faint.verdict == statistics.NOT_TOLD_APART


def test_pairing_sees_what_a_common_spread_hides():
    rng = np.random.default_rng(5)
    common = 5 * rng.normal(size=6)
    a = [c + 0.5 + 0.05 * rng.normal(size=10) for c in common]
    b = [c + 0.05 * rng.normal(size=10) for c in common]
    assert difference(a, b).verdict == statistics.NOT_TOLD_APART
    assert difference(a, b, paired=True).verdict == statistics.DIFFERS


def test_checkpoints_are_a_level_of_their_own():
    """A seed's mean is that of its checkpoints' means, and their spread is drawn, not only that of
    pooled trials.
    """
    nested = [[np.full(10, 1.0), np.full(2, 4.0)], [np.full(3, 2.0)]]
    found = estimate(nested)
    assert found.mean == pytest.approx((2.5 + 2.0) / 2)
    assert (found.seeds, found.trials) == (2, 15)
    rng = np.random.default_rng(11)
    means = resampling._drawn_means([nested[0]], np.zeros((40_000, 1), int), rng)
    assert sorted(set(means.tolist())) == [1.0, 2.5, 4.0]
    assert means.var() == pytest.approx(1.5**2 / 2, rel=0.03)  # two draws of two values 3 apart
    one = estimate([[rng.normal(0, 0.01, 10), rng.normal(1, 0.01, 10), rng.normal(2, 0.01, 10)]])
    pooled = estimate([np.concatenate([rng.normal(k, 0.01, 10) for k in range(3)])])
    assert one.high - one.low > 3 * (pooled.high - pooled.low)
    assert "says nothing about seeds" in one.text()


def test_a_share_counts_trials_of_all_checkpoints():
    found = share([[np.zeros(10), np.ones(10)], [np.zeros(10)]])
    assert found.mean == pytest.approx(0.25)
    assert found.trials == 30


def test_one_seed_cannot_speak_about_seeds():
    found = estimate([[1.0, 1.1, 0.9, 1.05]])
    assert not found.speaks_of_seeds
    assert "says nothing about seeds" in found.text()
    assert found.low < 1.0 < found.high
    assert found.against(1.0) == statistics.TOO_FEW_SEEDS
    apart = difference([[1.0, 1.1, 0.9]], [[9.0, 9.1, 8.9]])
    assert apart.verdict == statistics.TOO_FEW_SEEDS
    assert apart.unit == "trials"
    assert difference([[1.0, 1.1]] * 2, [[9.0, 9.1]] * 5).verdict == statistics.TOO_FEW_SEEDS


def test_one_trial_has_no_interval():
    found = estimate([[2.0]])
    assert found.mean == 2
    assert np.isnan([found.low, found.high]).all()


def test_the_mean_is_of_seeds_not_of_trials():
    assert estimate([[0.0] * 9, [1.0]]).mean == 0.5


def test_missing_values_are_counted_not_dropped():
    found = estimate([[1.0, np.nan], [2.0, 2.0], [np.nan, np.nan]])
    assert (found.mean, found.seeds, found.trials, found.missing) == (1.5, 2, 3, 3)
    assert "3 without a value" in found.text()
    nothing = estimate([[np.nan], [np.nan]])
    assert np.isnan(nothing.mean)
    assert nothing.against(1.0) == statistics.NOTHING_MEASURED
    assert difference([[np.nan]], [[1.0]]).verdict == statistics.NOTHING_MEASURED


def test_same_seed_same_interval_other_seed_nearly():
    groups = drawn(np.random.default_rng(6), 5, 10, 1, 1)
    first, again, other = (estimate(groups, seed=s) for s in (0, 0, 1))
    assert first == again
    assert other.low != first.low
    assert other.low == pytest.approx(first.low, abs=0.05 * (first.high - first.low))


def test_bootstrap_error_is_that_of_theory():
    """Variance of a mean of k seeds: between-seed variance / k, plus what drawing trials adds."""
    groups = drawn(np.random.default_rng(7), 6, 40, 1.0, 0.5)
    means = np.array([g.mean() for g in groups])
    theory = means.var(ddof=1) / 6 + np.mean([g.var() / 40 for g in groups]) / 6 * 6 / 5
    assert estimate(groups, resamples=20_000).standard_error == pytest.approx(
        np.sqrt(theory), rel=0.03
    )


def test_no_fall_in_fifty_walks_still_has_an_upper_bound():
    found = share([[False] * 10] * 5)
    assert (found.mean, found.low) == (0, 0)
    assert found.high == pytest.approx(1 - 0.025 ** (1 / 50), rel=1e-6)
    every = share([[True] * 10] * 5)
    assert (every.mean, every.high) == (1, 1)
    assert every.low == pytest.approx(0.025 ** (1 / 50), rel=1e-6)
    mixed = share([[True, False] * 5, [False] * 10, [True] * 3 + [False] * 7])
    assert 0 <= mixed.low < mixed.mean < mixed.high <= 1


def test_effect_sizes_of_a_textbook_example():
    x, y = [3.0, 4, 5, 6, 7], [1.0, 2, 3, 4, 5]
    assert effect_size.hedges_g(x, y) == pytest.approx(2 / np.sqrt(2.5) * (1 - 3 / 31))
    assert effect_size.cliffs_delta(x, y) == pytest.approx((19 - 3) / 25)
    assert effect_size.cliffs_delta(y, x) == -effect_size.cliffs_delta(x, y)
    assert np.isnan(effect_size.hedges_g([1.0], [2.0, 3.0]))
    assert np.isnan(effect_size.hedges_g([1.0, 1.0], [2.0, 2.0]))


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: estimate([]), "groups"),
        (lambda: estimate([[[[1.0]]]]), "groups"),
        (lambda: estimate([[np.inf]]), "groups"),
        (lambda: estimate([[1.0]], level=95), "level"),
        (lambda: estimate([[1.0]], resamples=3), "resamples"),
        (lambda: difference([[1.0]], [[1.0], [2.0]], paired=True), "paired"),
    ],
)
def test_nonsense_is_refused(call, field):
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.field == field
