"""The actuation as MuJoCo gets it: tendons, native motors, friction, posture."""

import mujoco
import numpy as np
import pytest
from mujoco.batch import Batch

from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.linkage import LinkageModel
from hyperleg_design.robot.mjcf import mujoco_spec
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.simulation.drives.actuation import actuation_model, friction_torque
from hyperleg_design.simulation.drives.drive import Drive
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.settings import Physics
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits


def in_motion(batch, seed=0):
    """Random states off the floor."""
    rng = np.random.default_rng(seed)
    batch.reset(None, 0, 0)
    batch.qpos[:, 2] += 0.5
    batch.qpos[:, 7:] += rng.uniform(-0.2, 0.2, batch.qpos[:, 7:].shape)
    batch.qvel[:, 6:] = rng.normal(size=batch.qvel[:, 6:].shape) * 3
    return rng


def driven(design, count=3, **physics):
    settings = Physics(**physics)
    layout = layout_of(design)
    batch = Batch(simulation_model(design, settings), count, 1)
    drive = Drive(design, layout, settings, batch, None, np.random.default_rng(0))
    torque, speed = np.zeros((2, count, len(layout.motors)))
    rng = in_motion(batch)
    target = layout.default + rng.normal(size=(count, len(layout.joints)))
    drive.apply(target.reshape(count, 2, -1), torque, speed)
    return drive, batch, layout, torque, speed


@pytest.mark.parametrize("variant", VARIANTS)
def test_tendons_carry_motor_torque_and_velocity(design, variant):
    robot = ablate(design, variant)
    _, batch, layout, torque, speed = driven(robot)
    matrix = transmission.joint_from_motor(robot)
    batch.bind("qfrc_actuator"), batch.bind("ten_velocity")
    batch.forward()
    expected = np.einsum("jm,nlm->nlj", matrix, torque.reshape(3, 2, -1)).reshape(3, -1)
    np.testing.assert_allclose(batch.qfrc_actuator[:, 6:], expected, atol=1e-10)
    np.testing.assert_allclose(batch.ten_velocity, speed, atol=1e-9)
    assert torque.shape == (3, len(layout.motors))


def test_torque_on_tendons_equals_torque_at_joints(design):
    """Motors on tendons, and the same joint torques applied outright, move the robot alike."""
    _, batch, _, torque, _ = driven(design)
    matrix = transmission.joint_from_motor(design)
    other = Batch(batch.model, 3, 1)
    other.expand("dof_damping")[:] = batch.expand("dof_damping")
    other.state[:] = batch.state
    other.ctrl = 0.0
    other.qfrc_applied[:, 6:] = np.einsum("jm,nlm->nlj", matrix, torque.reshape(3, 2, -1)).reshape(
        3, -1
    )
    batch.step()
    other.step()
    np.testing.assert_allclose(other.qvel, batch.qvel, atol=1e-10)


def test_the_native_motor_model_agrees(design):
    """The robot's own MuJoCo model, with joint friction left out, moves as the simulated one
    does.
    """
    _, batch, _, torque, _ = driven(design, friction="explicit")
    batch.qfrc_applied = 0.0
    spec = mujoco_spec(design, friction=False)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = batch.qpos[0], batch.qvel[0]
    data.ctrl[:] = np.clip(torque[0], *model.actuator_ctrlrange.T)
    mujoco.mj_step(model, data)
    batch.step()
    np.testing.assert_allclose(batch.qvel[0], data.qvel, atol=1e-9)


