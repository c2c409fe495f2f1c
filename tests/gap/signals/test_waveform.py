import numpy as np
import pytest
from effects.pendulum import run, subject
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import sawtooth

from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.waveform import knocks, sharpness


@given(st.floats(-3, 3), st.floats(0.01, 5), st.floats(-1, 1), st.floats(-1, 1))
def test_neither_shifts_in_time_nor_size_change_it(shift, size, real, imaginary):
    wave = np.exp(1j * (np.linspace(0, 40, 300) + shift))
    assert sharpness(size * wave, size * complex(real, imaginary) * wave**3) == pytest.approx(
        complex(real, imaginary), rel=1e-6, abs=1e-9
    )


def test_of_a_triangle_it_is_a_ninth_and_of_unlike_lines_nothing():
    first = np.exp(1j * np.linspace(0, 2 * np.pi * 40, 4000, endpoint=False))
    assert sharpness(first, first**3 / 9) == pytest.approx(1 / 9)
    assert abs(sharpness(first, first / 9)) < 1e-12
    assert sharpness(np.zeros(3), np.zeros(3)) == 0


@pytest.fixture(scope="module")
def swinging(tmp_path_factory):
    """A pendulum's log with a swing added to what its joint does, or also to its target."""
    log, folder = run(duration=8.0), tmp_path_factory.mktemp("pendulum")
    nominal = subject(folder, log)
    noise = np.random.default_rng(1).normal(0, 1e-5, len(log.time))

    def made(way, *, commanded=False):
        added = dict(log.signals)
        added["position/swing"] = added["position/swing"] + way(log.time) + noise
        added["velocity/swing"] = added["velocity/swing"] + np.gradient(way(log.time), log.time)
        if commanded:
            added["position_target/swing"] = added["position_target/swing"] + way(log.time)
        return condition(log.changed(signals=added), nominal)

    return made


def triangle(time, frequency=13.0):
    return 0.005 * sawtooth(2 * np.pi * frequency * time, 0.5)


def sine(time):
    return 0.005 * np.sin(2 * np.pi * 13.0 * time)


def flattened(time):
    return np.clip(1.6 * sine(time), -0.005, 0.005)


def test_joints_knock_that_move_at_constant_speed_between_turns(swinging):
    assert knocks([swinging(triangle)], 0)
    assert not knocks([swinging(sine)], 0)
    assert not knocks([swinging(flattened)], 0), "held at its turns, a joint is rather rubbed"


def test_what_targets_command_is_no_knock(swinging):
    assert not knocks([swinging(triangle, commanded=True)], 0)


def test_a_swing_whose_harmonic_no_log_shows_tells_nothing(swinging):
    assert not knocks([swinging(lambda time: triangle(time, 45.0))], 0)
    assert not knocks([swinging(lambda time: 0 * time)], 0)
