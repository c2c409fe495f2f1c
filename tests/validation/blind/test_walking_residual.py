"""What the nominal model leaves over of logs of a robot on its feet, against MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.validation.blind.plants.walking import pad_names
from hyperleg_design.validation.blind.residual import SOFT, rms
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.walking_record import ESTIMATE
from hyperleg_design.validation.blind.walking_residual import shown, walking_residual

STEP, SECONDS = 5e-3, 2.5


@pytest.fixture(scope="module")
def robot():
    return chain("hyperleg")


@pytest.fixture(scope="module")
def signals(robot):
    """A robot whose pelvis hangs still while its legs swing, held by forces on its pads that
    MuJoCo's inverse dynamics asks for; of all such forces the smallest.
    """
    model = mujoco_model(load_design("hyperleg"))
    bits = mujoco.mjtDisableBit
    for bit in (bits.mjDSBL_ACTUATION, bits.mjDSBL_LIMIT, bits.mjDSBL_CONTACT):
        model.opt.disableflags |= int(bit)
    model.dof_damping[:] = model.dof_frictionloss[:] = 0
    data, pads = mujoco.MjData(model), pad_names(model)
    rows = np.array([model.joint(name).dofadr[0] for name in robot.joints])
    places = np.array([model.joint(name).qposadr[0] for name in robot.joints])
    time = np.arange(0, SECONDS, STEP)
    rate = 2 * np.pi * np.linspace(0.5, 1.1, len(rows))
    swing = 0.12 * np.sin(rate * time[:, None])
    velocity = 0.12 * rate * np.cos(rate * time[:, None])
    loads, torque = np.zeros((len(time), len(pads), 3)), np.zeros((len(time), len(rows)))
    jacobian, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for k in range(len(time)):
        mujoco.mj_resetData(model, data)
        data.qpos[3:7] = 1, 0, 0, 0
        data.qpos[places] = robot.rest + swing[k]
        data.qvel[rows], data.qacc[rows] = velocity[k], -(rate**2) * swing[k]
        mujoco.mj_inverse(model, data)
        columns = []
        for pad in pads:
            geom = model.geom(pad)
            point, body = data.geom_xpos[geom.id], int(geom.bodyid[0])
            mujoco.mj_jac(model, data, jacobian, turning, point, body)
            columns.append(jacobian.T.copy())
        push = np.concatenate(columns, -1)
        force = np.linalg.pinv(push[:6]) @ data.qfrc_inverse[:6]
        loads[k] = force.reshape(-1, 3)
        torque[k] = (data.qfrc_inverse - push @ force)[rows]
    torque += robot.coulomb * np.tanh(velocity / SOFT) + robot.viscous * velocity
    drive = torque @ np.linalg.pinv(robot.joint_from_motor).T
    columns = {
        "position": (robot.joints, robot.rest + swing),
        "position_target": (robot.joints, robot.rest + swing),
        "velocity": (robot.joints, velocity),
        "motor_torque": (robot.motors, drive),
        "motor_torque_command": (robot.motors, drive),
        "gyro": ("xyz", np.zeros((len(time), 3))),
        "accelerometer": ("xyz", np.tile([0.0, 0.0, 9.81], (len(time), 1))),
        "base_position": ("xyz", np.zeros((len(time), 3))),
        "base_orientation": ("wxyz", np.tile([1.0, 0.0, 0.0, 0.0], (len(time), 1))),
        "base_velocity": ("xyz", np.zeros((len(time), 3))),
        "contact_force": ([f"{p}_{a}" for p in pads for a in "xyz"], loads.reshape(len(time), -1)),
    }
    return time, {
        f"{kind}/{name}": values[:, k]
        for kind, (names, values) in columns.items()
        for k, name in enumerate(names)
    }


def log_of(signals, **changes):
    time, columns = signals
    return Log("a", time, {**columns, **changes}, Metadata(base="floating"))


def test_a_motion_that_mujoco_explains_leaves_nothing(signals, robot):
    left = walking_residual(log_of(signals), robot)
    n, m = robot.joint_from_motor.shape
    assert left.shape[1] == 6 + n + m
    weight = 9.81 * 32
    assert rms(left[:, :3]).max() < 2e-3 * weight
    assert rms(left[:, 3:6]).max() < 2e-3 * weight  # with a lever of one metre
    assert np.all(
        rms(left[:, 6 : 6 + n]) < 0.02 * np.abs(robot.joint_from_motor) @ robot.peak_torque
    )


def test_a_load_and_a_torque_too_much_are_left_where_they_are(signals, robot):
    columns = signals[1]
    clean = walking_residual(log_of(signals), robot)
    pad = next(
        name for name in columns if name.startswith("contact_force/") and name.endswith("_z")
    )
    pushed = walking_residual(log_of(signals, **{pad: columns[pad] + 10.0}), robot)
    np.testing.assert_allclose(
        (pushed - clean)[:, :3], np.tile([0, 0, 10.0], (len(clean), 1)), atol=1e-6
    )
    motor = robot.motors[3]
    name = f"motor_torque/{motor}"
    driven = walking_residual(log_of(signals, **{name: columns[name] + 0.5}), robot) - clean
    expected = 0.5 * robot.joint_from_motor[:, 3]
    joints = driven[:, 6 : 6 + len(robot.joints)]
    known = np.isfinite(joints)
    assert known.any(0).all()
    np.testing.assert_allclose(
        joints[known], np.broadcast_to(expected, joints.shape)[known], atol=1e-6
    )
    np.testing.assert_allclose(driven[:, :6], 0, atol=1e-9)


def test_joints_that_may_stick_are_unknown(signals, robot):
    time, columns = signals
    name = f"position/{robot.joints[0]}"
    still = {name: np.full(time.size, columns[name][0])}
    left = walking_residual(log_of(signals, **still), robot)
    assert np.isnan(left[:, 6]).all()
    assert np.isfinite(left[:, 7]).mean() > 0.5


def test_the_ground_shows_in_where_the_base_stands(signals, robot):
    lower = {"base_position/z": signals[1]["base_position/z"] - 0.01}
    clean = log_of(signals)
    level = shown("ground_compliance", [log_of(signals, **lower)], [clean], robot)
    assert level == pytest.approx(0.01 / (2 * ESTIMATE[0]) / 3)
    assert shown("ground_friction", [clean], [clean], robot) == 0.0
    assert shown("payload", [clean], [clean], robot) == 0.0
