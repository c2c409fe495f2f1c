"""Simulated logs of a standard motion against the laws that they must obey."""

from __future__ import annotations

import numpy as np
import pytest
import robots

from hyperleg_design.gap.playback.standard_run import EMPTY, FULL, TICK, simulated_log
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def servos(robot_files):
    return load_subject(robot_files["servos"])


@pytest.fixture(scope="module")
def run(servos):
    time = np.arange(601) * TICK
    motion = robots.waves(2, [0.6, 0.8])
    target = np.array([motion(t) for t in time])
    return target, *simulated_log(servos, target, time, ())


def test_the_log_holds_what_was_simulated(servos, run):
    target, position, log = run
    assert position.shape == target.shape
    for place, joint in enumerate(servos.joints):
        np.testing.assert_array_equal(log.column(f"position/{joint}"), position[:, place])
        np.testing.assert_array_equal(log.column(f"position_target/{joint}"), target[:, place])
    np.testing.assert_array_equal(position[0], target[0])
    assert np.abs(position - target).max() < 0.3
    voltage = log.column("battery_voltage")
    assert voltage[-1] / voltage[0] == pytest.approx(EMPTY / FULL)
    assert (np.diff(voltage) < 0).all()


def test_velocities_belong_to_their_positions(servos, run):
    _, position, log = run
    expected = (position[2:] - position[:-2]) / (2 * TICK)
    for place, joint in enumerate(servos.joints):
        error = log.column(f"velocity/{joint}")[1:-1] - expected[:, place]
        assert np.std(error) < 0.003 * np.std(expected[:, place])


def test_a_nominal_run_leaves_no_residual(servos, run):
    *_, log = run
    signals = condition(log, servos)
    own = slice(40, -40)
    torque = np.std(signals.rigid[own], 0)
    assert (np.nanstd(signals.residual["motion"][own], 0) < 0.05 * torque).all()


def test_the_same_motion_gives_the_same_log(servos, run):
    target, position, log = run
    again, other = simulated_log(servos, target, log.time, ())
    np.testing.assert_array_equal(again, position)
    assert set(other.signals) == set(log.signals)


def test_a_standing_biped_is_carried_by_the_ground(standing):
    signals = standing()
    log, subject = signals.log, signals.subject
    weight = float(np.linalg.norm(subject.gravity)) * sum(subject.model.body_mass)
    force = np.nan_to_num(signals.pad_force).sum(1)[20:, 2]
    # momentum: what the ground pushes beyond the weight, over time, is a change of speed
    assert force.mean() == pytest.approx(weight, rel=0.02)
    accelerometer = np.array([log.column(f"accelerometer/{axis}") for axis in "xyz"])[:, 20:]
    assert np.linalg.norm(accelerometer.mean(1)) == pytest.approx(9.81, rel=0.02)
    height = log.column("base_position/z")
    assert np.ptp(height) < 0.2
