"""The machine of a robot against the transmission and the motors that it is made of."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.simulation.drives.machine import (
    bus_voltage,
    legs_matrix,
    machine_of,
    rotor_inertia,
)
from hyperleg_design.simulation.layout import layout_of


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed"])
def test_both_legs_beside_each_other(design, variant):
    robot = ablate(design, variant)
    machine, layout = machine_of(robot), layout_of(robot)
    assert machine.joints == layout.joints
    assert machine.motors == layout.motors
    np.testing.assert_array_equal(
        machine.joint_from_motor, np.kron(np.eye(2), transmission.joint_from_motor(robot))
    )
    np.testing.assert_allclose(
        machine.joint_from_motor @ machine.motor_from_joint, np.eye(len(layout.joints)), atol=1e-9
    )
    count = len(transmission.motor_names(robot))
    for name in (
        "no_load_speed",
        "stall_torque",
        "peak_torque",
        "rated_torque",
        "power_constant",
        "rotor_inertia",
    ):
        np.testing.assert_array_equal(
            getattr(machine, name), np.tile(getattr(motor_arrays(robot), name)[:count], 2)
        )
    assert machine.stiffness[machine.joint("right_knee")] == robot.joints.knee.stiffness
    np.testing.assert_array_equal(rotor_inertia(robot), machine.rotor_inertia[:count])


def test_voltage_follows_the_ratio_and_is_unknown_where_robots_differ(design):
    assert np.isnan(bus_voltage(design))  # hips of 36 V motors, legs of 48 V ones
    alike = design.with_values(
        {
            f"actuators.{name}.motor": design.actuators.knee.motor
            for name in ("hip_yaw", "hip_roll", "hip_pitch")
        }
    )
    assert bus_voltage(alike) == 48.0
    assert bus_voltage(alike.with_values({"electrical.voltage_ratio": 0.5})) == 24.0
    assert np.isnan(
        bus_voltage(alike.with_values({"electrical.voltage_ratio": np.array([0.5, 1.0])}))
    )


def test_matrices_of_legs_stand_on_the_diagonal():
    matrix = np.arange(24.0).reshape(2, 2, 2, 3)
    whole = legs_matrix(matrix)
    np.testing.assert_array_equal(whole[1, :2, :3], matrix[1, 0])
    np.testing.assert_array_equal(whole[1, 2:, 3:], matrix[1, 1])
    assert not whole[:, :2, 3:].any()
    np.testing.assert_array_equal(legs_matrix(matrix[:, :1])[0, 2:, 3:], matrix[0, 0])
