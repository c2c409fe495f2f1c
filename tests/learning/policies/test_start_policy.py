"""Reading the policy that a training starts from."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from hyperleg_design import resources
from hyperleg_design.evaluation.shipped import find_policy
from hyperleg_design.robot.design import load_design

pytest.importorskip("torch")
pytest.importorskip("onnx")

from hyperleg_design.learning.policies.start_policy import SEEN, read_start

CONDITIONED = resources.content_folder("sim") / "conditioned/walk_designs-toe-0/policy.onnx"


def test_a_conditioned_policy_keeps_the_scale_of_its_inputs(tmp_path: Path) -> None:
    """Its normaliser counts for all samples of its training, that of another policy for few."""
    design = load_design("toe")
    conditioned = read_start(CONDITIONED, design)
    assert conditioned.seen == float(conditioned.source["steps"])
    assert read_start(find_policy("walk_upright-toe-1"), design).seen == SEEN


def test_a_policy_keeps_the_scale_of_its_inputs_in_its_own_task() -> None:
    start = read_start(find_policy("walk_upright-toe-1"))
    assert start.toward("t_test_guided").seen == SEEN
    assert start.toward("walk_upright").seen == float(start.source["steps"]) > SEEN


def test_a_policy_without_a_critic_takes_that_of_another_seed(tmp_path: Path) -> None:
    for seed in "13":
        shutil.copytree(find_policy("walk_upright-toe-0").parent, tmp_path / f"walk-toe-{seed}")
    own, other = (tmp_path / f"walk-toe-{seed}/policy.onnx" for seed in "13")
    assert read_start(own).own_critic
    own.with_name("critic.onnx").unlink()
    start = read_start(own)
    assert start.critic is not None
    assert not start.own_critic
    assert start.source["critic_sha256"] == read_start(other).source["critic_sha256"]
    other.with_name("critic.onnx").rename(tmp_path / "critic.onnx")
    assert read_start(own).critic is None
