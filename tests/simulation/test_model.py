import dataclasses

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.description import urdf
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.load import load_robot, robot_from_mapping
from hyperleg_design.robot.transmission import joint_from_motor, reflected_inertia
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import (
    PAD_SENSOR_SIZE,
    foot_loads,
    pad_forces,
    pad_loads,
    pad_slip,
    simulated_robots,
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
        foot_loads(found[:, 2], layout.pads_of_foot),
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


def test_loads_of_feet_with_different_numbers_of_pads():
    loads = np.arange(12.0).reshape(2, 6)
    found = foot_loads(loads, (1, 3, 2))
    np.testing.assert_array_equal(found, [[0, 6, 9], [6, 24, 21]])


@pytest.mark.parametrize("name", ["mini_cheetah", "parallel_ankle"])
def test_robots_written_out_have_the_dynamics_of_an_independent_library(name):
    """Mass matrix and gravity of MuJoCo's model against Pinocchio's, rotors added by hand."""
    import pinocchio

    robot = load_robot(name)
    model, layout = simulation_model(robot), layout_of(robot)
    assert [model.joint(i + 1).name for i in range(len(layout.joints))] == list(layout.joints)
    assert [model.tendon(i).name for i in range(model.ntendon)] == list(layout.motors)
    other = pinocchio.buildModelFromXML(
        urdf(robot, build_tree(robot)), pinocchio.JointModelFreeFlyer()
    )
    order = [other.getJointId(joint) - 2 for joint in layout.joints]
    rng = np.random.default_rng(0)
    angles = rng.uniform(0.7 * layout.lower, 0.7 * layout.upper)
    data = mujoco.MjData(model)
    data.qpos[:3], data.qpos[3:7], data.qpos[7:] = (0, 0, 1), (1, 0, 0, 0), angles
    mujoco.mj_forward(model, data)
    found = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, found)
    q = pinocchio.neutral(other)
    q[7:][order] = angles
    q[2] = 1.0
    there = other.createData()
    own = np.array([*range(6), *(6 + np.array(order))])
    rigid = pinocchio.crba(other, there, q)
    rigid = np.triu(rigid) + np.triu(rigid, 1).T
    matrix, inertia = joint_from_motor(robot), rotor_inertia(robot)
    reflected = np.kron(np.eye(len(layout.limbs)), reflected_inertia(matrix, inertia))
    expected = rigid[np.ix_(own, own)]
    expected[6:, 6:] += reflected
    np.testing.assert_allclose(found, expected, atol=1e-9)
    gravity = pinocchio.computeGeneralizedGravity(other, there, q)
    np.testing.assert_allclose(data.qfrc_bias, gravity[own], atol=1e-8)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ("joints.knee.stiffness=0", r"joints\.knee\.stiffness"),
        ("trunk.motion=fixed", r"trunk\.motion.*expects floating"),
        ("pads", "has no pads"),
    ],
)
def test_a_robot_that_cannot_be_simulated_is_refused(change, field):
    if change == "pads":
        data = load_robot("mini_cheetah").to_mapping()
        robot = robot_from_mapping({k: v for k, v in data.items() if k != "pads"}, "cheetah")
    else:
        robot = load_robot("mini_cheetah", overrides=[change])
    with pytest.raises(InputError, match=field):
        simulation_model(robot)


def test_a_batch_says_which_robots_cannot_be_simulated_and_why():
    robot = load_robot("mini_cheetah")
    slack = robot.with_values({"joints.knee.stiffness": 0.0})
    with pytest.raises(InputError, match=r"joints\.knee\.stiffness.*must be positive") as caught:
        simulated_robots([robot, slack, robot])
    np.testing.assert_array_equal(caught.value.bad, [False, True, False])


def test_equal_designs_share_a_model_and_a_layout_that_are_those_of_a_design_alone(design):
    lighter = design.with_values({"toe.mass": 0.123})
    first, second, third = simulated_robots([design, lighter, design])
    assert first[0] is third[0]
    assert first[1] is third[1]
    for one, (model, layout) in ((design, first), (lighter, second)):
        again = simulated_robots([one])[0]
        assert again[0] is model
        assert again[1] is layout
        np.testing.assert_array_equal(model.body_mass, simulation_model(one).body_mass)
        for name, value in dataclasses.asdict(layout_of(one)).items():
            np.testing.assert_array_equal(getattr(layout, name), value, err_msg=name)
    assert first[1].weight != second[1].weight
