import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.blind.robots.tree_links import matrix, tree_links

TWO = """<mujoco><worldbody>
<body name="upper" pos="0 0 1"><joint name="hip" axis="0 1 0" pos="0 0.1 0"/>
 <geom type="box" size=".1 .1 .1" mass="2"/>
 <body name="plate" pos="0.3 0 0" euler="0 0 90">
  <geom type="box" size=".1 .05 .02" mass="1"/></body>
 <body name="lower" pos="0 0 -0.5" euler="10 0 20"><joint name="knee" axis="1 0 0"/>
  <geom type="box" size=".05 .1 .2" mass="1.5" pos="0 0 -.1"/></body>
</body></worldbody></mujoco>"""


BODY = """<mujoco><worldbody><body name="b">{}<geom size=".1"/></body></worldbody></mujoco>"""


def links(text):
    return tree_links(mujoco.MjModel.from_xml_string(text))


def test_bodies_without_a_joint_weigh_on_the_one_that_carries_them():
    model = mujoco.MjModel.from_xml_string(TWO)
    upper, lower = tree_links(model)
    assert (upper.joint, lower.joint, upper.parent, lower.parent) == ("hip", "knee", -1, 0)
    assert upper.mass == pytest.approx(3.0)
    assert upper.mass + lower.mass == pytest.approx(model.body_mass.sum())


def test_inertia_is_that_of_mujoco_at_any_posture():
    model = mujoco.MjModel.from_xml_string(TWO)
    data, (upper, lower) = mujoco.MjData(model), tree_links(model)
    data.qpos[:] = 0.4, -0.7
    mujoco.mj_forward(model, data)
    full = np.zeros((2, 2))
    mujoco.mj_fullM(model, data, full)

    def turned(axis, angle):
        quaternion = np.zeros(4)
        mujoco.mju_axisAngle2Quat(quaternion, axis, angle)
        return matrix(quaternion)

    first = upper.rotation @ turned(upper.axis, data.qpos[0])
    second = first @ lower.rotation @ turned(lower.axis, data.qpos[1])
    origins = [upper.place, upper.place + first @ lower.place]
    axes = [first @ upper.axis, second @ lower.axis]
    about = np.zeros((2, 2))
    for link, rotation, origin, moved_by in (
        (upper, first, origins[0], [0]),
        (lower, second, origins[1], [0, 1]),
    ):
        com = origin + rotation @ link.com
        inertia = rotation @ link.inertia @ rotation.T
        for i in moved_by:
            for j in moved_by:
                linear = np.cross(axes[i], com - origins[i]) @ np.cross(axes[j], com - origins[j])
                about[i, j] += link.mass * linear + axes[i] @ inertia @ axes[j]
    np.testing.assert_allclose(about, full, atol=1e-12)


def test_a_free_base_is_held():
    base = '<body name="b"><freejoint/><geom size=".1" mass="9"/><body name="upper">'
    text = TWO.replace('<body name="upper" pos="0 0 1">', base)
    held = links(text.replace("</worldbody>", "</body></worldbody>"))
    assert [link.mass for link in held] == pytest.approx([3.0, 1.5])
    assert held[0].parent == -1


@pytest.mark.parametrize("joint", ['<joint type="slide"/>', "<joint/><joint axis='1 0 0'/>"])
def test_other_joints_are_refused(joint):
    with pytest.raises(ValueError, match="body b: one hinge"):
        links(BODY.format(joint))


def test_rotations_are_mujocos():
    quaternion = np.array([0.5, -0.1, 0.7, 0.3])
    quaternion /= np.linalg.norm(quaternion)
    expected = np.zeros(9)
    mujoco.mju_quat2Mat(expected, quaternion)
    np.testing.assert_allclose(matrix(quaternion).ravel(), expected, atol=1e-15)
