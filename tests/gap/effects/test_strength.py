from dataclasses import replace

import numpy as np
import pytest
from pendulum import Wrong

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects import strength as strengths


def test_strength_is_the_torque_of_the_motors_or_what_gravity_needs(pendulum):
    from pendulum import INERTIA, LENGTH, MASS, ROTOR

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    expected = np.abs(subject.joint_from_motor) @ subject.torque_limit
    np.testing.assert_allclose(strengths.joint_strength(subject), expected)
    free = pendulum(Wrong()).subject
    weight = 2 * MASS * 9.81 * LENGTH
    assert strengths.joint_strength(free)[0] == pytest.approx(weight, rel=0.1)
    assert strengths.joint_inertia(free)[0] == pytest.approx(INERTIA + MASS * LENGTH**2)
    assert free.rotor_inertia[0] == pytest.approx(ROTOR)


def test_limits_far_beyond_what_all_joints_need_are_placeholders(leg):
    subject = leg(duration=1.0).subject
    needed = np.maximum(*strengths._needed(subject))
    count = len(subject.motors)
    unlimited = {"stall_torque": np.full(count, np.inf)}
    huge = replace(subject, torque_limit=np.full(count, 1e4), **unlimited)
    np.testing.assert_array_equal(strengths.joint_strength(huge), needed)
    unknown = replace(subject, torque_limit=np.full(count, np.inf), **unlimited)
    for motor in range(count):
        strength = strengths.motor_strength(unknown, motor)
        assert strengths.motor_strength(huge, motor) == strength < 1e3
    usual = replace(subject, torque_limit=np.full(count, 3 * needed.max()), **unlimited)
    share = np.abs(subject.joint_from_motor)
    np.testing.assert_allclose(strengths.joint_strength(usual), share @ usual.torque_limit)


def test_a_joint_without_limits_may_take_more_than_it_needs(pendulum, leg):
    limited = leg(duration=1.0).subject
    np.testing.assert_array_equal(
        strengths.largest_torque(limited), strengths.joint_strength(limited)
    )
    free = pendulum(Wrong()).subject
    np.testing.assert_allclose(
        strengths.largest_torque(free), strengths.BEYOND * strengths.joint_strength(free)
    )
    friction = EFFECTS["coulomb_friction"].bounds(free.joints[0], free)
    assert friction[1, 0] == pytest.approx(strengths.largest_torque(free)[0])