def test_native_dc_motors_at_full_voltage_are_the_envelope(design):
    """`<dcmotor>` on the tendons with a force range gives the upper bound of the envelope at the
    tendon's speed.
    """
    envelope = motor_envelope(design)
    spec = mujoco_spec(design, friction=False)
    for index, actuator in enumerate(list(spec.actuators)):
        motor = index % 7
        voltage, peak = 36.0, float(envelope.peak_torque[motor])
        actuator.set_to_dcmotor(
            motorconst=[0, 0],
            resistance=0,
            nominal=[
                voltage,
                float(envelope.stall_torque[motor]),
                float(envelope.no_load_speed[motor]),
            ],
        )
        actuator.ctrlrange = [-voltage, voltage]
        actuator.forcelimited, actuator.forcerange = 1, [-peak, peak]
    model = spec.compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    for sign in (1.0, -1.0):
        for _ in range(5):
            data.qvel[6:] = rng.normal(size=14) * 8
            data.ctrl[:] = sign * 36.0
            mujoco.mj_forward(model, data)
            lower, upper = torque_limits(envelope, data.ten_velocity.reshape(2, 7))
            np.testing.assert_allclose(
                data.actuator_force.reshape(2, 7), upper if sign > 0 else lower, rtol=1e-6
            )


@pytest.mark.parametrize("space", ["joint", "motor"])
def test_implicit_and_explicit_friction_agree_as_the_step_shrinks(design, space):
    gaps = []
    for step in (1e-4, 5e-5):
        ends = []
        for kind in ("implicit", "explicit"):
            _, batch, _, _, _ = driven(
                design,
                friction=kind,
                friction_space=space,
                time_step=step,
                integrator="implicitfast",
            )
            before = batch.qvel.copy()
            batch.step()
            ends.append((batch.qvel - before) / step)
        gaps.append(np.abs(ends[0] - ends[1]).max() / np.abs(ends[1]).max())
    assert gaps[0] < 0.2
    assert gaps[1] < 0.6 * gaps[0]


def test_explicit_friction_is_what_is_printed(design):
    drive, batch, _, _, _ = driven(design, friction="explicit")
    model = actuation_model(design)
    velocity = batch.qvel[:, 6:].reshape(3, 2, 7)
    expected = friction_torque(model.coulomb, model.viscous, velocity, 0.1)
    np.testing.assert_allclose(batch.qfrc_applied[:, 6:], -expected.reshape(3, -1))
    np.testing.assert_allclose(drive.friction(velocity, np.zeros((3, 2, 7))), expected)


def test_implicit_friction_does_not_make_feet_chatter(finely):
    """In the air at 200 Hz the printed explicit friction shakes the toe; the implicit one lets it
    follow smoothly.
    """
    shaking = {}
    for kind in ("implicit", "explicit"):
        environment = finely(0.005, friction=kind)
        environment.recording = True
        environment.reset()
        environment.chunks[0].batch.expand("opt.gravity")[:] = 0
        environment.chunks[0].drive.qpos[:, 2] += 1.0
        speeds = []
        for step in range(25):
            environment.step(np.full((1, 14), 0.3 * np.sin(0.2 * step)))
            speeds.append(environment.signals()["joint_velocity"][0])
        toe = np.concatenate(speeds)[40:, 6]
        shaking[kind] = np.sqrt(np.mean(np.diff(toe) ** 2)) / 0.005
    assert shaking["implicit"] < 100.0  # [rad/s^2]
    assert shaking["explicit"] > 20 * shaking["implicit"]


def test_posture_dependent_tendons_follow_the_linkage(design):
    drive, batch, layout, torque, speed = driven(design, posture_dependent=True)
    matrix = LinkageModel.of(design).joint_from_motor(batch.qpos[:, 7:].reshape(3, 2, 7))
    batch.bind("qfrc_actuator"), batch.bind("ten_velocity")
    batch.forward()
    expected = np.einsum("nljm,nlm->nlj", matrix, torque.reshape(3, 2, 7)).reshape(3, -1)
    np.testing.assert_allclose(batch.qfrc_actuator[:, 6:], expected, atol=1e-9)
    np.testing.assert_allclose(batch.ten_velocity, speed, atol=1e-9)
    power = (torque * speed).sum(-1)
    np.testing.assert_allclose(power, (expected * batch.qvel[:, 6:]).sum(-1), rtol=1e-9)
    assert not np.allclose(matrix[0, 0], transmission.joint_from_motor(design))
    assert drive.count == 3
    assert len(layout.motors) == 14
