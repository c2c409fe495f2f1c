"""Corrections and tests against textbook values, other implementations and simulated studies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.plans.analysis_plan import PlateauRule
from hyperleg_design.evaluation.plans.planned_tests import (
    equivalent,
    holm,
    p_value,
    plateau,
    smallest_detectable,
)


def test_holm_of_a_worked_example():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


@given(st.lists(st.floats(0, 1), min_size=1, max_size=12))
def test_holm_lies_between_none_and_bonferroni(values):
    corrected = holm(values)
    assert np.all(corrected >= np.array(values))
    assert np.all(corrected <= np.minimum(len(values) * np.array(values), 1.0))
    order = np.argsort(values, kind="stable")
    assert np.all(np.diff(corrected[order]) >= 0)


def test_a_comparison_that_could_not_be_made_still_counts():
    assert holm([0.01, np.nan]) == pytest.approx([0.02, np.nan], nan_ok=True)


def test_p_value_is_that_of_the_t_test():
    rng = np.random.default_rng(0)
    values = rng.normal(0.4, 1.0, 12)
    error = values.std(ddof=1) / np.sqrt(len(values))
    assert p_value(values.mean(), error, 11) == pytest.approx(stats.ttest_1samp(values, 0).pvalue)
    assert np.isnan(p_value(1.0, np.nan, 0))


def test_equivalence_is_wrongly_claimed_as_often_as_the_level_says():
    """The true difference lies on the margin, where a test at 5 % errs most."""
    rng = np.random.default_rng(1)
    claimed = []
    for _ in range(2000):
        values = rng.normal(1.0, 1.0, 40)
        error = values.std(ddof=1) / np.sqrt(len(values))
        claimed.append(equivalent(values.mean(), error, 39, 1.0, 0.05))
    assert np.mean(claimed) == pytest.approx(0.05, abs=0.015)
    assert equivalent(0.0, 0.1, 39, 1.0, 0.05)
    assert not equivalent(0.0, np.nan, 0, 1.0, 0.05)


def test_the_smallest_detectable_difference_is_found_with_its_power():
    rng = np.random.default_rng(2)
    size = smallest_detectable(1 / np.sqrt(20), 19, 0.05, 0.8)
    told = [stats.ttest_1samp(rng.normal(size, 1.0, 20), 0).pvalue < 0.05 for _ in range(2000)]
    assert np.mean(told) == pytest.approx(0.8, abs=0.03)


def curve(shape, noise, seed=0):
    steps = np.arange(1, 401) * 8192.0
    rng = np.random.default_rng(seed)
    return steps, shape(steps / steps[-1]) + noise * rng.normal(size=len(steps))


def test_a_flat_end_is_a_plateau_and_a_rising_one_is_none():
    rule = PlateauRule(share=0.2, level=0.05, gain=0.02)
    assert plateau(*curve(lambda s: 2 - np.exp(-12 * s), 0.1), rule).reached
    rising = plateau(*curve(lambda s: 2 * s, 0.1), rule)
    assert not rising.reached
    assert rising.gain == pytest.approx(0.2 * 0.9 / 0.9, rel=0.2)  # blocks' middles, mean 0.9 of 2


def test_noise_alone_is_seldom_called_a_gain():
    rule = PlateauRule(share=0.2, level=0.05, gain=0.0)
    called = [
        not plateau(*curve(lambda s: 0 * s + 2, 0.3, seed), rule).reached for seed in range(400)
    ]
    assert np.mean(called) == pytest.approx(0.05, abs=0.03)


def test_a_certain_gain_that_is_small_does_not_matter():
    found = plateau(*curve(lambda s: 2 + 0.1 * s, 0.0), PlateauRule())
    assert found.p_value < 0.001
    assert found.reached


def test_too_short_a_curve_is_refused():
    with pytest.raises(InputError):
        plateau([1.0, 2.0], [1.0, 2.0], PlateauRule())
