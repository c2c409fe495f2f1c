import mujoco
import numpy as np
from random_motion import TICKS, random_motion

from hyperleg_design.gap.model import pads
from hyperleg_design.gap.signals.loading import load_subject


def test_contact_forces_act_as_in_mujoco():
    subject = load_subject("hyperleg")
    q, _, _, base = random_motion(subject, 2)
    force = np.random.default_rng(5).normal(size=(TICKS, len(subject.pads), 3))
    torque, wrench = pads.contact_torque(subject, q, base.rotation, force)
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
    found = pads.pad_rolling(biped, np.tile(biped.default, (401, 1)), rotation, 0.005)
    radius = np.array([p.radius for p in biped.pads])
    np.testing.assert_allclose(
        found[1:-1, :, 0], -np.gradient(angle, 0.005)[1:-1, None] * radius, atol=1e-4
    )
    assert np.abs(found[1:-1, :, 1:]).max() < 1e-4
