import numpy as np

from hyperleg_design.gap.effects.waves import fitted_waves, peaks

ANGLE = np.linspace(0.0, 40.0, 2000)


def test_the_largest_peak_is_the_wave_that_is_there():
    orders = np.arange(1.0, 30.0)
    wanted = 0.3 * np.cos(7 * ANGLE) - 0.2 * np.sin(7 * ANGLE) + 0.05 * np.sin(20 * ANGLE)
    gains, sizes = fitted_waves(wanted, ANGLE, orders, np.zeros((len(ANGLE), 0)))
    first, second = orders[peaks(gains, 2)]
    assert (first, second) == (7.0, 20.0)
    np.testing.assert_allclose(sizes[6], [0.3, -0.2], atol=0.01)


def test_what_stands_beside_is_no_wave():
    beside = np.linalg.qr(np.stack([np.cos(7 * ANGLE), np.sin(7 * ANGLE)], -1))[0]
    gains, _ = fitted_waves(np.cos(7 * ANGLE), ANGLE, np.array([7.0]), beside)
    assert gains[0] < 1e-6


def test_a_factor_scales_the_waves():
    factor = 1 + 0.5 * np.sin(0.3 * ANGLE)
    _, sizes = fitted_waves(
        factor * np.cos(5 * ANGLE), ANGLE, np.array([5.0]), np.zeros((len(ANGLE), 0)), factor
    )
    np.testing.assert_allclose(sizes[0], [1.0, 0.0], atol=0.01)


def test_flat_gains_have_as_many_peaks_as_are_asked_for():
    assert len(peaks(np.ones(5), 2)) == 2
    assert list(peaks(np.array([1.0, 3.0, 2.0, 5.0, 4.0]), 9)) == [3, 1]
