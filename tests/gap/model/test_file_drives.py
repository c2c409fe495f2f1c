import mujoco
import numpy as np

from hyperleg_design.gap.model import file_drives

TWO = """<mujoco><worldbody><body name="a"><joint name="j"/><geom size="0.1"/><body name="b" pos="0 0 1"><joint name="k"/>
  <geom size="0.1"/></body></body></worldbody><actuator>%s</actuator></mujoco>"""  # noqa: E501

TENDON = """<tendon><fixed name="t"><joint joint="k" coef="1"/><joint joint="l" coef="0.5"/></fixed>
  </tendon>"""


def drives(actuators, kept=("j", "k")):
    return file_drives.read_drives(mujoco.MjModel.from_xml_string(TWO % actuators), kept)


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
    found = file_drives.read_drives(model, ("j", "k"))
    assert "lever" in found.notes[0]


def test_the_effort_of_a_joint_limits_the_motor_that_moves_it_alone_beside_coupled_ones():
    text = TWO.replace('name="j"/>', 'name="j" actuatorfrcrange="-60 60"/>')
    text = text.replace("<actuator>", TENDON + "<actuator>")
    text = text.replace(
        'name="k"/>', 'name="k" actuatorfrcrange="-9 9"/><joint name="l" axis="1 0 0"/>'
    )
    model = mujoco.MjModel.from_xml_string(
        text % '<motor joint="j" gear="4"/><motor tendon="t" forcerange="-7 7"/>'
    )
    found = file_drives.read_drives(model, ("j", "k", "l"))
    assert found.limit.tolist() == [15.0, 7.0]
