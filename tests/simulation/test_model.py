import mujoco
import numpy as np
import pytest

from hyperleg_design.robot.ablation import variants
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import (
    PAD_SENSOR_SIZE,
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
    sensors = data.sensordata[: PAD_SENSOR_SIZE * len(layout.pads)]
    found = pad_forces(sensors)
    assert data.ncon == len(layout.pads)
    force = np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        mujoco.mj_contactForce(model, data, index, force)
        pad = layout.pads.index(model.geom(contact.geom[1]).name)
        np.testing.assert_allclose(found[pad], contact.frame.reshape(3, 3).T @ force[:3], atol=1e-9)
    assert np.all(found[:, 0] < 0)  # friction against the motion
    np.testing.assert_allclose(pad_loads(sensors), found[:, 2])
    np.testing.assert_allclose(pad_slip(sensors), np.hypot(0.5, 0.2))
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


def test_stop_sensors_are_the_stops_torques(design):
    """A knee 3 deg past its lower end and a toe 2 deg past its upper; pelvis in the air."""
    model = simulation_model(design)
    data = mujoco.MjData(model)
    layout = layout_of(design)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[2] += 0.3
    knee, toe = layout.joints.index("left_knee"), layout.joints.index("right_toe")
    data.qpos[7 + knee] = layout.lower[knee] - np.deg2rad(3)
    data.qpos[7 + toe] = layout.upper[toe] + np.deg2rad(2)
    mujoco.mj_forward(model, data)
    stops = data.sensordata[PAD_SENSOR_SIZE * len(layout.pads) :]
    assert stops.shape == (len(layout.joints),)
    assert set(np.flatnonzero(stops)) == {knee, toe}
    torque = np.where(data.qpos[7:] < (layout.lower + layout.upper) / 2, stops, -stops)
    np.testing.assert_allclose(torque, data.qfrc_constraint[6:], rtol=1e-9, atol=1e-9)
