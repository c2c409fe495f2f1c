"""Tables of results: a row a trial, seeds as statistics takes them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.result import by_seed, evaluation_of, motor_table, trial_table
from hyperleg_design.evaluation.rollout import FELL
from hyperleg_design.evaluation.walk import measure_walk


@pytest.fixture(scope="module")
def evaluations(planned_trial, design):
    protocol = WalkProtocol()
    trials = [planned_trial, dataclasses.replace(planned_trial, outcome=FELL)]
    parts = [list(p) for p in zip(*(measure_walk(t, protocol) for t in trials), strict=True)]
    one = evaluation_of(standing(14), design, protocol, trials, *parts)
    return [dataclasses.replace(one, policy=f"p{k}", seed=seed, steps=k) for k, seed in enumerate([0, 0, 1, -1, -1])]


def test_a_row_a_trial(evaluations):
    table = trial_table(evaluations)
    assert len(table) == 10
    assert table["outcome"].tolist() == ["arrived", "fell"] * 5
    assert table.loc[0, "steady_cost_of_transport"] == evaluations[0].measures[0]["steady_cost_of_transport"]
    assert table["variant"].unique().tolist() == ["toe"]


def test_a_row_a_motor_of_trials_that_have_a_steady_state(evaluations):
    table = motor_table(evaluations)
    assert len(table) == 5 * 14
    assert table.loc[2, "motor"] == "left_hip_pitch"
    assert table.loc[2, "rms_torque"] == pytest.approx(evaluations[0].motors[0].rms_torque[2])


def test_checkpoints_of_a_seed_are_pooled_and_unknown_seeds_stand_alone(evaluations):
    groups = by_seed(trial_table(evaluations), "fell")
    assert sorted(len(g) for g in groups) == [2, 2, 2, 4]
    assert statistics.share(groups).mean == 0.5
    times = by_seed(trial_table(evaluations), "time")
    found = statistics.estimate(times)
    assert (found.trials, found.missing) == (5, 5)
    with pytest.raises(InputError, match="no_such"):
        by_seed(trial_table(evaluations), "no_such")


def test_values_of_an_evaluation(evaluations):
    assert evaluations[0].outcomes == ["arrived", "fell"]
    assert np.array_equal(evaluations[0].values("fell"), [0, 1])
