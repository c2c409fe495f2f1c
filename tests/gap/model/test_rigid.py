import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.model import rigid
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.mechanism import quaternion_rotation
from hyperleg_design.gap.signals.loading import load_subject

TICKS = 6


def random_motion(subject, seed=0):
    """Any states, and the motion of the base if that floats."""
    rng = np.random.default_rng(seed)
    q, v, a = rng.normal(size=(3, TICKS, len(subject.joints)))
    if not subject.floating:
        return q, v, a, None
    place, linear, spin, force, angular = rng.normal(size=(5, TICKS, 3))
    return (
        q,
        v,
        a,
        BaseMotion(
            place,
            quaternion_rotation(rng.normal(size=(TICKS, 4))),
            linear,
            spin,
            5 * force,
            angular,
        ),
    )


@pytest.fixture(
    scope="module", params=["hyperleg", "toe_locked", "toe_removed", "arm", "coupled", "pendulum"]
)
def subject(request, robot_files):
    return load_subject(robot_files.get(request.param, request.param))


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
    data, other = mujoco.MjData(model), subject.pinocchio.createData()
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
        found = np.array(pin.rnea(subject.pinocchio, other, own_q, own_v, own_a))
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


def test_regressors_of_all_links_give_the_torque(subject):
    q, v, a, base = random_motion(subject, 1)
    torque, wrench = np.zeros(q.shape), np.zeros((TICKS, 6))
    for link, parameters in zip(subject.links, subject.tree.link_inertial, strict=True):
        rows, of_base = rigid.regressors(subject, q, v, a, base, link)
        torque += rows @ parameters
        wrench += of_base @ parameters
    np.testing.assert_allclose(
        torque, rigid.inverse_dynamics(subject, q, v, a, base, rotors=False), atol=1e-9
    )
    if base is not None:
        np.testing.assert_allclose(wrench, rigid.base_wrench(subject, q, v, a, base), atol=1e-9)


def test_contact_forces_act_as_in_mujoco():
    subject = load_subject("hyperleg")
    q, _, _, base = random_motion(subject, 2)
    force = np.random.default_rng(5).normal(size=(TICKS, len(subject.pads), 3))
    torque, wrench = rigid.contact_torque(subject, q, base.rotation, force)
    model, data = subject.model, mujoco.MjData(subject.model)
    for i in range(TICKS):
        mujoco.mju_mat2Quat(data.qpos[3:7], base.rotation[i].ravel())
        data.qpos[:3], data.qpos[7:] = base.position[i], q[i]
        mujoco.mj_fwdPosition(model, data)
        expected = np.zeros(model.nv)
        for k, pad in enumerate(subject.pads):
            body = data.body(subject.links[pad.link])
            point = (
                body.xpos + body.xmat.reshape(3, 3) @ np.array(pad.position) - [0, 0, pad.radius]
            )
            jacobian = np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, point, body.id)
            expected += jacobian.T @ force[i, k]
        np.testing.assert_allclose(torque[i], expected[6:], atol=1e-9)
        np.testing.assert_allclose(
            wrench[i], np.r_[base.rotation[i].T @ expected[:3], expected[3:6]], atol=1e-9
        )


def test_a_pad_that_rolls_does_not_slide():
    """The base turns to and fro over its feet: pads are spheres, whose lowest points lag their
    centres by radius times rate.
    """
    from hyperleg_design.gap.playback import show

    biped = show._subject(None, True)
    time = np.arange(401) * 0.005
    angle = 0.2 * np.sin(4 * time)
    rotation = np.zeros((401, 3, 3))
    rotation[:, 0, 0] = rotation[:, 2, 2] = np.cos(angle)
    rotation[:, 0, 2], rotation[:, 2, 0], rotation[:, 1, 1] = np.sin(angle), -np.sin(angle), 1.0
    found = rigid.pad_rolling(biped, np.tile(biped.default, (401, 1)), rotation, 0.005)
    radius = np.array([p.radius for p in biped.pads])
    np.testing.assert_allclose(
        found[1:-1, :, 0], -np.gradient(angle, 0.005)[1:-1, None] * radius, atol=1e-4
    )
    assert np.abs(found[1:-1, :, 1:]).max() < 1e-4


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
