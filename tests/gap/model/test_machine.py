"""The machine of a subject is that of its design, or of its file."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.drives.machine import machine_of as machine_of_design


def test_a_design_has_one_machine_however_it_is_asked():
    design = load_design(variant="toe_removed")
    own, other = machine_of(subject_of(design)), machine_of_design(design)
    assert own.joints == other.joints
    assert own.motors == other.motors
    for name in (
        "joint_from_motor",
        "motor_from_joint",
        "stiffness",
        "damping",
        "rotor_inertia",
        "no_load_speed",
        "stall_torque",
        "peak_torque",
        "power_constant",
        "rated_torque",
    ):
        np.testing.assert_allclose(
            getattr(own, name), getattr(other, name), rtol=1e-9, atol=1e-12, err_msg=name
        )


def test_a_file_has_what_it_says_and_no_limit_that_it_does_not(robot_files):
    machine = machine_of(load_subject(robot_files["arm"]))
    assert machine.stiffness.tolist() == [2000, 2000, 2000, 500, 500, 500]
    assert machine.peak_torque.tolist() == [150, 150, 150, 28, 28, 28]
    assert np.isinf(machine.stall_torque).all()
    assert np.isnan(machine.voltage)
    assert not machine.power_constant.any()
