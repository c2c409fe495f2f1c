import mujoco
import numpy as np
import pytest

from hyperleg_design import resources
from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.model.rig_spec import rig_spec
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design


def test_spec_has_the_dynamics_of_the_subject(robot_files):
    model = rig_spec(load_subject(str(robot_files["pendulum"])), 0.001).compile()
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = 0.7, 0.3
    mujoco.mj_forward(model, data)
    gravity = 0.5 * 9.81 * 0.1 * np.sin(0.7)
    assert abs(data.qfrc_bias[0]) == pytest.approx(gravity, rel=1e-9)
    inertia = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, inertia)
    assert inertia[0, 0] == pytest.approx(0.0006 + 0.5 * 0.1**2 + 0.003, rel=1e-9)


def test_coupled_rotors_and_gravity_are_those_of_inverse_dynamics():
    subject = subject_of(load_design(resources.find("descriptions", "hyperleg")), "fixed")
    model = rig_spec(subject, 0.001).compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(0)
    position, velocity, acceleration = (
        rng.uniform(-0.3, 0.3, len(subject.joints)) for _ in range(3)
    )
    position = position + subject.default
    data.qpos[:], data.qvel[:] = position, velocity
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    ours = rigid.inverse_dynamics(subject, position[None], velocity[None], acceleration[None])[0]
    assert inertia @ acceleration + data.qfrc_bias == pytest.approx(ours, abs=1e-8)
