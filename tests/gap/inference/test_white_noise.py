import numpy as np
import pytest

from hyperleg_design.gap.inference.white_noise import white_density

STEP = 0.005
TIME = np.arange(8000) * STEP


def noise(deviation):
    """White noise of a log whose clock drifts by a tick, interpolated onto even ticks."""
    white = np.random.default_rng(4).normal(0, deviation, len(TIME) + 1)
    between = np.linspace(0, 1, len(TIME))
    return (1 - between) * white[:-1] + between * white[1:]


def test_the_density_of_white_noise_is_its_variance_over_its_bandwidth():
    known = np.ones(len(TIME), bool)
    expected = 0.3**2 * 2 * STEP
    assert white_density(noise(0.3), known, 20.0, STEP) == pytest.approx(expected, rel=0.2)


def test_motion_below_the_cutoff_and_single_lines_do_not_move_it():
    known = np.ones(len(TIME), bool)
    moving = 50 * np.sin(2 * np.pi * 1.5 * TIME) + 0.5 * np.sin(2 * np.pi * 31 * TIME)
    alone, both = (
        white_density(values, known, 20.0, STEP) for values in (noise(0.3), noise(0.3) + moving)
    )
    assert both == pytest.approx(alone, rel=0.1)


def test_a_log_of_few_ticks_tells_no_noise():
    assert white_density(noise(0.3), TIME < 0.3, 20.0, STEP) == 0.0
