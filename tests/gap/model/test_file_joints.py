"""Joints of a compiled file: which count, and what is read of them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model import file_joints

TEXT = """<mujoco><worldbody><body name="cart"><freejoint/><geom size="0.1" mass="1"/>
  <body><joint name="slide" type="slide" axis="1 0 0" damping="0.5" range="-1 2"/>
    <geom size="0.1" mass="1"/>
    <body><joint name="ball" type="ball"/><geom size="0.1" mass="1"/>
      <body><joint name="hinge" axis="0 1 0" frictionloss="0.3" stiffness="7" springref="20"/>
        <geom size="0.1" mass="1"/></body></body></body></body></worldbody></mujoco>"""


def test_only_hinges_and_slides_are_joints_of_one_number():
    model = mujoco.MjModel.from_xml_string(TEXT)
    assert [model.joint(j).name for j in file_joints.single_joints(model)] == ["slide", "hinge"]
    dry, viscous = file_joints.friction(model)
    np.testing.assert_array_equal(dry, [0.0, 0.3])
    np.testing.assert_array_equal(viscous, [0.5, 0.0])
    stiffness, rest = file_joints.springs(model)
    np.testing.assert_allclose(stiffness, [0.0, 7.0])
    np.testing.assert_allclose(rest, [0.0, np.deg2rad(20)])
    low, high = file_joints.limits(model)
    np.testing.assert_array_equal(low, [-1.0, -np.inf])
    np.testing.assert_array_equal(high, [2.0, np.inf])


def test_friction_is_taken_out_and_springs_stay():
    model = mujoco.MjModel.from_xml_string(TEXT)
    file_joints.take_out_friction(model)
    assert not np.concatenate(file_joints.friction(model)).any()
    assert file_joints.springs(model)[0].tolist() == [0.0, 7.0]


@pytest.mark.parametrize("field", ["frictionloss", "damping", "armature"])
def test_friction_and_rotors_below_zero_are_refused(field):
    model = mujoco.MjModel.from_xml_string(TEXT)
    file_joints.refuse_negative(model, Path("arm.xml"))
    getattr(model, f"dof_{field}")[model.joint("hinge").dofadr] = -0.1
    with pytest.raises(InputError, match=rf"arm.xml: hinge.{field} = -0.1: is negative"):
        file_joints.refuse_negative(model, Path("arm.xml"))
