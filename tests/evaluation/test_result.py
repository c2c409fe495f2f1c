"""Tables of results: a row a trial, seeds as statistics takes them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.protocols.walk import measure_walk
from hyperleg_design.evaluation.result import evaluation_of
from hyperleg_design.evaluation.rollout import FELL


@pytest.fixture(scope="module")
def evaluations(planned_trial, design):
    protocol = WalkProtocol()
    trials = [planned_trial, dataclasses.replace(planned_trial, outcome=FELL)]
    parts = [list(p) for p in zip(*(measure_walk(t, protocol) for t in trials), strict=True)]
    one = evaluation_of(standing(14), design, protocol, trials, *parts)
    return [
        dataclasses.replace(one, policy=f"p{k}", seed=seed, steps=k)
        for k, seed in enumerate([0, 0, 1, -1, -1])
    ]


def test_values_of_an_evaluation(evaluations):
    assert evaluations[0].outcomes == ["arrived", "fell"]
    assert np.array_equal(evaluations[0].values("fell"), [0, 1])


def test_paths_lie_in_the_frame_of_the_start(planned_trial, turned_trial, design):
    protocol = WalkProtocol()
    parts = [
        list(p)
        for p in zip(
            *(measure_walk(t, protocol) for t in (planned_trial, turned_trial)), strict=True
        )
    ]
    straight, turned = evaluation_of(
        standing(14), design, protocol, [planned_trial, turned_trial], *parts
    ).paths
    assert straight[0].tolist() == [0, 0]
    assert straight[-1, 0] > 20
    assert turned == pytest.approx(straight, abs=1e-9)
