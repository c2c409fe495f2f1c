"""The model of one channel against dense Gaussian algebra, and what follows from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.rules import InferenceRules

RULES = InferenceRules()


def made(
    rng: np.random.Generator,
    sessions: int = 3,
    tested: int = 1,
    count: int = 40,
    k: int = 4,
    steady: int = 0,
) -> tuple[Channel, list[np.ndarray]]:
    """A channel with two bands a session, and its whitened columns (residual last); of half of the
    steady ones the deviation is known.
    """
    white, session, band, places, start = [], [], [], [], 0
    for s in range(sessions):
        for b in range(2):
            white.append(rng.standard_normal((k + 1, count)))
            session.append(s)
            band.append(b if s < tested else 2 + b)
            places.append(np.arange(start, start + count))
            start += count
    channel = Channel(
        residual="motion",
        column=0,
        name="joint",
        products=np.array([one @ one.T for one in white]),
        number=np.full(len(white), float(count)),
        session=np.array(session),
        band=np.array(band),
        frequency=np.tile(np.arange(2), 2)[: 2 if sessions <= tested else 4],
        tested=np.arange(sessions) < tested,
        places=tuple(places),
        whitened=tuple(white),
        steady=steady,
        known=steady // 2,
    )
    return channel, white


def dense(channel: Channel, scales: Scales) -> np.ndarray:
    """Marginal covariance of all samples, cell after cell."""
    change = channel.change_scales(scales) ** 2
    sizes = [one.shape[1] for one in channel.whitened]
    ends = np.cumsum([0, *sizes])
    found = np.zeros((ends[-1], ends[-1]))
    for i, one in enumerate(channel.whitened):
        for j, other in enumerate(channel.whitened):
            shared = np.full(channel.columns, np.exp(2 * scales.standing))
            shared[: channel.known] = 1.0
            if channel.session[i] == channel.session[j]:
                shared[channel.steady :] += change[channel.session[i]]
            block = (shared[:, None] * one[:-1]).T @ other[:-1]
            if i == j:
                block = block + np.eye(sizes[i]) * scales.noise[channel.band[i]]
            found[ends[i] : ends[i + 1], ends[j] : ends[j + 1]] = block
    return found


SCALES = Scales(np.array([0.7, 1.9, 1.2, 0.4]), np.log(0.8), np.log(0.5), np.log(3.0))


@pytest.mark.parametrize("steady", [0, 2, 4])
@pytest.mark.parametrize(("sessions", "tested"), [(1, 1), (2, 2), (3, 1), (4, 2)])
def test_marginal_likelihood_is_that_of_the_normal_distribution(sessions, tested, steady):
    channel, white = made(np.random.default_rng(sessions), sessions, tested, steady=steady)
    scales = replace(SCALES, noise=SCALES.noise[: len(channel.numbers)])
    value = np.concatenate([one[-1] for one in white])
    covariance = dense(channel, scales)
    expected = multivariate_normal(cov=covariance).logpdf(value)
    expected += 0.5 * len(value) * np.log(2 * np.pi)
    assert channel.log_likelihood(scales) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("steady", [0, 3])
def test_reduced_products_are_those_in_the_metric_of_the_covariance(steady):
    rng = np.random.default_rng(5)
    channel, white = made(rng, steady=steady)
    columns = rng.standard_normal((3, len(channel.samples)))
    left = channel.reduced(SCALES, *channel.crossed(columns))
    total = sum(one.shape[1] for one in white)
    whole = np.zeros((4, total))
    whole[0] = np.concatenate([one[-1] for one in white])
    whole[1:, : columns.shape[1]] = columns
    expected = whole @ np.linalg.solve(dense(channel, SCALES), whole.T)
    np.testing.assert_allclose(left, expected, rtol=1e-8, atol=1e-9)


def test_taking_a_trace_off_is_the_same_as_another_residual():
    rng = np.random.default_rng(11)
    channel, white = made(rng)
    trace = rng.standard_normal(len(channel.samples))
    changed = []
    for place, one in zip(channel.places, white, strict=True):
        other = one.copy()
        if len(place):
            other[-1] -= trace[place]
        changed.append(other @ other.T)
    np.testing.assert_allclose(channel.without(trace).products, changed, atol=1e-9)


def test_what_is_left_without_columns_is_the_residual_without_their_trace():
    rng = np.random.default_rng(12)
    channel, _ = made(rng)
    columns, theta = rng.standard_normal((3, len(channel.samples))), rng.standard_normal(3)
    left = channel.left(*channel.crossed(columns), theta)
    expected = channel.without(theta @ columns).whole_residual
    np.testing.assert_allclose(left.cross, expected.cross, atol=1e-9)
    np.testing.assert_allclose(left.square, expected.square, rtol=1e-9)


def test_noise_like_the_references_is_healthy_and_far_above_it_is_not():
    channel, _ = made(np.random.default_rng(8))
    calm = np.array([0.7, 1.5, 0.8, 1.2])
    healthy, unlisted = channel.noisy(calm, RULES)
    assert healthy > unlisted
    loud = np.array([30.0, 40.0, 0.8, 1.2])
    healthy, unlisted = channel.noisy(loud, RULES)
    assert unlisted > healthy
    as_loud = np.array([30.0, 40.0, 30.0, 40.0])
    healthy, unlisted = channel.noisy(as_loud, RULES)
    assert healthy > unlisted


def test_without_references_the_expected_noise_is_less_certain():
    channel, _ = made(np.random.default_rng(9), sessions=1)
    assert np.all(channel.bands_alike == -1)
    healthy, unlisted = channel.noisy(np.array([30.0, 10.0]), RULES)
    assert healthy > unlisted
    healthy, unlisted = channel.noisy(np.array([1e4, 1e4]), RULES)
    assert unlisted > healthy


def test_usual_noise_is_that_of_the_same_band_in_references():
    channel, _ = made(np.random.default_rng(10))
    found = channel.usual_noise(np.array([5.0, 6.0, 0.1, 3.0]), RULES)
    assert found == pytest.approx([RULES.noise.least, 3.0])
