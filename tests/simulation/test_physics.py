"""Whether the simulated physics is right: dynamics against Pinocchio, energy, weight,
convergence.
"""

import mujoco
import numpy as np
import pytest

from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.models import quaternion_matrix, rigid_body_model
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.simulation.model import PAD_SENSOR_SIZE, pad_forces

REACH = np.tile([0.0, 0.1, 0.4, -0.3, 0.5, 0.1, 0.3], 2)


def test_pinocchio_inverse_dynamics_reproduce_the_accelerations_with_contacts(design, make):
    for variant in VARIANTS[:3]:
        robot = ablate(design, variant)
        environment = make(robot=robot, simulations=2, seed=5)
        environment.reset()
        rng = np.random.default_rng(0)
        touching = 0
        for _ in range(7):
            environment.step(rng.normal(size=(2, environment.action_size)) * 0.7)
            for simulation in range(2):
                touching += _check_dynamics(robot, environment, simulation)
        assert touching > 25  # contacts, over all states


def _check_dynamics(robot, environment, simulation):
    chunk = environment.chunks[0]
    model, data = chunk.batch.get_model(simulation), chunk.batch.get_data(simulation)
    mujoco.mj_forward(model, data)
    pin = rigid_body_model(robot)
    rotation = data.body("pelvis").xmat.reshape(3, 3)
    q, v, a = data.qpos.copy(), data.qvel.copy(), data.qacc.copy()
    q[3:7] = data.qpos[[4, 5, 6, 3]]
    np.testing.assert_allclose(quaternion_matrix(q[3:7]), rotation, atol=1e-12)
    v[:3] = rotation.T @ v[:3]
    a[:3] = rotation.T @ a[:3] - np.cross(v[3:6], v[:3])
    # `J^T f` of the pads, from the sensors and where MuJoCo says that they touch
    force = np.zeros(len(v))
    loads = pad_forces(data.sensordata[: PAD_SENSOR_SIZE * len(environment.layout.pads)])
    for index in range(data.ncon):
        pad = model.geom(data.contact[index].geom[1]).name
        link = pad.rsplit("_pad_", 1)[0]
        jacobian = pin.frame_jacobian(q, link)
        arm = data.contact[index].pos - pin.frame_position(q, link)
        pad_force = loads[environment.layout.pads.index(pad)]
        force += jacobian.T @ np.concatenate([pad_force, np.cross(arm, pad_force)])
    force[6:] += data.qfrc_actuator[6:] - model.dof_damping[6:] * data.qvel[6:]
    limits = np.zeros(len(v))
    for row in range(data.nefc):  # joints at their stops push as well
        if data.efc_type[row] == mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT:
            limits[model.jnt_dofadr[data.efc_id[row]]] += (
                _limit_sign(model, data, row) * data.efc_force[row]
            )
    np.testing.assert_allclose(
        pin.inverse_dynamics(q, v, a), force + limits, atol=2e-6 * (1 + np.abs(force).max())
    )
    return data.ncon


def _limit_sign(model, data, row):
    joint = data.efc_id[row]
    low, high = model.jnt_range[joint]
    value = data.qpos[model.jnt_qposadr[joint]]
    return 1.0 if abs(value - low) < abs(value - high) else -1.0


def energy_residual(environment, duration=0.3, drop=0.03):
    """Change of energy less what went in, over a drop onto the floor with all joints moving [J];
    work that went in [J].
    """
    environment.recording = True
    environment.reset()
    chunk = environment.chunks[0]
    chunk.drive.qpos[:, 2] += drop
    model, data = environment.model, mujoco.MjData(environment.model)
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    joints, energy, power, driven = len(environment.layout.joints), [], [], []
    for _ in range(round(duration / environment.task.physics.policy_step)):
        environment.step(REACH[None])
        signals = environment.signals()
        for state in chunk.record.states[:, 0]:
            data.qpos[:], data.qvel[:] = state[: 7 + joints], state[7 + joints :]
            mujoco.mj_forward(model, data)
            energy.append(data.energy.sum())
        contact = chunk.sensors[:, 0].reshape(-1, len(environment.layout.pads), PAD_SENSOR_SIZE)
        motors = (signals["motor_torque"][0] * signals["motor_velocity"][0]).sum(-1)
        friction = (signals["joint_friction"][0] * signals["joint_velocity"][0]).sum(-1)
        power += list(motors - friction + (contact[..., :3] * contact[..., 3:]).sum((1, 2)))
        driven += list(np.abs(motors) + friction)
    step = environment.task.physics.time_step
    power, energy = np.array(power), np.array(energy)
    put_in = np.sum((power[1:] + power[:-1]) / 2) * step
    return energy[-1] - energy[0] - put_in, np.sum(driven) * step


