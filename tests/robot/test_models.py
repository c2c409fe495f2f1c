"""Pinocchio and MuJoCo are two programs by two teams; on our robots they agree."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.mass.mass_rows import mass_rows
from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.mjcf import mjcf, mujoco_model
from hyperleg_design.robot.models import leg_reflected_inertia, quaternion_matrix, rigid_body_model
from hyperleg_design.robot.motors import motor_arrays

FREE = mujoco.mjtDisableBit
IDEAL = (
    FREE.mjDSBL_CONTACT
    | FREE.mjDSBL_LIMIT
    | FREE.mjDSBL_FRICTIONLOSS
    | FREE.mjDSBL_SPRING
    | FREE.mjDSBL_DAMPER
)
"""Rigid bodies and rotors only: what RNEA and CRBA describe."""
TOLERANCE = {"rtol": 1e-9, "atol": 1e-8}

seeds = st.integers(0, 2**32 - 1)


def random_state(model: pin.Model, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Base anywhere in any orientation, joints inside their ranges, any velocity and
    acceleration.
    """
    dice = np.random.default_rng(seed)
    q = dice.uniform(
        np.maximum(model.lowerPositionLimit, -1), np.minimum(model.upperPositionLimit, 1)
    )
    q[:3] = dice.normal(size=3)
    q[3:7] = dice.normal(size=4)
    q[3:7] /= np.linalg.norm(q[3:7])
    q[7:] = dice.uniform(model.lowerPositionLimit[7:], model.upperPositionLimit[7:])
    return q, dice.normal(size=model.nv), 5 * dice.normal(size=model.nv)


def compare(model: pin.Model, reflected: np.ndarray, other: mujoco.MjModel, seed: int) -> None:
    """Everything that both programs can compute, in one random state.

    MuJoCo's base moves with linear velocity in the world and angular velocity in the base;
    Pinocchio's with both in the base. `turn` maps the one to the other, so inertia, forces and
    Jacobians follow by the chain rule.
    """
    other.opt.disableflags = int(IDEAL)
    q, v, a = random_state(model, seed)
    rotation = quaternion_matrix(q[3:7])
    turn = np.eye(model.nv)
    turn[:3, :3] = rotation.T
    data, state = model.createData(), mujoco.MjData(other)
    state.qpos[:] = q
    state.qpos[3:7] = q[[6, 3, 4, 5]]
    state.qvel[:] = np.linalg.solve(turn, v)
    state.qacc[:] = a
    state.qacc[:3] = rotation @ (
        a[:3] + np.cross(v[3:6], v[:3])
    )  # Pinocchio's is the spatial acceleration
    acceleration = state.qacc.copy()
    mujoco.mj_forward(other, state)
    state.qacc[:] = acceleration

    assert pin.computeTotalMass(model) == pytest.approx(other.body_mass.sum(), abs=1e-10)
    np.testing.assert_allclose(pin.centerOfMass(model, data, q), state.subtree_com[1], **TOLERANCE)

    inertia = pin.crba(model, data, q)
    inertia = np.triu(inertia) + np.triu(inertia, 1).T + reflected
    theirs = np.zeros((other.nv, other.nv))
    mujoco.mj_fullM(other, state, theirs)
    np.testing.assert_allclose(turn.T @ inertia @ turn, theirs, **TOLERANCE)

    forces = pin.rnea(model, data, q, v, a) + reflected @ a
    mujoco.mj_inverse(other, state)
    np.testing.assert_allclose(turn.T @ forces, state.qfrc_inverse, **TOLERANCE)

    for index in range(2, other.nbody):
        name = other.body(index).name
        ours = (
            pin.computeFrameJacobian(
                model, data, q, model.getFrameId(name), pin.LOCAL_WORLD_ALIGNED
            )
            @ turn
        )
        linear, angular = np.zeros((3, other.nv)), np.zeros((3, other.nv))
        mujoco.mj_jac(other, state, linear, angular, state.xpos[index], index)
        np.testing.assert_allclose(ours, np.vstack([linear, angular]), **TOLERANCE, err_msg=name)


@given(st.data(), seeds)
@settings(max_examples=12)
def test_models_in_memory_agree(random_designs, data, seed):
    design = data.draw(random_designs)
    body = rigid_body_model(design)
    assert pin.computeTotalMass(body.model) == pytest.approx(
        float(mass_table(design).total), abs=1e-10
    )
    other = mujoco_model(design)
    for state in range(3):
        compare(body.model, body.reflected, other, seed + state)


@given(st.data(), seeds)
@settings(max_examples=8)
def test_written_files_agree_without_this_package(random_designs, tmp_path_factory, data, seed):
    """Only the two files are used: Pinocchio reads the URDF, MuJoCo the MJCF, rotors come from the
    latter's tendons.
    """
    design = data.draw(random_designs)
    folder = tmp_path_factory.getbasetemp()
    (folder / "robot.urdf").write_text(urdf(design))
    (folder / "robot.xml").write_text(mjcf(design))
    model = pin.buildModelFromUrdf(str(folder / "robot.urdf"), pin.JointModelFreeFlyer())
    other = mujoco.MjModel.from_xml_path(str(folder / "robot.xml"))
    reflected = np.zeros((other.nv, other.nv))
    for tendon in range(other.ntendon):
        column = np.zeros(other.nv)
        first = other.tendon_adr[tendon]
        for wrap in range(first, first + other.tendon_num[tendon]):
            column[other.jnt_dofadr[other.wrap_objid[wrap]]] = other.wrap_prm[wrap]
        reflected += other.tendon_armature[tendon] * np.outer(column, column)
    compare(model, reflected, other, seed)


