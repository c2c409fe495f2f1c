"""Hyperparameters of one channel at the maximum of their posterior."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.scale_fit import STEPS, first_scales, fitted
from hyperleg_design.gap.inference.rules import InferenceRules
from tests.gap.inference.channels.test_channel import made

RULES = InferenceRules()


def test_fitting_scales_never_lowers_the_posterior():
    rng = np.random.default_rng(3)
    channel, _ = made(rng, count=120)
    start = first_scales(channel, RULES)
    found = fitted(channel, start, RULES)
    assert channel.log_posterior(found, RULES) >= channel.log_posterior(start, RULES)


def test_noise_is_found_where_nothing_else_acts():
    rng = np.random.default_rng(21)
    channel, _ = made(rng, sessions=1, count=4000, k=2)
    quiet = replace(channel, products=channel.products * np.array([1.0, 9.0])[:, None, None])
    found = fitted(quiet, first_scales(quiet, RULES), RULES)
    np.testing.assert_allclose(found.noise, [1.0, 9.0], rtol=0.1)


def test_a_change_under_test_alone_is_unlisted_and_one_in_all_sessions_is_not():
    rng = np.random.default_rng(2)
    channel, white = made(rng, sessions=4, count=200, k=12)
    for bent, unlisted in ((range(1), True), (range(4), False)):
        weights = 6.0 * rng.standard_normal(12)
        changed = []
        for s, one in zip(channel.session, white, strict=True):
            other = one.copy()
            if s in bent:
                other[-1] += weights @ one[:-1]
            changed.append(other)
        own = replace(
            channel, whitened=tuple(changed), products=np.array([o @ o.T for o in changed])
        )
        found = fitted(own, first_scales(own, RULES), RULES)
        assert (found.new > 0) is unlisted


def test_no_small_step_of_a_fitted_scale_has_a_larger_posterior():
    channel, _ = made(np.random.default_rng(4), sessions=4, tested=1, count=60)
    found = fitted(channel, first_scales(channel, RULES), RULES, sweeps=40)
    best = channel.log_posterior(found, RULES)
    for name in ("standing", "change"):
        for step in (-STEPS[-1], STEPS[-1]):
            moved = replace(found, **{name: getattr(found, name) + step})
            assert channel.log_posterior(moved, RULES) <= best + 1e-6


def test_noise_of_references_ends_where_the_posterior_is_stationary():
    channel, _ = made(np.random.default_rng(6), sessions=4, count=30, k=8)
    found = fitted(channel, first_scales(channel, RULES), RULES, sweeps=40)
    references = np.setdiff1d(channel.band, channel.bands_tested)
    assert len(references) == 2

    def posterior(band: int, logarithm: float) -> float:
        noise = found.noise.copy()
        noise[band] *= np.exp(logarithm)
        return channel.log_posterior(replace(found, noise=noise), RULES)

    for band in references:
        slope = (posterior(band, 1e-4) - posterior(band, -1e-4)) / 2e-4
        bend = (posterior(band, 1e-2) + posterior(band, -1e-2) - 2 * posterior(band, 0.0)) / 1e-4
        assert bend < -1.0
        assert slope == pytest.approx(0.0, abs=0.01 * -bend)


def test_only_what_is_left_of_the_residual_counts():
    rng = np.random.default_rng(9)
    channel, _ = made(rng)
    trace = 5.0 * rng.standard_normal(len(channel.samples))
    without = channel.without(trace)
    left = channel.left(*channel.crossed(trace[None]), np.ones(1))
    start = first_scales(channel, RULES)
    beside, directly = fitted(channel, start, RULES, left), fitted(without, start, RULES)
    np.testing.assert_allclose(beside.noise, directly.noise, rtol=1e-8)
    assert not np.allclose(beside.noise, fitted(channel, start, RULES).noise, rtol=0.1)
    for name in ("standing", "change", "new"):
        assert getattr(beside, name) == pytest.approx(getattr(directly, name), abs=1e-8)


def test_a_single_session_tells_no_change():
    channel, _ = made(np.random.default_rng(10), sessions=1)
    start = first_scales(channel, RULES)
    found = fitted(channel, start, RULES)
    assert found.change == start.change
    assert found.new == 0.0
    assert found.standing != start.standing
