from dataclasses import replace

import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.placing import given

CONSTANT = effect("torque_constant")


def test_trace_is_what_a_weak_motor_leaves(pendulum):
    for sees in (("motor_torque",), ()):
        signals = pendulum(Wrong(constant=0.85), sees=sees)
        trace = CONSTANT.trace(signals, "swing", np.array([[0.85, 0.0]]))
        assert set(trace) == {"motion"}
        assert misfit(signals, trace) < 0.02


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("torque_constant", [0.85, 0.0])
    assert misfit(signals, CONSTANT.trace(signals, "swing", np.array([[0.85, 0.0]]))) < 0.02


def test_a_wrong_reading_leaves_the_motion_and_shows_in_both_balances(simulated):
    healthy, signals = simulated("torque_constant", None), simulated("torque_constant", [0.85, 1.0])
    assert np.abs(signals.position - healthy.position).max() < 1e-9
    np.testing.assert_allclose(0.85 * signals.measured, healthy.measured, atol=1e-9)
    trace = CONSTANT.trace(signals, "swing", np.array([[0.85, 1.0]]))
    for residual_name in ("motion", "drive"):
        assert (
            misfit(signals, trace, residual_name) < 0.08
        )  # the simulation's controller runs between the log's ticks


def test_a_wrong_reading_is_tried_where_the_log_tells_both_torques(pendulum):
    assert CONSTANT.variants(pendulum(Wrong()), "swing").tolist() == [[1.0, 0.0], [1.0, 1.0]]
    assert CONSTANT.variants(pendulum(Wrong(), sees=()), "swing").tolist() == [[1.0, 0.0]]


def test_torque_that_targets_alone_tell_is_scaled_as_both_gains_would(pendulum):
    """They are one cause there; noise of the sensors by which the torque is worked out is scaled by
    neither.
    """
    gain = effect("controller_gain")
    signals = pendulum(Wrong(constant=0.85), sees=())
    believed, rng = signals.believed, np.random.default_rng(0)
    noisy = replace(
        signals, believed=believed + 0.3 * believed.std() * rng.standard_normal(believed.shape)
    )
    for one in (signals, noisy):
        scaled = CONSTANT.trace(one, "swing", np.array([[0.85, 0.0]]))["motion"]
        np.testing.assert_allclose(
            scaled, gain.trace(one, "swing", np.array([[0.85, 0.85]]))["motion"], atol=1e-9
        )
    measured = pendulum(Wrong(constant=0.85), sees=("motor_torque",))
    assert np.array_equal(given(measured, 0), measured.believed[:, 0])
