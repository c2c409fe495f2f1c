from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model import robot_file

TWO = """<mujoco><worldbody><body name="a"><joint name="j"/><geom size="0.1"/><body name="b" pos="0 0 1"><joint name="k"/>
  <geom size="0.1"/></body></body></worldbody><actuator>%s</actuator></mujoco>"""  # noqa: E501


def drives(actuators, kept=("j", "k")):
    return robot_file.read_drives(mujoco.MjModel.from_xml_string(TWO % actuators), kept)


def test_two_actuators_of_one_joint_add_up():
    found = drives(
        '<position joint="j" kp="50" forcerange="-5 5"/><velocity joint="j" kv="2" forcerange="-3 '
        '3"/><motor joint="k"/>'
    )
    np.testing.assert_allclose(found.gains[0], [50, 2])
    assert np.isnan(found.gains[1]).all()
    assert found.limit.tolist() == [8.0, np.inf]
    assert not found.passive.any()


def test_gear_works_on_both_sides():
    found = drives('<position joint="j" kp="50" kv="1" gear="3" forcerange="-5 5"/>')
    np.testing.assert_allclose(found.gains[0], [450, 9])
    assert found.limit[0] == 15.0
    assert found.passive.tolist() == [False, True]


def test_only_kept_joints():
    found = drives('<motor name="m" joint="j"/><motor joint="k"/>', ("k",))
    assert found.names == ("k",)
    assert found.matrix.shape == (1, 1)


def test_lever_that_changes_is_left_out_with_a_note():
    text = TWO.replace(
        '<geom size="0.1"/></body></body>', '<geom size="0.1"/><site name="s"/></body></body>'
    )
    model = mujoco.MjModel.from_xml_string(text % '<general site="s" gear="0 0 1 0 0 0"/>')
    found = robot_file.read_drives(model, ("j", "k"))
    assert "lever" in found.notes[0]


def test_a_root_that_hangs_on_a_joint_cannot_float():
    spec = mujoco.MjSpec.from_string(TWO % "")
    with pytest.raises(InputError, match="hangs on a joint"):
        robot_file.set_base(spec, "floating", Path("two.xml"))


def test_added_mass_moves_the_centre():
    model = mujoco.MjModel.from_xml_string(TWO % "")
    before = model.body_mass[2], model.body_ipos[2].copy()
    robot_file.add_mass(model, "b", 2.0, np.array([0.0, 0.3, 0.0]))
    assert model.body_mass[2] == before[0] + 2.0
    np.testing.assert_allclose(
        model.body_ipos[2], (before[0] * before[1] + [0, 0.6, 0]) / (before[0] + 2.0)
    )


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
