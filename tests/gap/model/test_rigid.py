import mujoco
import numpy as np
from pinocchio_tree import pinocchio_model
from random_motion import TICKS, random_motion

from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.signals.loading import load_subject


def test_inverse_dynamics_is_mujocos_and_pinocchios(subject):
    import copy

    import pinocchio as pin

    q, v, a, base = random_motion(subject)
    torque = rigid.inverse_dynamics(subject, q, v, a, base)
    wrench = None if base is None else rigid.base_wrench(subject, q, v, a, base)
    model = copy.copy(subject.model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT) | int(
        mujoco.mjtDisableBit.mjDSBL_SPRING
    )
    tree = pinocchio_model(subject.tree, subject.gravity)
    data, other = mujoco.MjData(model), tree.createData()
    n = len(subject.joints)
    for i in range(TICKS):
        own_q, own_v, own_a = q[i] - subject.tree.reference, v[i], a[i]
        if base is not None:
            rotation, gravity = base.rotation[i], subject.gravity
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, rotation.ravel())
            data.qpos[:7] = np.r_[base.position[i], quaternion]
            data.qvel[:6] = np.r_[rotation @ base.linear_velocity[i], base.angular_velocity[i]]
            data.qacc[:6] = np.r_[
                rotation @ base.specific_force[i] + gravity, base.angular_acceleration[i]
            ]
            own_q = np.r_[base.position[i], quaternion[[1, 2, 3, 0]], own_q]
            own_v = np.r_[base.linear_velocity[i], base.angular_velocity[i], own_v]
            linear = (
                base.specific_force[i]
                + rotation.T @ gravity
                - np.cross(base.angular_velocity[i], base.linear_velocity[i])
            )
            own_a = np.r_[linear, base.angular_acceleration[i], own_a]
        data.qpos[-n:], data.qvel[-n:], data.qacc[-n:] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        found = np.array(pin.rnea(tree, other, own_q, own_v, own_a))
        np.testing.assert_allclose(torque[i], data.qfrc_inverse[-n:], atol=1e-9)
        np.testing.assert_allclose(torque[i], found[-n:] + subject.armature @ a[i], atol=1e-9)
        if base is not None:
            np.testing.assert_allclose(
                wrench[i],
                np.r_[rotation.T @ data.qfrc_inverse[:3], data.qfrc_inverse[3:6]],
                atol=1e-9,
            )
            np.testing.assert_allclose(wrench[i], found[:6], atol=1e-9)


def test_leading_dimensions_pass_through(subject):
    q, v, a, base = random_motion(subject)
    many = rigid.inverse_dynamics(subject, np.stack([q, q + 0.1]), v, a, base)
    assert many.shape == (2, *q.shape)
    np.testing.assert_allclose(many[0], rigid.inverse_dynamics(subject, q, v, a, base), atol=1e-12)
    np.testing.assert_allclose(
        many[1], rigid.inverse_dynamics(subject, q + 0.1, v, a, base), atol=1e-12
    )


def test_unit_accelerations_take_the_columns_of_the_inertia_matrix():
    subject = load_subject("hyperleg")
    position = np.random.default_rng(8).uniform(-0.4, 0.4, (3, len(subject.joints)))
    columns = np.stack(
        rigid.accelerating(subject, position, np.eye(len(subject.joints)), rotors=False), -1
    )
    np.testing.assert_allclose(columns, columns.transpose(0, 2, 1), atol=1e-10)
    assert np.linalg.eigvalsh(columns).min() > 0
    twice = rigid.accelerating(subject, position, [np.full(position.shape, 2.0)], rotors=False)[0]
    np.testing.assert_allclose(twice, 2 * columns.sum(-1), atol=1e-9)
