"""A policy is replayed as it is evaluated."""

from __future__ import annotations

import numpy as np

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import Steady, TTestProtocol, WalkProtocol
from hyperleg_design.report.pictures import replay
from hyperleg_design.simulation.tasks import load_task

SHORT = WalkProtocol(trials=3, distance=2.0, time_limit=2.0, steady=Steady(begin=0.5))


def test_a_replay_is_a_trial_of_the_evaluation(hyperleg):
    task = load_task("walk")
    one = replay.replay(standing(14), SHORT, design=hyperleg, task=task)
    all_three = evaluate(standing(14), SHORT.changed(trials=1), design=hyperleg, task=task)
    assert len(one.outcomes) == len(one.trials) == 1
    assert np.array_equal(one.trials[0].joint_position, all_three.trials[0].joint_position)
    other = replay.replay(standing(14), SHORT, seed=5, design=hyperleg, task=task)
    assert not np.array_equal(one.trials[0].joint_position[:1], other.trials[0].joint_position[:1])


def test_the_task_chooses_what_is_replayed(trainings):
    assert isinstance(
        replay.replay(trainings / "t_test-toe-0" / "policy.onnx").protocol, TTestProtocol
    )
    found = replay.replay(trainings / "walk_upright-toe-0" / "policy.onnx")
    assert isinstance(found.protocol, WalkProtocol)
