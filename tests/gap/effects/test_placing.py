from dataclasses import replace

import numpy as np
import pytest
from pendulum import Wrong

from hyperleg_design.gap.effects import placing
from hyperleg_design.gap.signals.conditioning import limited_torque


def test_changes_of_measured_motors_show_in_the_drive_and_others_in_motion(pendulum):
    change = np.ones((2, 1600))
    seen, unseen = pendulum(Wrong()), pendulum(Wrong(), sees=())
    assert set(placing.before_measurement(seen, {0: change})) == {"drive"}
    assert np.all(placing.before_measurement(seen, {0: change})["drive"] == 1)
    assert set(placing.before_measurement(unseen, {0: change})) == {"motion"}
    assert np.all(placing.before_measurement(unseen, {0: change})["motion"] == -1)


def test_a_coupled_motor_reaches_its_joints_by_its_column(leg):
    signals = leg(duration=1.0)
    torque = np.random.default_rng(0).normal(size=(3, len(signals.time)))
    found = placing.at_motor(signals, 1, torque)["motion"]
    np.testing.assert_allclose(found, torque[..., None] * signals.subject.joint_from_motor[:, 1])


def test_limits_are_those_of_conditioning():
    from types import SimpleNamespace

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    rng = np.random.default_rng(1)
    velocity, torque = rng.normal(0, 8, (500, 14)), rng.normal(0, 4, (500, 14))
    speed = velocity @ subject.joint_from_motor
    signals = SimpleNamespace(subject=subject, motor_speed=speed, supplied=np.ones((1, 14)))
    for jump in (None, rng.normal(0, 2, (500, 14))):
        signals.jump = jump
        whole = limited_torque(subject, torque.copy(), speed, jump=jump)
        assert not np.allclose(whole, torque)
        for motor in range(14):
            np.testing.assert_allclose(
                placing.limited(signals, motor, torque[:, motor]), whole[:, motor], rtol=1e-10
            )


def test_strength_is_the_torque_of_the_motors_or_what_gravity_needs(pendulum):
    from pendulum import INERTIA, LENGTH, MASS, ROTOR

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    expected = np.abs(subject.joint_from_motor) @ subject.torque_limit
    np.testing.assert_allclose(placing.joint_strength(subject), expected)
    free = pendulum(Wrong()).subject
    weight = 2 * MASS * 9.81 * LENGTH
    assert placing.joint_strength(free)[0] == pytest.approx(weight, rel=0.1)
    assert placing.joint_inertia(free)[0] == pytest.approx(INERTIA + MASS * LENGTH**2)
    assert free.rotor_inertia[0] == pytest.approx(ROTOR)


def test_limits_far_beyond_what_all_joints_need_are_placeholders(leg):
    subject = leg(duration=1.0).subject
    needed = np.maximum(*placing._needed(subject))
    count = len(subject.motors)
    unlimited = {"stall_torque": np.full(count, np.inf)}
    huge = replace(subject, torque_limit=np.full(count, 1e4), **unlimited)
    np.testing.assert_array_equal(placing.joint_strength(huge), needed)
    unknown = replace(subject, torque_limit=np.full(count, np.inf), **unlimited)
    for motor in range(count):
        strength = placing.motor_strength(unknown, motor)
        assert placing.motor_strength(huge, motor) == strength < 1e3
    usual = replace(subject, torque_limit=np.full(count, 3 * needed.max()), **unlimited)
    share = np.abs(subject.joint_from_motor)
    np.testing.assert_allclose(placing.joint_strength(usual), share @ usual.torque_limit)
