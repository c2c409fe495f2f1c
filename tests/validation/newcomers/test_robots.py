"""The newcomers' robots: their files load, and each motor has a value of everything."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers.robots import ROBOTS


@pytest.fixture(params=ROBOTS, scope="module")
def named(request):
    robot = ROBOTS[request.param]
    return robot, mujoco.MjModel.from_xml_string(robot.xml)


def test_every_joint_has_gains_and_a_motion(named):
    robot, model = named
    assert model.nq == model.nv == model.nu  # hinges on a fixed base, a motor each
    for values in (robot.stiffness, robot.damping, robot.middle, robot.swing):
        assert len(values) == model.nv
    assert min(robot.stiffness) > 0 < min(robot.damping)


def test_motions_stay_within_the_ranges_of_the_joints(named):
    robot, model = named
    middle, swing = np.array(robot.middle), np.array(robot.swing)
    assert np.all(middle - swing >= model.jnt_range[:, 0])
    assert np.all(middle + swing <= model.jnt_range[:, 1])


def test_motors_hold_the_robot_at_the_ends_of_its_motion(named):
    robot, model = named
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    moment = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(
        moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
    )
    for side in (-1, 0, 1):
        data.qpos[:] = np.array(robot.middle) + side * np.array(robot.swing)
        mujoco.mj_forward(model, data)
        torque = np.linalg.solve(moment.T, data.qfrc_bias)
        assert np.all(np.abs(torque) < model.actuator_ctrlrange[:, 1])
