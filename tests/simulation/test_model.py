import mujoco
import numpy as np
import pytest

from hyperleg_design.robot.ablation import variants
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import (
    foot_loads,
    pad_forces,
    pad_loads,
    pad_slip,
    simulation_model,
)
from hyperleg_design.simulation.settings import Physics


def sliding(design, **physics):
    model = simulation_model(design, Physics(**physics))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[2] -= 0.003
    data.qvel[:3] = 0.5, 0.2, -0.3
    mujoco.mj_forward(model, data)
    return model, data


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_pad_sensors_are_the_contact_forces(design, cone):
    model, data = sliding(design, cone=cone)
    layout = layout_of(design)
    found = pad_forces(data.sensordata)
    assert data.ncon == len(layout.pads)
    force = np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        mujoco.mj_contactForce(model, data, index, force)
        pad = layout.pads.index(model.geom(contact.geom[1]).name)
        np.testing.assert_allclose(found[pad], contact.frame.reshape(3, 3).T @ force[:3], atol=1e-9)
    assert np.all(found[:, 0] < 0)  # friction against the motion
    np.testing.assert_allclose(pad_loads(data.sensordata), found[:, 2])
    np.testing.assert_allclose(pad_slip(data.sensordata), np.hypot(0.5, 0.2))
    np.testing.assert_allclose(
        foot_loads(found[:, 2]),
        [found[layout.pad_foot == 0, 2].sum(), found[layout.pad_foot == 1, 2].sum()],
    )


def test_pads_off_the_floor_read_zero(design):
    model = simulation_model(design)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[2] += 0.1
    mujoco.mj_forward(model, data)
    assert np.all(data.sensordata == 0)


def test_all_variants_weigh_and_stand_as_designed(design):
    for robot in variants(design).values():
        model, layout = simulation_model(robot), layout_of(robot)
        assert model.body_mass.sum() * 9.81 == pytest.approx(layout.weight)
        assert [model.joint(i + 1).name for i in range(len(layout.joints))] == list(layout.joints)
        assert [model.tendon(i).name for i in range(model.ntendon)] == list(layout.motors)
        assert list(layout.pad_foot) == sorted(layout.pad_foot)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        for pad, place in zip(layout.pads, layout.pad_position, strict=True):
            foot = data.body(f"{pad.split('_')[0]}_foot").xpos
            np.testing.assert_allclose(data.geom(pad).xpos - foot, place, atol=1e-9)
