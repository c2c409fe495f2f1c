"""ONNX policies: what they say of themselves, and one clear error for each way in which a file can
be wrong.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import (
    check_layout,
    checked_action,
    load_policy,
    standing,
)
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

SHORT = WalkProtocol(trials=3, distance=2.0, time_limit=2.0, steady=Steady(begin=0.5))


def test_a_policy_says_what_it_is(make_onnx, design):
    policy = load_policy(make_onnx(weight=0.5, bias=1.0))
    assert policy.name.endswith("/small")
    assert (policy.seed, policy.steps, policy.variant) == (3, 1000, "toe")
    assert policy.design.to_mapping() == design.to_mapping()
    assert policy.task.name == "walk"
    observation = np.random.default_rng(0).normal(size=(4, len(policy.columns)))
    assert policy(observation) == pytest.approx(
        np.repeat(0.5 * observation.sum(1, keepdims=True) + 1, 14, 1), abs=1e-4
    )


def test_a_policy_brings_robot_and_task_to_its_evaluation(make_onnx, design):
    policy = load_policy(make_onnx())
    found = evaluate(policy, SHORT)
    same = evaluate(standing(14), SHORT, design=design, task=load_task("walk"))
    assert found.policy.endswith("/small")
    assert (found.seed, found.steps) == (3, 1000)
    assert np.array_equal(found.values("distance"), same.values("distance"))


def test_a_policy_runs_on_a_design_with_the_same_layout_only(make_onnx, design):
    policy = load_policy(make_onnx())
    heavier = design.with_values({"pelvis.mass": float(design.pelvis.mass) + 1})
    check_layout(policy, Environment(heavier, policy.task, simulations=1))
    with pytest.raises(InputError, match=r"joint_position\.left_toe|instead of"):
        check_layout(
            policy, Environment(load_design(variant="toe_removed"), policy.task, simulations=1)
        )
    with pytest.raises(InputError, match=r"number 65 is clock_sine instead of linear_velocity\.0"):
        check_layout(policy, Environment(design, load_task("walk_paper"), simulations=1))
    bare = load_task("walk").changed(
        observations={"policy": ("proprioception",), "critic": ("proprioception",)}
    )
    with pytest.raises(InputError, match="67 numbers instead of 65"):
        check_layout(policy, Environment(design, bare, simulations=1))


def test_a_truncated_file_is_told(make_onnx):
    path = make_onnx()
    path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(InputError, match="no whole ONNX file"):
        load_policy(path)


@pytest.mark.parametrize("content", [b"", b"not a network", b"\x00" * 400])
def test_a_file_of_something_else_is_told(write, content):
    with pytest.raises(InputError, match=r"no whole ONNX file|expects hyperleg-policy-1"):
        load_policy(write("other.onnx", content))


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        load_policy(tmp_path / "nothing.onnx")


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"format": None}, "format"),
        ({"format": "hyperleg-policy-9"}, "format"),
        ({"columns": None}, "columns"),
        ({"columns": "angular_velocity"}, "columns"),
        ({"columns": ["a", "b"]}, "observation"),
        ({"joints": ["a"] * 13}, "action"),
        ({"task": "walk"}, "task"),
        ({"task": {"name": "walk"}}, "commands"),
        ({"design": {"name": "x"}}, "pelvis"),
        ({"design": None}, "design"),
    ],
)
def test_metadata_that_do_not_fit_are_told(make_onnx, changes, field):
    with pytest.raises(InputError) as caught:
        load_policy(make_onnx(**changes))
    assert caught.value.field == field
    assert "small.onnx" in caught.value.where


def test_a_file_that_does_not_know_its_seed_still_runs(make_onnx):
    policy = load_policy(make_onnx(seed=None, steps="many"))
    assert (policy.seed, policy.steps) == (-1, -1)


def test_nan_names_step_and_trial(make_onnx):
    with pytest.raises(
        InputError,
        match=r"small: action = .* is not finite in policy step 0 \(0\.00 s\) of trial 0",
    ):
        evaluate(load_policy(make_onnx(bias=float("nan"))), SHORT)
    actions = np.zeros((3, 14))

    def late(observation):
        return actions

    actions[1, 4] = np.inf
    with pytest.raises(InputError, match=r"step 7 \(0\.14 s\) of trial 1"):
        checked_action(late, np.zeros((3, 5)), 7, 0.02, np.ones(3, bool), 14)
    found = checked_action(late, np.zeros((3, 5)), 7, 0.02, np.array([True, False, True]), 14)
    assert np.all(found == 0)


def test_a_broken_policy_is_named_by_its_path(tmp_path):
    path = tmp_path / "walk-toe-0" / "policy.onnx"
    path.parent.mkdir()
    path.write_bytes(b"cut off")
    with pytest.raises(InputError, match=rf"^{path}: is no whole ONNX file"):
        load_policy(path)
