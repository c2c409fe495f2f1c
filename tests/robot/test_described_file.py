"""Robots of other files against Pinocchio and MuJoCo, which read them too."""

from __future__ import annotations

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from hyperleg_design.errors import InputError
from hyperleg_design.robot.described_file import fit_name, read_robot

URDF = """<robot name="two links">
<link name="base"><inertial><mass value="3"/><inertia ixx="0.03" iyy="0.04" izz="0.05"/></inertial></link>
<link name="upper-arm"><inertial><origin xyz="0.01 -0.02 0.1" rpy="0.3 -0.5 0.9"/><mass value="1.5"/>
<inertia ixx="0.02" iyy="0.021" izz="0.006" ixy="0.001" ixz="-0.002" iyz="0.0005"/></inertial></link>
<link name="hand"><inertial><origin xyz="0 0 0.05"/><mass value="0.4"/>
<inertia ixx="0.001" iyy="0.001" izz="0.0004"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper-arm"/>
<origin xyz="0.1 0 0.4" rpy="0.2 -0.1 0.7"/><axis xyz="0 2 0"/>
<limit lower="-1" upper="2" effort="30" velocity="8"/><dynamics friction="0.3" damping="0.05"/></joint>
<joint name="wrist" type="continuous"><parent link="upper-arm"/><child link="hand"/>
<origin xyz="0 0.02 0.3"/><axis xyz="0.6 0 0.8"/><limit effort="5" velocity="12"/></joint>
</robot>"""  # noqa: E501
MJCF = """<mujoco><worldbody><body name="base" pos="0 0 1" quat="0.9 0.1 0.3 0.2"><freejoint/>
<geom size="0.1" mass="3"/><body name="arm" pos="0.1 0 0.4" euler="20 -35 50">
<joint name="shoulder" axis="0 1 0" pos="0.02 0 0.01" range="-60 90" damping="0.2" armature="0.01"/>
<inertial pos="0.01 -0.02 0.1" mass="1.5" fullinertia="0.02 0.021 0.006 0.001 -0.002 0.0005"/>
<body name="hand" pos="0 0.02 0.3" euler="0 60 10"><joint name="wrist" axis="0.6 0 0.8"/>
<geom size="0.04" mass="0.4" pos="0 0 0.05"/></body></body></body></worldbody></mujoco>"""


def placed(robot, link, angles):
    """Rotation and place of a link's frame in the root's."""
    above = next(((n, j) for n, j in robot.joints.items() if j.child == link), None)
    if above is None:
        return np.eye(3), np.zeros(3)
    name, joint = above
    rotation, place = placed(robot, joint.parent, angles)
    fixed = Rotation.from_euler("xyz", joint.turn).as_matrix()
    turned = Rotation.from_rotvec(joint.axis * angles.get(name, 0.0)).as_matrix()
    return rotation @ fixed @ turned, place + rotation @ joint.position


def centre(robot, angles):
    """Of all mass, in the root's frame."""
    total, found = 0.0, np.zeros(3)
    for name, link in robot.links.items():
        rotation, place = placed(robot, name, angles)
        total, found = total + link.mass, found + link.mass * (place + rotation @ link.com)
    return found / total


ANGLES = {"shoulder": 0.7, "wrist": -1.1}


def test_a_urdf_is_read_as_pinocchio_reads_it(write):
    path = write("arm.urdf", URDF)
    robot, model = read_robot(path), pin.buildModelFromXML(URDF, pin.JointModelFreeFlyer())
    assert robot.floating
    assert (robot.root, set(robot.links)) == ("base", {"base", "upper_arm", "hand"})
    arm, own = model.inertias[model.getJointId("shoulder")], robot.links["upper_arm"]
    assert own.mass == arm.mass
    np.testing.assert_allclose(own.com, arm.lever, atol=1e-12)
    np.testing.assert_allclose(own.inertia, arm.inertia, atol=1e-12)
    data = model.createData()
    q = pin.neutral(model)
    q[model.joints[model.getJointId("shoulder")].idx_q] = ANGLES["shoulder"]
    start = model.joints[model.getJointId("wrist")].idx_q
    q[start : start + 2] = np.cos(ANGLES["wrist"]), np.sin(ANGLES["wrist"])
    np.testing.assert_allclose(centre(robot, ANGLES), pin.centerOfMass(model, data, q), atol=1e-9)


def test_limits_and_friction_of_a_urdf_are_as_stated(write):
    joints = read_robot(write("arm.urdf", URDF)).joints
    shoulder, wrist = joints["shoulder"], joints["wrist"]
    assert (shoulder.lower, shoulder.upper) == (-1, 2)
    assert (shoulder.effort, shoulder.velocity) == (30, 8)
    assert (shoulder.coulomb, shoulder.viscous) == (0.3, 0.05)
    np.testing.assert_allclose(np.linalg.norm([shoulder.axis, wrist.axis], axis=1), 1.0)
    assert wrist.kind == "revolute"
    assert wrist.upper - wrist.lower == pytest.approx(4 * np.pi)
    assert np.isnan(shoulder.armature)


def test_an_mjcf_is_read_as_mujoco_reads_it(write):
    robot, model = read_robot(write("arm.xml", MJCF)), mujoco.MjModel.from_xml_string(MJCF)
    assert robot.floating
    data = mujoco.MjData(model)
    for name, angle in ANGLES.items():
        data.qpos[model.joint(name).qposadr[0]] = angle
    mujoco.mj_forward(model, data)
    base = model.body("base").id
    turn = data.xmat[base].reshape(3, 3)
    expected = turn.T @ (data.subtree_com[base] - data.xpos[base])
    np.testing.assert_allclose(centre(robot, ANGLES), expected, atol=1e-9)
    for name, link in robot.links.items():
        body = model.body(name).id
        np.testing.assert_allclose(
            np.linalg.eigvalsh(link.inertia), np.sort(model.body_inertia[body]), rtol=1e-9
        )
        rotation, _ = placed(robot, name, ANGLES)
        own = data.ximat[body].reshape(3, 3)
        world = own @ np.diag(model.body_inertia[body]) @ own.T
        np.testing.assert_allclose(
            turn @ rotation @ link.inertia @ (turn @ rotation).T, world, atol=1e-9
        )
    assert robot.joints["shoulder"].armature == 0.01
    assert robot.joints["shoulder"].upper == pytest.approx(np.pi / 2)
    assert np.isnan(robot.joints["wrist"].armature)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('xyz="0.1 0 0.4"', 'xyz="100 0 400"', "millimetres"),
        ('upper="2"', 'upper="90"', "degrees"),
        ('<child link="hand"/>', '<child link="upper-arm"/>', "arm.urdf"),
        ("<robot", "<machine", "arm.urdf"),
        (URDF, '<sdf version="1.6"><model name="a"/></sdf>', "is SDF, which is not read"),
    ],
)
def test_what_looks_wrong_is_refused(write, old, new, words):
    text = URDF.replace(old, new)
    with pytest.raises(InputError, match=words):
        read_robot(write("arm.urdf", text))


def test_names_are_made_fit_for_dotted_paths():
    for name in ("left-arm.1", "1st", "über gelenk", "_x"):
        fit = fit_name(name)
        assert "." not in fit
        assert fit.isidentifier()
        assert fit_name(fit) == fit
