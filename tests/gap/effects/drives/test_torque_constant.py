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


def test_what_a_drive_says_of_its_torque_is_off_by_a_share_of_what_it_was_asked_for(pendulum):
    signals = pendulum(Wrong())
    trace = CONSTANT.nuisance_trace(signals, "swing", 1, 0.02)
    asked = signals.measured - signals.residual["drive"]
    assert set(trace) == {"drive"}
    np.testing.assert_array_equal(trace["drive"], 0.02 * asked)
    assert CONSTANT.nuisance_trace(signals, "swing", 0, 0.02) is None
    assert CONSTANT.nuisance_trace(pendulum(Wrong(), sees=()), "swing", 1, 0.02) == {}


def test_what_a_sensor_behind_the_gear_reads_is_off_by_a_share_of_its_torque(pendulum):
    signals = pendulum(Wrong(), sees=("joint_torque", "motor_torque_command"))
    trace = CONSTANT.nuisance_trace(signals, "swing", 1, 0.02)
    assert set(trace) == {"motion", "drive"}
    for rows in trace.values():
        np.testing.assert_allclose(rows, 0.02 * signals.rigid)
