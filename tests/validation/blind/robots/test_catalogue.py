import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.validation.blind.robots.catalogue import ROBOTS, chain


def test_the_design_is_the_design():
    robot, rigid = chain("hyperleg"), rigid_body_model(load_design("hyperleg"), floating=False)
    model = robot.pinocchio()
    q, v, a = np.random.default_rng(1).normal(size=(3, 14))
    ours = (
        pin.rnea(model, model.createData(), q, v, a)
        + robot.joint_from_motor * robot.rotor_inertia @ robot.joint_from_motor.T @ a
    )
    np.testing.assert_allclose(ours, rigid.inverse_dynamics(q, v, a), atol=1e-10)


def test_one_leg_is_the_left_half():
    leg, both = chain("leg"), chain("hyperleg")
    assert leg.joints == both.joints[:7]
    assert leg.motors == both.motors[:7]
    np.testing.assert_array_equal(leg.joint_from_motor, both.joint_from_motor[:7, :7])
    np.testing.assert_array_equal(leg.coulomb, both.coulomb[:7])


@pytest.mark.parametrize("name", ROBOTS)
def test_postures_and_names(name):
    robot = chain(name)
    assert np.all(robot.low < robot.rest)
    assert np.all(robot.rest < robot.high)
    assert robot.joint_from_motor.shape == (len(robot.joints), len(robot.motors))


def test_no_such_robot():
    with pytest.raises(ValueError, match="no robot"):
        chain("dog")
