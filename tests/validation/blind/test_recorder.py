"""The recorder of rigs: times, lost rows, noise, and which signals are there."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.blind.recorder import TORQUES, Recorder, record
from hyperleg_design.validation.blind.robots.catalogue import chain

RATE, SECONDS = 200.0, 4.0
QUIET = {
    "jitter": 0.0,
    "clock": 0.0,
    "dropped": 0.0,
    "position_noise": 0.0,
    "velocity_noise": 0.0,
    "torque_noise": 0.0,
    "rotor_noise": 0.0,
}


@pytest.fixture(scope="module")
def arm():
    return chain("arm")


@pytest.fixture(scope="module")
def run(arm):
    """A run whose signals are straight lines in time, so that interpolation is exact."""
    n, m = arm.joint_from_motor.shape
    time = np.arange(0, SECONDS + 1e-9, 1e-3)
    joints = time[:, None] * np.arange(1, n + 1)
    motors = -time[:, None] * np.arange(1, m + 1)
    return SimpleNamespace(
        time=time,
        encoder=joints,
        speed=joints + 1,
        motor_velocity=motors,
        command=motors + 2,
        drive_torque=motors + 3,
        temperature=np.full((time.size, m), 30.4),
        voltage=np.full(time.size, 24.0),
    )


def log_of(run, arm, seed=0, **settings):
    rows = int(SECONDS * RATE)
    targets = np.arange(rows)[:, None] * np.ones(len(arm.joints))
    recorder = Recorder(rate=RATE, **settings)
    return record(run, targets, arm, recorder, np.random.default_rng(seed), name="a")


def test_a_perfect_recorder_reads_what_happened(run, arm):
    log = log_of(run, arm, **QUIET, torque="motor_torque", rotors=True)
    np.testing.assert_allclose(log.time, np.arange(800) / RATE)
    for k, joint in enumerate(arm.joints):
        np.testing.assert_allclose(log.column(f"position/{joint}"), (k + 1) * log.time, atol=1e-12)
        np.testing.assert_allclose(log.column(f"position_target/{joint}"), np.arange(800))
    for k, motor in enumerate(arm.motors):
        np.testing.assert_allclose(
            log.column(f"motor_torque/{motor}"), 3 - (k + 1) * log.time, atol=1e-12
        )
        np.testing.assert_allclose(
            log.column(f"motor_velocity/{motor}"), -(k + 1) * log.time, atol=1e-12
        )
        assert set(log.column(f"motor_temperature/{motor}")) == {30.0}


def test_currents_are_torques_over_the_declared_constants(run, arm):
    log = log_of(run, arm, **QUIET)
    constants = log.metadata.torque_constant
    for k, motor in enumerate(arm.motors):
        assert constants[motor] == arm.torque_constant[k]
        torque = constants[motor] * log.column(f"motor_current/{motor}")
        np.testing.assert_allclose(torque, 3 - (k + 1) * log.time, atol=1e-9)


@pytest.mark.parametrize("torque", TORQUES)
def test_only_what_a_rig_knows_is_in_its_log(run, arm, torque):
    log = log_of(run, arm, torque=torque, velocity=False, drives=False)
    kinds = {column.split("/")[0] for column in log.signals}
    expected = {
        "motor_current": {"motor_current"},
        "motor_torque": {"motor_torque", "motor_torque_command"},
        "motor_torque_command": {"motor_torque_command"},
        "none": set(),
    }[torque]
    assert kinds == {"position", "position_target"} | expected


def test_rows_are_lost_times_increase_and_ends_are_kept(run, arm):
    log = log_of(run, arm, dropped=0.2, jitter=2e-3, clock=1e-3)
    assert 0.7 < log.time.size / 800 < 0.9
    assert np.all(np.diff(log.time) > 0)
    assert log.time[0] < 0.02
    assert log.time[-1] > SECONDS - 0.03


def test_noise_has_the_size_that_is_asked_for(run, arm):
    log = log_of(run, arm, **(QUIET | {"position_noise": 0.01}))
    error = log.column(f"position/{arm.joints[0]}") - log.time
    assert np.std(error) == pytest.approx(0.01, rel=0.1)


def test_metadata_given_by_hand_count(run, arm):
    targets = np.zeros((10, len(arm.joints)))
    rng = np.random.default_rng(0)
    log = record(run, targets, arm, Recorder(), rng, name="a", notes="by hand", gains={})
    assert (log.metadata.notes, dict(log.metadata.gains)) == ("by hand", {})
    with pytest.raises((InputError, TypeError)):
        record(run, targets, arm, Recorder(), rng, name="a", color="red")
