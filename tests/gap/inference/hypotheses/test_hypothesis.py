"""Evidence of sets of causes beside the discrepancy, against the integrals that it stands for."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal, norm

from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.hypotheses.hypothesis import reduced, shifted, solve
from hyperleg_design.gap.inference.rules import InferenceRules
from tests.gap.inference.channels.test_channel import dense, made

RULES = InferenceRules()
SCALES = Scales(np.array([0.7, 1.9, 1.2, 0.4]), np.log(0.8), np.log(0.5), np.log(3.0))


def evidence(*channels):
    return SimpleNamespace(channels=channels)


def test_gain_is_the_ratio_of_marginal_likelihoods():
    rng = np.random.default_rng(1)
    channel, white = made(rng)
    columns = rng.standard_normal((2, len(channel.samples)))
    products = reduced(evidence(channel), [SCALES], columns)
    free = np.full(2, np.inf)
    found = solve(products, -free, free, np.zeros(2, bool), RULES)
    value = np.concatenate([one[-1] for one in white])
    whole = np.zeros((2, len(value)))
    whole[:, : columns.shape[1]] = columns
    covariance = dense(channel, SCALES)
    more = covariance + RULES.cause.width**2 * whole.T @ whole
    expected = multivariate_normal(cov=more).logpdf(value)
    expected -= multivariate_normal(cov=covariance).logpdf(value)
    assert found.gain == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_parameters_that_nothing_shows_gain_nothing():
    channel, _ = made(np.random.default_rng(2))
    columns = np.zeros((1, len(channel.samples)))
    found = solve(
        reduced(evidence(channel), [SCALES], columns),
        np.full(1, -np.inf),
        np.full(1, np.inf),
        np.zeros(1, bool),
        RULES,
    )
    assert found.gain == pytest.approx(0.0, abs=1e-12)
    assert found.theta[0] == pytest.approx(0.0)


@pytest.mark.parametrize("size", [1.0, 1e11])
def test_two_columns_that_are_alike_share_what_one_of_them_explains(size):
    channel, _ = made(np.random.default_rng(6))
    one = size * np.random.default_rng(7).standard_normal((1, len(channel.samples)))
    products = reduced(evidence(channel), [SCALES], np.concatenate([one, one]))
    free = np.full(2, np.inf)
    both = solve(products, -free, free, np.zeros(2, bool), RULES)
    alone = solve(products[:2, :2], -free[:1], free[:1], np.zeros(1, bool), RULES)
    assert np.isfinite(both.gain)
    assert both.theta.sum() == pytest.approx(alone.theta[0], rel=0.02)


def test_channels_add_up():
    rng = np.random.default_rng(4)
    first, _ = made(rng)
    second, _ = made(rng)
    columns = rng.standard_normal((2, len(first.samples)))
    both = reduced(evidence(first, second), [SCALES, SCALES], columns)
    apart = [reduced(evidence(one), [SCALES], columns) for one in (first, second)]
    np.testing.assert_allclose(both, apart[0] + apart[1])


def test_a_constant_trace_is_taken_off_the_residual():
    rng = np.random.default_rng(6)
    channel, _ = made(rng)
    columns = rng.standard_normal((2, len(channel.samples)))
    with_constant = shifted(reduced(evidence(channel), [SCALES], columns), last=True)
    directly = reduced(evidence(channel.without(columns[1])), [SCALES], columns[:1])
    np.testing.assert_allclose(with_constant, directly, atol=1e-9)


def test_bounds_hold():
    rng = np.random.default_rng(7)
    channel, _ = made(rng)
    column = channel.whitened[0][-1]
    columns = np.zeros((1, len(channel.samples)))
    columns[0, channel.places[0]] = column
    found = solve(
        reduced(evidence(channel), [SCALES], columns),
        np.zeros(1),
        np.full(1, 0.1),
        np.zeros(1, bool),
        RULES,
    )
    assert 0.0 <= found.theta[0] <= 0.1


def test_causes_that_do_not_act_are_seldom_worth_their_prior():
    rng = np.random.default_rng(12)
    gains = []
    for _ in range(200):
        channel, _ = made(rng, sessions=1, count=30)
        scales = Scales(np.ones(2), -np.inf, -np.inf)
        columns = rng.standard_normal((1, len(channel.samples)))
        free = np.full(1, np.inf)
        products = reduced(evidence(channel), [scales], columns)
        gains.append(solve(products, -free, free, np.zeros(1, bool), RULES).gain)
    # a Bayes factor for what is not there exceeds K with probability at most 1 / K
    gains = np.array(gains)
    assert np.mean(gains > np.log(10)) <= 0.1
    assert np.mean(gains > 0) <= 0.2


def test_a_size_that_would_rather_lie_beyond_its_bound_is_worth_the_integral_up_to_it():
    rng = np.random.default_rng(6)
    channel, _ = made(rng)
    columns = rng.standard_normal((1, len(channel.samples)))
    products = reduced(evidence(channel), [SCALES], columns)
    free = solve(products, np.full(1, -np.inf), np.full(1, np.inf), np.zeros(1, bool), RULES)
    deviation = float(np.sqrt(free.covariance[0, 0]))
    for beyond in (0.5, 2.0):
        end = free.theta[0] - beyond * deviation
        found = solve(products, np.full(1, end - 50.0), np.full(1, end), np.zeros(1, bool), RULES)
        assert found.gain - free.gain == pytest.approx(norm.logcdf(-beyond), abs=1e-6)
