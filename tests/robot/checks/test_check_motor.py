"""The torque constant of a motor against its voltage and speed, and its stall torque against its
peak torque.
"""

from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.robot.checks.check_motor import check_motor
from hyperleg_design.robot.motors import catalogue


def scaled(name, factor, field="torque_constant"):
    motor = catalogue()[name]
    constant = motor.constants[field]
    constant = dataclasses.replace(constant, value=factor * constant.value)
    return dataclasses.replace(motor, constants={**motor.constants, field: constant})


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_shipped_motors_agree_and_a_factor_of_ten_does_not(name):
    assert check_motor(catalogue()[name]) == []
    for factor in (10, 0.1):
        (finding,) = check_motor(scaled(name, factor))
        assert finding.severity == "warning"


def test_the_constant_that_fits_is_named():
    (finding,) = check_motor(scaled("U10", 10))
    right = catalogue()["U10"].torque_constant
    assert f"is {10 * right:.4g} Nm/A, 10 times" in finding.message
    assert f"({right:.3g} Nm/A)" in finding.message


def test_a_resistance_with_which_the_peak_torque_is_never_reached():
    # 0.1 Nm/A through 0.92 ohm at 444.9 rad/s stalls at 4.836 Nm, above the peak of 4 Nm
    assert check_motor(scaled("MF0076008", 1.2, "resistance")) == []
    (finding,) = check_motor(scaled("MF0076008", 2, "resistance"))
    assert (finding.severity, finding.place) == ("warning", "constants.peak_torque")
    assert "is 4 Nm, more than the stall torque of 2.418 Nm" in finding.message
