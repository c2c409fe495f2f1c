"""The marginal likelihood of one residual against the normal distribution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from hyperleg_design.gap.inference.channels.likelihood import Likelihood
from hyperleg_design.gap.inference.channels.spectrum import Spectrum

TESTED = np.array([True, False, False])
NOISE = 0.6


@pytest.fixture
def columns():
    """Columns of the discrepancy in each session `(sessions, k, samples)`."""
    return np.random.default_rng(0).standard_normal((3, 4, 9))


@pytest.fixture
def values():
    """The residual `(sessions, samples)`."""
    return np.random.default_rng(1).standard_normal((3, 9))


def likelihood(columns, values, tested=TESTED, known=0):
    """Of sessions with one noise."""
    spectrum = Spectrum(columns @ columns.swapaxes(1, 2) / NOISE, tested, known, known)
    cross = columns @ values[:, :, None] / NOISE
    square, spread = float(np.sum(values**2)) / NOISE, values.size * np.log(NOISE)
    return Likelihood(spectrum, cross, square, spread)


def expected(columns, values, change, standing, known=0):
    """Log density of all samples, without 2 pi."""
    stacked = np.concatenate(list(columns), 1)
    scale = np.where(np.arange(len(stacked)) < known, 1.0, np.exp(standing))[:, None]
    covariance = NOISE * np.eye(values.size) + (scale * stacked).T @ (scale * stacked)
    for session, own in enumerate(columns[:, known:]):
        place = slice(session * own.shape[1], (session + 1) * own.shape[1])
        covariance[place, place] += change[session] ** 2 * own.T @ own
    found = multivariate_normal(cov=covariance).logpdf(values.ravel())
    return found + 0.5 * values.size * np.log(2 * np.pi)


def test_all_scales_give_the_density_of_the_normal_distribution(columns, values):
    made = likelihood(columns, values)
    for standing in (-4.0, 0.3, 2.0):
        for change in (0.0, 0.5, 4.0):
            for new in (1.0, 6.0):
                own = np.where(TESTED, new * change, change)
                assert made.at(own, standing) == pytest.approx(
                    expected(columns, values, own, standing), rel=1e-9
                )


def test_no_scale_alters_a_deviation_that_is_known(columns, values):
    made, change = likelihood(columns, values, known=2), np.full(3, 0.5)
    for standing in (-4.0, 2.0):
        assert made.at(change, standing) == pytest.approx(
            expected(columns, values, change, standing, known=2), rel=1e-9
        )


def test_what_is_kept_of_a_change_serves_other_standing_scales(columns, values):
    made = likelihood(columns, values)
    change = np.full(3, 0.7)
    first = made.at(change, 0.0)
    other = made.at(np.full(3, 0.2), 0.0)
    assert made.at(change, 1.0) == likelihood(columns, values).at(change, 1.0)
    assert made.at(change, 0.0) == first != other


def test_without_any_discrepancy_only_noise_is_left(columns, values):
    found = likelihood(columns, values).at(np.zeros(3), -np.inf)
    own = multivariate_normal(cov=NOISE * np.eye(values.size)).logpdf(values.ravel())
    assert found == pytest.approx(own + 0.5 * values.size * np.log(2 * np.pi))


def test_one_session_cannot_tell_a_change_from_what_stands(columns, values):
    made = likelihood(columns[:1], values[:1], TESTED[:1])
    both = np.log(np.hypot(0.8, 0.6))
    assert made.at(np.full(1, 0.6), np.log(0.8)) == pytest.approx(made.at(np.zeros(1), both))
