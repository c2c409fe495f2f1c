import numpy as np
import pytest

from hyperleg_design.gap.checks.slopes import DEGREES, fitted_correlations, fitted_slopes

TIME = np.linspace(0, 3, 200)
X = np.stack([np.sin(TIME), np.cos(3 * TIME)], 1)


def test_degrees_show_as_their_slope_whatever_the_offset():
    slope, fit = fitted_slopes(X, DEGREES * X + [5.0, -2.0])
    np.testing.assert_allclose(slope, DEGREES)
    np.testing.assert_allclose(fit, 1.0)


def test_a_turned_sign_is_a_correlation_of_minus_one():
    slope, fit = fitted_slopes(X, -0.5 * X)
    np.testing.assert_allclose(slope, -0.5)
    np.testing.assert_allclose(fit, -1.0)


def test_unknown_ticks_change_nothing_and_few_ticks_tell_nothing():
    y = 2 * X
    y[::3] = np.nan
    np.testing.assert_allclose(fitted_slopes(X, y)[0], 2.0)
    y[7:] = np.nan
    assert np.isnan(fitted_slopes(X, y)[1]).all()


def test_a_signal_that_stands_still_while_the_other_moves_does_not_follow_it():
    assert fitted_slopes(X, np.ones_like(X))[1] == pytest.approx([0.0, 0.0])
    assert np.isnan(fitted_slopes(np.ones_like(X), X)[1]).all()
    np.testing.assert_array_equal(fitted_correlations(np.ones_like(X), X[:, 0]), -1.0)


def test_correlations_are_those_of_numpy():
    y = np.random.default_rng(0).normal(size=len(TIME)) + X[:, 0]
    expected = [np.corrcoef(column, y)[0, 1] for column in X.T]
    np.testing.assert_allclose(fitted_correlations(X, y), expected)
