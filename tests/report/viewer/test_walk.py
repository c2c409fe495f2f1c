"""A recording gives back what the simulation did."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.gap.logs.log import write_log
from hyperleg_design.gap.logs.recording import log_of_trial
from hyperleg_design.report.viewer.walk import RecordedWalk, walk_of_file, walk_of_policy
from hyperleg_design.robot.kinematics.posture import link_poses
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot


@pytest.fixture(scope="module")
def walk(walks):
    trial = walks["toe"]
    return RecordedWalk(log_of_trial(trial), trial.design)


def test_ticks_hold_the_trials_pose_and_motor_points(walk, walks):
    trial = walks["toe"]
    row = walk.row(1.0)
    assert row == round(1.0 / trial.time_step)
    assert list(walk.angles(row).values()) == pytest.approx(trial.joint_position[row])
    turn, place = walk.base(row)
    assert place == pytest.approx(trial.base_position[row])
    assert turn @ turn.T == pytest.approx(np.eye(3))
    speed, torque = walk.motor_points("left_knee")
    column = trial.layout.motors.index("left_knee")
    np.testing.assert_array_equal(speed, trial.motor_velocity[:, column])
    np.testing.assert_array_equal(torque, trial.motor_torque[:, column])


def test_contact_forces_add_up_and_act_near_the_floor(walk, walks):
    trial, tree = walks["toe"], build_tree(walk.design)
    for row in (40, 90, 130):
        poses = link_poses(tree, walk.angles(row))
        turn, place = walk.base(row)
        contacts = walk.contacts(row, tree, poses)
        total = np.sum([force for _, force in contacts], axis=0)
        assert total == pytest.approx(trial.pad_force[row].sum(0), abs=2.0)
        for point, _ in contacts:
            assert abs((place + turn @ point)[2]) < 0.05


def test_even_times_repeat_the_recording(walk, walks):
    moving = walk.moving(1 / walks["toe"].time_step)
    assert moving.joints == walks["toe"].joints
    np.testing.assert_allclose(moving.joint_position, walks["toe"].joint_position)
    np.testing.assert_allclose(moving.base_position, walks["toe"].base_position)


def test_a_file_is_read_with_the_robot_that_it_names(walk, tmp_path):
    named = walk.log.changed(metadata=walk.log.metadata.changed(robot="toe"))
    write_log(tmp_path / "a.parquet", named)
    assert walk_of_file(tmp_path / "a.parquet").design.variant == "toe"
    with pytest.raises(InputError, match="position/"):
        walk_of_file(tmp_path / "a.parquet", load_robot("mini_cheetah"))
    unnamed = walk.log.changed(metadata=walk.log.metadata.changed(robot=""))
    write_log(tmp_path / "b.parquet", unnamed)
    with pytest.raises(InputError, match="give a design"):
        walk_of_file(tmp_path / "b.parquet")
    with pytest.raises(InputError, match="does not exist"):
        walk_of_file(tmp_path / "c.parquet")


def test_a_policy_is_run_once(trainings):
    walk = walk_of_policy(trainings / "walk_upright-toe-0" / "policy.onnx")
    assert "after" in walk.caption
    assert walk.duration > 0.1
