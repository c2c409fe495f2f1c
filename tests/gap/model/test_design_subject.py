"""The subject of a design: its numbers are those of the description, whatever the family."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.build import build
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot


def test_our_design_has_its_own_numbers():
    design = load_design("hyperleg")
    subject = load_subject("hyperleg")
    from hyperleg_design.robot.models import rigid_body_model
    from hyperleg_design.robot.transmission import joint_from_motor

    np.testing.assert_allclose(
        subject.joint_from_motor, np.kron(np.eye(2), joint_from_motor(design))
    )
    np.testing.assert_allclose(
        subject.armature, rigid_body_model(design).reflected[6:, 6:], atol=1e-12
    )
    assert subject.base == "floating"
    assert not subject.one_to_one
    assert subject.feet == ("left_foot", "right_foot")
    assert {subject.feet[p.foot] for p in subject.pads} == set(subject.feet)


def test_what_we_build_reads_back_as_somebody_elses_robot(tmp_path):
    """Our own MJCF, through the door for foreign files: coupled motors on tendons included."""
    folder = build(load_design("hyperleg"), tmp_path / "robot")
    own, foreign = subject_of(load_design("hyperleg")), load_subject(folder / "hyperleg.xml")
    assert foreign.joints == own.joints
    assert foreign.motors == own.motors
    np.testing.assert_allclose(foreign.joint_from_motor, own.joint_from_motor, atol=1e-12)
    np.testing.assert_allclose(foreign.armature, own.armature, atol=1e-12)
    np.testing.assert_allclose(foreign.torque_limit, own.torque_limit)
    np.testing.assert_allclose(foreign.viscous, own.viscous)
    np.testing.assert_allclose(foreign.tree.inertial, own.tree.inertial, atol=1e-9)
    assert {p.name for p in foreign.pads} == {p.name for p in own.pads}
    assert foreign.feet == ("left_toe_plate", "right_toe_plate")


@pytest.mark.parametrize("name", ["mini_cheetah", "parallel_ankle", "teaching_leg"])
def test_a_written_out_tree_agrees_with_the_mjcf_that_is_built_of_it(name, tmp_path):
    design = load_robot(name)
    own, foreign = load_subject(name), load_subject(build(design, tmp_path / "r") / f"{name}.xml")
    assert own.joints == foreign.joints
    assert own.base == foreign.base
    np.testing.assert_allclose(own.armature, foreign.armature, atol=1e-9)
    np.testing.assert_allclose(own.tree.inertial, foreign.tree.inertial, atol=1e-9)
    np.testing.assert_allclose(own.coulomb, foreign.coulomb, atol=1e-12)
    np.testing.assert_allclose(own.position_high, foreign.position_high)
    at_joints = np.abs(own.joint_from_motor) @ own.torque_limit
    np.testing.assert_allclose(at_joints, np.abs(foreign.joint_from_motor) @ foreign.torque_limit)


def test_motors_of_a_tree_count_before_their_gears():
    design = load_robot("teaching_leg")
    subject = subject_of(design, "fixed")
    assert subject.joints == subject.motors == ("hip", "knee")
    assert not subject.one_to_one
    np.testing.assert_allclose(subject.joint_from_motor, np.diag([6.0, 6.0]))
    np.testing.assert_allclose(subject.torque_limit, 1.7)  # of the mj5208
    np.testing.assert_allclose(subject.torque_constant, 0.0273)
    np.testing.assert_allclose(subject.gains, [[15.0, 0.3]] * 2)


def test_a_quadruped_has_four_feet_and_a_rod_is_noted():
    quadruped = load_subject("mini_cheetah")
    assert len(quadruped.feet) == 4
    assert sorted({pad.foot for pad in quadruped.pads}) == [0, 1, 2, 3]
    assert any("ankle_outer" in note for note in load_subject("parallel_ankle").notes)
