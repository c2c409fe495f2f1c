import numpy as np
import pytest

from hyperleg_design.gap.effects.series import (
    band_limited,
    delayed,
    lagged,
    second_derivative,
    swung,
)

STEP = 0.005
TIME = np.arange(4000) * STEP


def test_delay_is_exact_for_straight_lines():
    found = delayed(3.0 * TIME + 1, np.array([0.0, 0.0125, 0.02]), STEP)
    np.testing.assert_allclose(
        found[:, 10:], 3.0 * (TIME[10:] - np.array([[0.0], [0.0125], [0.02]])) + 1, atol=1e-12
    )
    assert found[2, 0] == 1


def test_delay_keeps_the_unknown_where_it_is():
    values = TIME.copy()
    values[100] = np.nan
    assert np.flatnonzero(np.isnan(delayed(values, np.array([2 * STEP]), STEP)[0])).tolist() == [
        102
    ]


def test_lag_is_that_of_the_differential_equation():
    lag, omega = 0.03, 2 * np.pi * 2
    found = lagged(np.sin(omega * TIME), np.array([lag]), STEP)[0]
    phase = np.arctan(omega * lag)
    expected = np.sin(omega * TIME - phase) / np.hypot(1, omega * lag)
    late = 10 * lag < TIME
    assert np.abs(found - expected)[late].max() < 1e-3


def test_a_swing_is_that_of_the_differential_equation():
    frequency, damping, omega = 2 * np.pi * 4.0, 0.1, 2 * np.pi * 3.0
    square, late = frequency**-2, 2 * damping / frequency
    found = swung(np.sin(omega * TIME), np.array([square]), np.array([late]), STEP)[0]
    response = 1 / (1 - square * omega**2 + 1j * late * omega)
    expected = np.abs(response) * np.sin(omega * TIME + np.angle(response))
    assert np.abs(response) > 2
    assert np.abs(found - expected)[TIME > 4].max() < 0.01
    settled = swung(np.full(50, 2.0), np.array([square]), np.array([late]), STEP)
    np.testing.assert_allclose(settled, 2.0)
    gap = np.where(np.arange(50) == 9, np.nan, 2.0)
    assert np.flatnonzero(np.isnan(swung(gap, np.ones(1), np.ones(1), STEP)[0])).tolist() == [9]


def test_no_lag_is_no_change_and_a_constant_stays():
    wave = np.sin(TIME)
    np.testing.assert_array_equal(lagged(wave, np.zeros(1), STEP)[0], wave)
    np.testing.assert_allclose(lagged(np.full(50, 2.0), np.array([0.1, 1e-8]), STEP), 2.0)


def test_lag_bridges_the_unknown():
    wave = np.sin(TIME)
    holed = wave.copy()
    holed[500:503] = np.nan
    found, whole = lagged(holed, np.array([0.02]), STEP)[0], lagged(wave, np.array([0.02]), STEP)[0]
    assert np.isnan(found[500:503]).all()
    assert np.nanmax(np.abs(found - whole)) < 1e-3


def test_second_derivative_and_band():
    wave = np.sin(4 * TIME)
    assert np.abs(second_derivative(wave, STEP) + 16 * wave)[1:-1].max() < 0.01
    assert np.abs(band_limited(wave, STEP, 20.0) - wave)[100:-100].max() < 1e-3
    fast = np.sin(2 * np.pi * 80 * TIME)
    assert np.abs(band_limited(fast, STEP, 10.0))[100:-100].max() < 1e-3
    assert band_limited(np.full(5, np.nan), STEP, 10.0) == pytest.approx(
        np.full(5, np.nan), nan_ok=True
    )
