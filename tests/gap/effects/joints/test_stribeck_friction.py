import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

STRIBECK = effect("stribeck_friction")


def slow(time):
    return 0.3 * np.sin(0.6 * time)


def test_trace_is_what_a_sticking_pendulum_leaves_in_slow_motion(pendulum):
    signals = pendulum(Wrong(breakaway=0.5, stribeck_speed=0.1), target=slow, duration=20.0)
    right, wrong = (
        STRIBECK.trace(signals, "swing", np.array([[0.5, speed]])) for speed in (0.1, 0.02)
    )
    assert misfit(signals, right) < 0.35
    assert misfit(signals, wrong) > 2 * misfit(signals, right)


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("stribeck_friction", [0.4, 0.2], target=slow, duration=10.0)
    assert misfit(signals, STRIBECK.trace(signals, "swing", np.array([[0.4, 0.2]]))) < 0.35


def test_fast_motion_does_not_feel_it(pendulum):
    signals = pendulum(Wrong())
    trace = STRIBECK.trace(signals, "swing", np.array([[0.5, 0.05]]))["motion"][0, :, 0]
    assert np.abs(trace[np.abs(signals.velocity[:, 0]) > 0.2]).max() < 1e-6
