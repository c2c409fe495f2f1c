"""Which policies stand for a protocol on a robot."""

from __future__ import annotations

import dataclasses
import json
import re

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import policy_choice
from hyperleg_design.evaluation.policy_choice import policies_for, trained_names
from hyperleg_design.robot.load import load_robot

QUADRUPED, LEG = load_robot("mini_cheetah"), load_robot("toe")


def trained(folder, *names, family="hyperleg"):
    """A folder of trainings of these names."""
    for name in names:
        (folder / name).mkdir()
        (folder / name / "policy.onnx").write_bytes(b"x")
        (folder / name / "run.json").write_text(json.dumps({"design": {"family": family}}))
    return folder


def chosen(*arguments):
    return [policy.training for policy in policies_for(*arguments)]


def test_guided_policies_stand_for_no_protocol_but_can_be_named(tmp_path):
    trained(tmp_path, "t_test_guided-toe_locked-0", "t_test_guided-toe-0", "t_test_free-toe-0")
    assert chosen("t_test", LEG, 3, [tmp_path]) == ["t_test_free-toe-0"]
    assert chosen("t_test_guided", LEG, 3, [tmp_path]) == ["t_test_guided-toe-0"]
    with pytest.raises(InputError, match="no policy was trained for this task and toe layout"):
        policies_for("t_test", load_robot("toe_locked"), 3, [tmp_path])


def test_a_hyperleg_walks_by_its_toe_layout_and_a_tree_by_its_name(tmp_path):
    assert chosen("walk", load_robot("toe_locked"), 2) == [
        "walk_upright-toe_locked-0",
        "walk_upright-toe_locked-1",
    ]
    heavier = QUADRUPED.with_values({"links.trunk.mass": 5.0})
    assert chosen("walk", heavier, 3) == ["walk_any-mini_cheetah-0"]


def test_each_of_several_folders_has_its_policies_and_no_two_one_name(tmp_path):
    one, other = tmp_path / "one", tmp_path / "other"
    one.mkdir()
    other.mkdir()
    trained(one, "walk_upright-toe-0", "walk_upright-toe-1", "walk_upright-toe_locked-0")
    trained(other, "walk_designs-toe-0")
    both = ["walk_upright-toe-0", "walk_designs-toe-0"]
    assert chosen("walk", LEG, 1, [one, other]) == both
    assert chosen("walk", load_robot("toe_locked"), 1, [one, other]) == [
        "walk_upright-toe_locked-0"
    ]
    trained(other, "walk_upright-toe-1")
    with pytest.raises(InputError, match="walk_upright-toe-1': is in two of these folders"):
        policies_for("walk", LEG, 3, [one, other])


def test_a_file_that_changes_a_tree_walks_by_the_policies_of_its_base(tmp_path):
    (tmp_path / "long_cheetah.yaml").write_text(
        "base: mini_cheetah\njoints: {knee: {position: [0.0, 0.004, -0.22]}}\n"
    )
    (tmp_path / "own.yaml").write_text("base: long_cheetah\nlinks: {trunk: {mass: 4.0}}\n")
    robot = load_robot(tmp_path / "own.yaml")
    assert trained_names(robot) == ("own", "long_cheetah", "mini_cheetah")
    assert chosen("walk", robot, 3) == ["walk_any-mini_cheetah-0"]
    trained(tmp_path, "walk_any-mini_cheetah-0", "walk_any-long_cheetah-4", family="tree")
    assert chosen("walk", robot, 3, [tmp_path]) == ["walk_any-long_cheetah-4"]


def test_names_of_robots_may_hold_hyphens(tmp_path):
    robot = dataclasses.replace(QUADRUPED, name="long-legged-0")
    trained(tmp_path, "walk_any-long-legged-0-2", "walk_any-long-1", family="tree")
    assert chosen("walk", robot, 3, [tmp_path]) == ["walk_any-long-legged-0-2"]


def test_a_tree_of_the_name_of_a_toe_layout_takes_no_hyperlegs_policy(tmp_path):
    namesake = dataclasses.replace(QUADRUPED, name="toe")
    with pytest.raises(InputError, match="no policy was trained for this task and robot"):
        policies_for("walk", namesake, 1)
    trained(tmp_path, "walk_any-toe-0", family="tree")
    assert chosen("walk", namesake, 1, [tmp_path]) == ["walk_any-toe-0"]
    with pytest.raises(InputError, match="toe layout"):
        policies_for("walk", LEG, 1, [tmp_path])


@pytest.mark.parametrize(
    ("kind", "design", "remedy"),
    [
        (
            "walk",
            "parallel_ankle",
            "hyperleg train --task walk_any --preset walker --design parallel_ankle --out "
            "FOLDER/walk_any-parallel_ankle-0 trains one, and --policies FOLDER takes it",
        ),
        (
            "t_test",
            "toe_removed",
            "hyperleg train --task goal --design toe_removed --out FOLDER/t_test-toe_removed-0",
        ),
        (
            "t_test",
            "mini_cheetah",
            "--task t_test_any --preset walker --start FOLDER/walk_any-mini_cheetah-0 "
            "--design mini_cheetah --out FOLDER/t_test_any-mini_cheetah-0",
        ),
        ("jump", "mini_cheetah", "no shipped task trains one: train a task of your own"),
    ],
)
def test_a_robot_without_policies_is_told_how_to_train_one(kind, design, remedy):
    with pytest.raises(InputError, match=re.escape(remedy)):
        policies_for(kind, load_robot(design), 3)


def test_a_training_that_is_not_finished_is_told(tmp_path):
    (trained(tmp_path, "walk_any-rex-0", family="tree") / "walk_any-rex-0" / "policy.onnx").unlink()
    rex = dataclasses.replace(QUADRUPED, name="rex")
    with pytest.raises(InputError, match="walk_any-rex-0 is not finished; hyperleg train with"):
        policies_for("walk", rex, 3, [tmp_path])
    with pytest.raises(InputError, match="--task t_test_any"):
        policies_for("t_test", rex, 3, [tmp_path])


def test_a_robot_that_cannot_be_simulated_says_so_first():
    with pytest.raises(InputError, match=r"trunk\.motion = 'fixed': expects floating"):
        policies_for("walk", load_robot("teaching_leg"), 3)


def test_the_training_of_a_file_names_the_file_and_the_folder_of_motors(tmp_path, monkeypatch):
    text = (load_robot("parallel_ankle").to_mapping(), tmp_path / "dog.yaml")
    text[1].write_text(json.dumps(text[0] | {"name": "rex"}))
    named = f"--design {re.escape(str(text[1]))}"
    with pytest.raises(InputError, match=f"{named} --out FOLDER/walk_any-rex-0"):
        policies_for("walk", load_robot(text[1]), 3)
    monkeypatch.setattr(policy_choice, "folder_option", lambda: " --motors mine")
    with pytest.raises(InputError, match=f"{named} --motors mine --out FOLDER"):
        policies_for("walk", load_robot(text[1]), 3)
