import numpy as np
import pytest

from hyperleg_design.simulation.drives.thermal import ThermalState
from hyperleg_design.simulation.settings import Thermal


def test_average_of_squares_makes_the_penalty_memoryless():
    """With the margin's own time constant the penalty is the present overload over T, whatever came
    before.
    """
    rng = np.random.default_rng(0)
    state = ThermalState(Thermal(), (5, 3))
    for _ in range(50):
        load = rng.normal(size=(4, 5, 3)) * 1.5
        penalty = state.advance(load, 0.02)
        present = np.maximum((load**2).mean(0) - 1.0, 0).sum(-1) / 3.0
        np.testing.assert_allclose(penalty, present)


@pytest.mark.parametrize("reading", ["ema_of_square", "square_of_ema"])
def test_penalty_is_the_margins_rate(reading):
    """[-(dh/dt + h / T)]+ from the margins before and after a short step."""
    rng = np.random.default_rng(1)
    state = ThermalState(Thermal(reading=reading, time_constant=2.0, threshold=0.7), (6, 4))
    state.average[:] = rng.uniform(0, 1.5, (6, 4))
    load, duration = np.repeat(rng.normal(size=(1, 6, 4)) * 2, 4, 0), 1e-6
    before = state.margin
    penalty = state.advance(load, duration)
    expected = np.maximum(-((state.margin - before) / duration + before / 2.0), 0).sum(-1)
    np.testing.assert_allclose(penalty, expected, rtol=1e-4, atol=1e-4)
    assert np.any(penalty > 0)


@pytest.mark.parametrize("reading", ["ema_of_square", "square_of_ema"])
def test_constant_load_at_the_rated_torque_leaves_no_margin(reading):
    state = ThermalState(Thermal(reading=reading), (1, 1))
    for _ in range(5000):
        state.advance(np.ones((4, 1, 1)), 0.02)
    assert state.margin[0, 0] == pytest.approx(0, abs=1e-9)


def test_time_constant():
    state = ThermalState(Thermal(time_constant=3.0), (1, 1))
    for _ in range(3000):
        state.advance(np.ones((1, 1, 1)), 0.001)
    assert state.average[0, 0] == pytest.approx(1 - np.exp(-1), abs=2e-4)


def test_the_readings_differ_where_the_sign_changes():
    square, signed = (
        ThermalState(Thermal(reading=r), (1, 1)) for r in ("ema_of_square", "square_of_ema")
    )
    for step in range(1000):
        for state in (square, signed):
            state.advance(np.full((4, 1, 1), 2.0 * (-1) ** step), 0.02)
    assert square.margin[0, 0] < -2
    assert signed.margin[0, 0] > 0.9


def test_reset_cools():
    state = ThermalState(Thermal(), (3, 2))
    state.average[:] = 1.0
    state.reset(np.array([1]))
    np.testing.assert_array_equal(state.average, [[1, 1], [0, 0], [1, 1]])
