"""The subject of anybody's file: its actuators, gears, base and scenery."""

from __future__ import annotations

import numpy as np
import pytest
import robots

from hyperleg_design.errors import InputError
from hyperleg_design.gap.signals.loading import load_subject


def test_servos_of_a_foreign_arm(robot_files):
    subject = load_subject(robot_files["arm"])
    assert subject.one_to_one
    assert subject.base == "fixed"
    assert subject.motor_aliases == ("a1", "a2", "a3", "a4", "a5", "a6")
    np.testing.assert_allclose(subject.gains[3], [500, 50])
    np.testing.assert_allclose(subject.torque_limit, [150, 150, 150, 28, 28, 28])
    np.testing.assert_allclose(np.diag(subject.armature), 0.1)
    np.testing.assert_allclose(subject.viscous, [1, 1, 0.5, 0.2, 0.2, 0.1])
    assert subject.position_high[0] == 6.28
    assert np.isinf(subject.position_high[1])


@pytest.mark.parametrize("floor", [True, False])
def test_a_leg_on_a_rail_has_a_foot_where_its_file_has_a_floor(tmp_path, floor):
    plane = '<geom type="plane" size="1 1 1"/>' if floor else ""
    text = f"""<mujoco><worldbody>{plane}<body name="carriage" pos="0 0 0.5">
      <joint name="rail" type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="leg"><joint name="hip" axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="1 1 1"/>
      <geom name="sole" size="0.02" pos="0 0 -0.3"/></body></body></worldbody></mujoco>"""  # noqa: E501
    (tmp_path / "rail.xml").write_text(text)
    subject = load_subject(tmp_path / "rail.xml")
    assert (subject.base, subject.joints) == ("fixed", ("rail", "hip"))
    assert (subject.feet, [pad.name for pad in subject.pads]) == (
        (("leg",), ["sole"]) if floor else ((), [])
    )


def test_gears_fold_into_the_joint(tmp_path):
    text = """<mujoco><worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody><actuator>
      <motor name="m" joint="j" gear="20" ctrlrange="-2 2"/></actuator></mujoco>"""  # noqa: E501
    (tmp_path / "geared.xml").write_text(text)
    subject = load_subject(tmp_path / "geared.xml")
    assert subject.joint_from_motor.tolist() == [[1.0]]
    assert subject.torque_limit.tolist() == [40.0]
    assert np.isnan(subject.gains).all()


def test_no_actuators_and_loose_things(tmp_path):
    text = """<mujoco><worldbody><body name="cup" pos="1 0 0"><freejoint/><geom size="0.05"/></body>
      <body name="a"><joint name="j"/><geom size="0.1"/><body name="b"><joint name="k"/><geom size="0.1"/></body></body></worldbody></mujoco>"""  # noqa: E501
    (tmp_path / "bare.xml").write_text(text)
    subject = load_subject(tmp_path / "bare.xml")
    assert subject.links == ("a", "b")
    assert subject.motors == subject.joints == ("j", "k")
    assert not subject.passive.any()
    assert np.isinf(subject.torque_limit).all()


def test_missing_meshes_matter_only_where_masses_follow_from_them(tmp_path):
    text = robots.PENDULUM.replace(
        '<inertial pos="0 0 -0.1" mass="0.5" diaginertia="0.0006 0.0006 0.0001"/>',
        '<geom type="mesh" mesh="m"/>',
    )
    text = text.replace("<worldbody>", '<asset><mesh name="m" file="gone.stl"/></asset><worldbody>')
    (tmp_path / "p.xml").write_text(text)
    with pytest.raises(InputError, match="give each body an inertial"):
        load_subject(tmp_path / "p.xml")


def test_not_a_robot(tmp_path):
    (tmp_path / "x.urdf").write_text("<robot>")
    with pytest.raises(InputError, match="neither MJCF nor URDF"):
        load_subject(tmp_path / "x.urdf")
