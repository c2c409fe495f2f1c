"""What drives and sensors tell: nothing without alterations, the truth with those that change
nothing, zero where asked to forget.
"""

import numpy as np

from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.drives.told import TOLD, Told


def test_without_a_change_the_truth_is_told_and_what_is_forgotten_is_zero():
    rng = np.random.default_rng(0)
    machine = machine_of(load_design())
    chain = Chain(machine, (Alteration(),), 3, 0.005)
    told = Told(chain, 2)
    position, velocity = rng.normal(size=(2, 3, len(machine.joints)))
    driven = chain.drive(position, velocity, target=position + 0.01)
    turning = rng.normal(size=(3, 3))
    told.keep(1, driven, position, velocity, turning)
    found = {name.removeprefix(TOLD): values for name, values in told.signals.items()}
    for name, values in {
        "joint_position": position,
        "joint_velocity": velocity,
        "motor_torque": driven.torque,
        "angular_velocity": turning,
    }.items():
        np.testing.assert_array_equal(found[name][1], values)
        assert not found[name][0].any()
    assert not found["acceleration_error"].any()
    np.testing.assert_allclose(
        found["motor_command"][1] @ machine.joint_from_motor.T,
        machine.stiffness * 0.01 - machine.damping * velocity,
        atol=1e-9,
    )
    told.forget([1])
    assert not any(values[:, 1].any() for values in told.signals.values())
    assert all(values[1, 2].any() for name, values in found.items() if name != "acceleration_error")
