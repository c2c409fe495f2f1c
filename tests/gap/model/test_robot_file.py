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