@pytest.mark.parametrize(
    "physics",
    [{}, {"friction": "explicit"}, {"friction_space": "motor", "integrator": "implicitfast"}],
)
def test_energy_closes_to_the_order_of_the_integrator(finely, physics):
    """Work in equals kinetic (rotors too) plus potential energy plus losses; halving the step
    halves the rest.
    """
    (coarse, work), (fine, _) = (
        energy_residual(finely(step, **physics)) for step in (5e-4, 2.5e-4)
    )
    assert abs(fine) < 0.05 * work
    assert abs(fine) == pytest.approx(abs(coarse) / 2, rel=0.2)


def stiff(design):
    """Joints that hold the robot up without balance."""
    gains = {
        "hip_pitch": 800.0,
        "hip_roll": 300.0,
        "knee": 800.0,
        "ankle_pitch": 800.0,
        "ankle_roll": 400.0,
        "toe": 100.0,
    }
    return design.with_values(
        {f"joints.{joint}.stiffness": value for joint, value in gains.items()}
    )


def test_standing_feet_carry_the_weight(design, finely):
    environment = finely(0.005, robot=stiff(design))
    environment.recording = True
    environment.reset()
    for _ in range(200):
        environment.step(np.zeros((1, 14)))
    signals = environment.signals()
    assert np.abs(signals["base_velocity"]).max() < 1e-3
    carried = signals["pad_force"][0].sum(1)
    np.testing.assert_allclose(carried[:, 2], environment.layout.weight, rtol=1e-3)
    np.testing.assert_allclose(carried[:, :2], 0.0, atol=1e-3 * environment.layout.weight)
    mass = environment.layout.weight / 9.81
    assert environment.model.body_mass.sum() == pytest.approx(mass)


def test_momentum_changes_by_gravity_and_contact_forces_alone(finely, design):
    """Over a landing, mass times the change of the centre of mass's velocity is the impulse of
    weight and pads.
    """
    environment = finely(0.0005)
    environment.recording = True
    environment.reset()
    chunk = environment.chunks[0]
    chunk.drive.qpos[:, 2] += 0.03
    momentum, impulse = [], np.zeros(3)
    for _ in range(10):
        momentum.append(_momentum(environment.model, chunk.drive.qpos[0], chunk.drive.qvel[0]))
        environment.step(REACH[None])
        force = environment.signals()["pad_force"][0].sum(1) - np.array(
            [0, 0, environment.layout.weight]
        )
        impulse += force.sum(0) * environment.task.physics.time_step
    change = _momentum(environment.model, chunk.drive.qpos[0], chunk.drive.qvel[0]) - momentum[0]
    assert np.linalg.norm(impulse) > 3
    np.testing.assert_allclose(change, impulse, atol=0.01 * np.linalg.norm(impulse) + 0.05)


def _momentum(model, qpos, qvel):
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    return data.subtree_linvel[1] * model.body_subtreemass[1]


def settled_drop(environment, duration=0.16):
    """Pelvis height [m] and peak ground force [N] after a short drop onto the floor."""
    environment.recording = True
    environment.reset()
    environment.chunks[0].drive.qpos[:, 2] += 0.01
    peak = 0.0
    for _ in range(round(duration / 0.02)):
        environment.step(REACH[None] * 0.3)
        peak = max(peak, environment.signals()["pad_force"][0, ..., 2].sum(-1).max())
    return np.concatenate(
        [environment.chunks[0].drive.qpos[0, [0, 2]], environment.chunks[0].drive.qpos[0, 7:]]
    ), peak


@pytest.mark.slow
def test_the_time_step_converges(finely):
    """Positions tend to a limit at first order, and 200 Hz is near it."""
    limit, peak = settled_drop(finely(0.0001))
    errors = [
        np.abs(settled_drop(finely(step))[0] - limit).max()
        for step in (0.005, 0.0025, 0.001, 0.0005)
    ]
    assert errors[0] < 0.05  # [m, rad] after 0.16 s with a landing
    assert errors[3] < 0.35 * errors[1]
    assert settled_drop(finely(0.0005))[1] == pytest.approx(peak, rel=0.05)


@pytest.mark.slow
def test_the_solver_has_converged(finely):
    usual, peak = settled_drop(finely(0.005))
    tight, tight_peak = settled_drop(finely(0.005, iterations=1000, tolerance=1e-14))
    np.testing.assert_allclose(usual, tight, atol=1e-5)
    assert peak == pytest.approx(tight_peak, rel=1e-4)


@pytest.mark.slow
def test_cone_torsion_and_integrator_change_little(finely):
    usual, peak = settled_drop(finely(0.005))
    for physics in (
        {"cone": "elliptic"},
        {"contact_dimensions": 4},
        {"integrator": "implicitfast"},
    ):
        other, other_peak = settled_drop(finely(0.005, **physics))
        np.testing.assert_allclose(other, usual, atol=0.01)
        assert other_peak == pytest.approx(peak, rel=0.03)
