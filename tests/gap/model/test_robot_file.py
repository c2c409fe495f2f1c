from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model import robot_file

TWO = """<mujoco><worldbody><body name="a"><joint name="j"/><geom size="0.1"/><body name="b" pos="0 0 1"><joint name="k"/>
  <geom size="0.1"/></body></body></worldbody><actuator>%s</actuator></mujoco>"""  # noqa: E501


def test_a_root_that_hangs_on_a_joint_cannot_float():
    spec = mujoco.MjSpec.from_string(TWO % "")
    with pytest.raises(InputError, match="hangs on a joint"):
        robot_file.set_base(spec, "floating", Path("two.xml"))


def test_corners_and_ends_touch_first():
    text = """<mujoco><worldbody><body><geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/><geom type="capsule" size="0.05" fromto="0 0 0 0 0 0.4"/>
      <geom size="0.07" pos="0 0 2"/></body></worldbody></mujoco>"""  # noqa: E501
    model = mujoco.MjModel.from_xml_string(text)
    corners, none = robot_file.touching_points(model, 0)
    assert none == 0.0
    np.testing.assert_allclose(sorted(set(np.round(corners[:, 2], 9))), [-0.3, 0.3])
    ends, radius = robot_file.touching_points(model, 1)
    assert radius == 0.05
    np.testing.assert_allclose(sorted(ends[:, 2]), [0, 0.4], atol=1e-9)
    assert robot_file.touching_points(model, 2)[1] == 0.07


def test_an_inertia_that_no_body_has_becomes_the_nearest_possible(tmp_path):
    path = tmp_path / "robot.urdf"
    possible = '<inertia ixx="0.02" iyy="0.021" izz="0.006" ixy="0.001" ixz="-0.002" iyz="0.0005"/>'
    impossible = '<inertia ixx="0.02" iyy="0.02" izz="0.01" ixy="0.03" ixz="0" iyz="0"/>'
    path.write_text(
        '<robot name="r"><link name="base"/>'
        f'<link name="arm"><inertial><mass value="1"/>{possible}</inertial></link>'
        f'<link name="hand"><inertial><mass value="1"/>{impossible}</inertial></link>'
        '<joint name="a" type="revolute"><parent link="base"/><child link="arm"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint>'
        '<joint name="b" type="revolute"><parent link="arm"/><child link="hand"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint></robot>'
    )
    spec = robot_file.read_spec(path)
    with pytest.raises(ValueError, match="positive eigenvalues"):
        spec.compile()
    (note,) = robot_file.mend_inertias(spec)
    assert "hand" in note
    assert "arm" not in note
    model = robot_file.compiled(spec, path)
    arm = model.body_inertia[model.body("arm").id]
    stated = [[0.02, 0.001, -0.002], [0.001, 0.021, 0.0005], [-0.002, 0.0005, 0.006]]
    np.testing.assert_allclose(np.sort(arm), np.linalg.eigvalsh(stated), rtol=1e-6)
    hand = np.sort(model.body_inertia[model.body("hand").id])
    # moments of inertia -0.01, 0.01, 0.05: the second moments are 0.035, 0.015 and -0.025
    np.testing.assert_allclose(hand, [0.015, 0.035, 0.05], rtol=1e-4)
    assert robot_file.mend_inertias(spec) == []


def test_a_point_that_a_file_rounds_below_zero_is_no_impossible_body(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="1"/>'
        '<inertia ixx="0" iyy="4e-18" izz="0" ixy="0" ixz="0" iyz="-3e-20"/></inertial></link>'
        '<joint name="a" type="revolute"><parent link="base"/><child link="arm"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint></robot>'
    )
    spec = robot_file.read_spec(path)
    assert robot_file.mend_inertias(spec) == []
    model = robot_file.compiled(spec, path)
    np.testing.assert_allclose(
        model.body_inertia[model.body("arm").id], robot_file.SMALLEST_INERTIA, rtol=1e-6
    )
