"""Derated torques of joints."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sizing.derating import derated_torques
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits


def test_at_standstill_the_limits_are_the_maxima_of_table_one():
    design = load_robot("hyperleg")
    limits = derated_torques(design, *torque_limits(motor_envelope(design), 0.0))
    assert limits.names == ("knee", "ankle_pitch", "ankle_roll", "toe")
    most = transmission.max_joint_torque(design, "walking")
    np.testing.assert_allclose(limits.upper, most[3:])
    np.testing.assert_allclose(limits.lower, -most[3:])
    assert limits.reached(most * [1, 1, 1, 1, 0.9, -1, -0.9], 1e-3) == ("knee", "ankle_roll")


def test_a_torque_that_brakes_in_any_case_is_not_derated():
    design = load_robot("teaching_leg", overrides={"joints.hip.derate": 0.5})
    envelope = motor_envelope(design)
    lower, upper = torque_limits(envelope, 1.05 * envelope.no_load_speed)
    limits = derated_torques(design, lower, upper)
    assert limits.names == ("hip",)
    assert limits.upper == 6 * upper[0] < 0
    assert limits.lower == 0.5 * 6 * lower[0]
