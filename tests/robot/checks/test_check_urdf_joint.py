"""Joints of a URDF."""

from __future__ import annotations

from hyperleg_design.robot.checks.check_urdf import check_urdf
from tests.robot.checks.urdfs import GOOD


def test_a_joint_without_a_motor_is_right():
    passive = GOOD.replace('effort="10" velocity="5"', 'effort="0" velocity="0"')
    assert passive != GOOD
    assert check_urdf(passive) == []