@pytest.fixture(scope="module")
def body(hyperleg):
    return rigid_body_model(hyperleg)


@given(seed=seeds)
@settings(max_examples=20)
def test_methods_are_pinocchios_with_rotors(body, seed):
    q, v, a = random_state(body.model, seed)
    data = body.model.createData()
    rigid = pin.rnea(body.model, data, q, v, a)
    np.testing.assert_allclose(
        body.inverse_dynamics(q, v, a) - rigid, body.reflected @ a, atol=1e-10
    )
    bias = body.inverse_dynamics(q, v, 0 * a)
    np.testing.assert_allclose(
        body.inverse_dynamics(q, v, a) - bias, body.mass_matrix(q) @ a, atol=1e-9
    )
    assert np.linalg.eigvalsh(body.mass_matrix(q))[0] > 0
    step = 1e-6
    moved = pin.integrate(body.model, q, v * step)
    for link in ("left_foot", "right_toe_plate"):
        velocity = (body.frame_position(moved, link) - body.frame_position(q, link)) / step
        np.testing.assert_allclose(body.frame_jacobian(q, link)[:3] @ v, velocity, atol=2e-5)
    np.testing.assert_allclose(
        quaternion_matrix(q[3:7]), pin.Quaternion(q[3:7]).matrix(), atol=1e-14
    )


@given(seed=seeds)
@settings(max_examples=10)
def test_states_read_the_same_in_mujoco(hyperleg, body, seed):
    model = mujoco_model(hyperleg)
    q, v, a = random_state(body.model, seed)
    data = mujoco.MjData(model)
    state = body.to_mujoco(q, v, a)
    data.qpos[:], data.qvel[:] = state[:2]
    mujoco.mj_forward(model, data)
    for link in ("pelvis", "left_foot", "right_toe_plate"):
        np.testing.assert_allclose(data.body(link).xpos, body.frame_position(q, link), atol=1e-12)
        velocity = np.zeros(6)
        mujoco.mj_objectVelocity(
            model, data, mujoco.mjtObj.mjOBJ_XBODY, model.body(link).id, velocity, 0
        )
        np.testing.assert_allclose(
            np.roll(velocity, 3), body.frame_jacobian(q, link) @ v, atol=1e-10
        )
    assert [len(s) for s in state] == [21, 20, 20]
    assert len(body.to_mujoco(q)) == 1


def test_standing_straight(hyperleg, body):
    q = body.neutral()
    robot = next(row for row in mass_rows(hyperleg) if row.kind == "robot")
    np.testing.assert_allclose(
        body.center_of_mass(q), robot.com + np.array([0, 0, 0.786]), atol=1e-12
    )
    pin.ccrba(body.model, data := body.model.createData(), q, np.zeros(20))
    np.testing.assert_allclose(np.linalg.eigvalsh(data.Ig.inertia), robot.principal, rtol=1e-12)
    assert body.frame_position(q, "left_ankle_cross")[2] == pytest.approx(0.071, abs=1e-12)
    np.testing.assert_allclose(
        body.inverse_dynamics(q, np.zeros(20), np.zeros(20))[2], 32.0 * 9.81, rtol=1e-12
    )


def test_a_fixed_base_has_the_joints_only(hyperleg, body):
    fixed = rigid_body_model(hyperleg, floating=False)
    assert (fixed.model.nv, fixed.base_dof, body.base_dof) == (14, 0, 6)
    q = np.linspace(-0.2, 0.2, 14)
    full = body.neutral()
    full[7:] = q
    np.testing.assert_allclose(fixed.mass_matrix(q), body.mass_matrix(full)[6:, 6:], atol=1e-12)
    np.testing.assert_allclose(fixed.to_mujoco(q)[0], q)


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed_matched", "toe_removed"])
def test_reflected_inertia_of_the_variants(hyperleg, variant):
    design = variants(hyperleg)[variant]
    matrix = transmission.joint_from_motor(design)
    rotor = motor_arrays(design).rotor_inertia[: matrix.shape[1]]
    np.testing.assert_allclose(
        leg_reflected_inertia(design), matrix @ np.diag(rotor) @ matrix.T, rtol=1e-12, atol=1e-18
    )
    batch = hyperleg.with_values({"transmission.scale.toe": np.array([1.0, 0.5])})
    np.testing.assert_array_equal(
        leg_reflected_inertia(batch)[1], leg_reflected_inertia(batch.take(1))
    )


def test_a_batch_has_no_model(hyperleg):
    with pytest.raises(InputError, match="batch"):
        rigid_body_model(hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])}))
