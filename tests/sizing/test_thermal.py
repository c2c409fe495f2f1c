import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hyperleg_design.errors import InputError
from hyperleg_design.sizing.thermal import (
    READINGS,
    moving_average,
    rms_torque,
    thermal_use,
)

RATED = np.array([1.76, 0.94, 0.57])
SAMPLES = arrays(float, (12, 3), elements=st.floats(-10, 10))


def test_average_solves_its_differential_equation():
    from scipy.integrate import solve_ivp

    step, samples = 0.05, np.random.default_rng(0).normal(size=(60, 1))
    found = moving_average(samples, step, 3.0, start=0.4)[:, 0]
    value = np.array([0.4])
    for k in range(60):
        held = float(samples[k, 0])
        value = solve_ivp(
            lambda _, e, x=held: (x - e) / 3.0, (0, step), value, rtol=1e-11, atol=1e-13
        ).y[:, -1]
        assert found[k] == pytest.approx(value[0], abs=1e-9)


@settings(max_examples=40)
@given(samples=SAMPLES, start=st.floats(-5, 5), cut=st.integers(1, 11))
def test_average_goes_on_where_it_stopped_and_does_not_depend_on_the_step(samples, start, cut):
    whole = moving_average(samples, 0.1, start=start)
    first = moving_average(samples[:cut], 0.1, start=start)
    np.testing.assert_allclose(
        np.concatenate([first, moving_average(samples[cut:], 0.1, start=first[-1])]),
        whole,
        atol=1e-12,
    )
    finer = moving_average(np.repeat(samples, 4, axis=0), 0.025, start=start)[3::4]
    np.testing.assert_allclose(finer, whole, atol=1e-12)


@settings(max_examples=40)
@given(samples=SAMPLES)
def test_periodic_average_ends_where_it_starts_and_has_the_mean_of_its_samples(samples):
    cycle = moving_average(samples, 0.1, periodic=True)
    again = moving_average(samples, 0.1, start=cycle[-1])
    np.testing.assert_allclose(again, cycle, atol=1e-9)
    np.testing.assert_allclose(cycle.mean(0), samples.mean(0), atol=1e-9)
    cold = moving_average(np.tile(samples, (40, 1)), 0.1)
    np.testing.assert_allclose(cold[-12:], cycle, atol=1e-5)


def test_rated_torque_is_used_fully_in_the_long_run_in_both_readings():
    use = thermal_use(np.tile(RATED, (10_000, 1)), RATED, 0.01)
    np.testing.assert_allclose(use.continuous_use, 1)
    np.testing.assert_allclose(use.rms_torque, RATED)
    for reading in READINGS:
        np.testing.assert_allclose(use.peak(reading), 1, atol=1e-12)
        assert np.all(use.peak(reading) <= 1)


@settings(max_examples=40)
@given(torque=SAMPLES)
def test_readings_are_ordered_and_rms_is_the_periodic_mean(torque):
    use = thermal_use(torque, RATED, 0.05, periodic=True)
    # Jensen: the square of an average is never above the average of squares
    assert np.all(use.square_of_ema <= use.ema_of_square + 1e-9)
    np.testing.assert_allclose(use.ema_of_square.mean(0), use.continuous_use**2, atol=1e-9)
    np.testing.assert_allclose(use.rms_torque, rms_torque(-torque))


def test_alternating_torque_heats_and_the_printed_formula_misses_it():
    torque = np.where(np.arange(600) % 2 == 0, 1.0, -1.0)[:, None] * RATED
    use = thermal_use(torque, RATED, 0.01, periodic=True)
    np.testing.assert_allclose(use.ema_of_square, 1)
    assert np.max(use.square_of_ema) < 1e-5


def test_batches_pass_through():
    torque = np.random.default_rng(3).normal(size=(4, 30, 3))
    rated = np.random.default_rng(4).uniform(0.5, 2, (4, 3))
    together = thermal_use(torque, rated, 0.02)
    for i in range(4):
        alone = thermal_use(torque[i], rated[i], 0.02)
        for part in ("rms_torque", "continuous_use", "ema_of_square", "square_of_ema"):
            np.testing.assert_allclose(getattr(together, part)[i], getattr(alone, part), atol=1e-15)


def test_bad_input_is_refused():
    good = np.zeros((4, 3))
    for call, field in (
        (lambda: thermal_use(good, [1, 0, 1], 0.01), "rated_torque"),
        (lambda: thermal_use(good, RATED, 0.0), "time_step"),
        (lambda: thermal_use(good, RATED, 0.01, -3.0), "time_constant"),
        (lambda: thermal_use(good[0], RATED, 0.01), "motor_torque"),
        (lambda: thermal_use(np.full((4, 3), np.inf), RATED, 0.01), "motor_torque"),
        (lambda: moving_average(np.zeros((0, 3)), 0.01), "samples"),
        (lambda: thermal_use(good, RATED, 0.01).peak("mean"), "reading"),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert caught.value.field == field
