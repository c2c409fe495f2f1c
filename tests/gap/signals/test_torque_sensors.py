"""Torque sensors between gears and links."""

import diagnosed
import numpy as np
import pytest
import robots

from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.smoothing import Smooth
from hyperleg_design.gap.signals.torque_sensors import behind_gears, taken_before


@pytest.fixture(scope="module")
def sensed():
    return robots.with_torque_sensors(diagnosed.run("healthy", 0))


@pytest.fixture(scope="module")
def subject(robot_files, sensed):
    return load_subject(robot_files["coupled"], [sensed])


def test_joints_with_a_sensor_and_no_measured_motor_are_found(sensed, subject):
    np.testing.assert_array_equal(behind_gears(sensed, subject), [True, True])
    hip = sensed.changed(metadata=sensed.metadata.changed(torque_sensors=("hip",)))
    np.testing.assert_array_equal(behind_gears(hip, subject), [True, False])


def test_there_is_none_without_a_declared_sensor_or_its_signal(sensed, subject):
    undeclared = sensed.changed(metadata=sensed.metadata.changed(torque_sensors=()))
    assert behind_gears(undeclared, subject) is None
    assert behind_gears(robots.without(sensed, "joint_torque"), subject) is None


def test_a_motor_that_tells_its_torque_needs_none(sensed, subject):
    """Both joints are moved by both motors, so that either of them is enough."""
    told = {"motor_torque/m_front": np.zeros(len(sensed.time))}
    assert behind_gears(sensed.changed(signals=dict(sensed.signals) | told), subject) is None


def test_a_sensor_behind_the_gear_does_not_feel_friction_and_rotors(subject):
    rng = np.random.default_rng(0)
    rate, bend = rng.normal(size=(2, 50, 2))
    motion = Smooth(np.zeros_like(rate), rate, bend, *np.ones((2, 2)))
    taken = taken_before(subject, np.array([True, False]), motion, None)
    rotors, damping = bend @ subject.armature.T, np.array([0.05, 0.03])
    np.testing.assert_allclose(taken[:, 0], (damping * rate + rotors)[:, 0])
    assert not taken[:, 1].any()
