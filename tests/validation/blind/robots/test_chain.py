import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.validation.blind.robots.catalogue import chain


@pytest.mark.parametrize("name", ["arm", "servo"])
def test_inverse_dynamics_are_those_of_mujoco(name):
    robot = chain(name)
    model = robot.pinocchio()
    other = mujoco.MjModel.from_xml_string(robot.mjcf)
    other.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION) | int(
        mujoco.mjtDisableBit.mjDSBL_LIMIT
    )
    other.dof_armature[:] = other.dof_damping[:] = other.dof_frictionloss[:] = 0
    data, random = mujoco.MjData(other), np.random.default_rng(0)
    for _ in range(5):
        q, v, a = random.normal(size=(3, len(robot.joints)))
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(other, data)
        np.testing.assert_allclose(
            pin.rnea(model, model.createData(), q, v, a), data.qfrc_inverse, atol=1e-10
        )


def test_a_point_mass_weighs_what_it_weighs():
    robot = chain("arm")
    loaded = robot.with_point_mass("flange", 2.0, np.array([-0.1, 0.02, 0.0]))
    q, zero = robot.rest, np.zeros(7)

    def hold(which):
        model = which.pinocchio()
        return pin.rnea(model, model.createData(), q, zero, zero)

    model = robot.pinocchio()
    data = model.createData()
    pin.computeJointJacobians(model, data, q)
    jacobian = pin.getJointJacobian(model, data, 7, pin.LOCAL_WORLD_ALIGNED)
    arm = data.oMi[7].rotation @ np.array([-0.1, 0.02, 0.0])
    weight = np.array([0, 0, 2.0 * 9.81])
    np.testing.assert_allclose(
        hold(loaded) - hold(robot),
        jacobian.T @ np.concatenate([weight, np.cross(arm, weight)]),
        atol=1e-9,
    )
