"""A planned human walk is believed, one that falls, hops or slides is not."""

from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.evaluation.believable import walk_findings
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.result import evaluation_of
from hyperleg_design.evaluation.rollout import FELL
from hyperleg_design.evaluation.walk import measure_walk


def findings(trials, design, protocol=None):
    protocol = protocol or WalkProtocol()
    parts = [list(p) for p in zip(*(measure_walk(t, protocol) for t in trials), strict=True)]
    return {
        f.demand.measure: f
        for f in walk_findings([evaluation_of(standing(14), design, protocol, trials, *parts)])
    }


def test_the_planned_walk_is_believed(planned_trial, design):
    found = findings([planned_trial], design)
    assert [name for name, f in found.items() if not f.met] == []
    assert found["steady_speed"].found == pytest.approx(1.33)


def test_one_fall_in_two_is_not(planned_trial, design):
    found = findings([planned_trial, dataclasses.replace(planned_trial, outcome=FELL)], design)
    assert found["fell"].found == 0.5
    assert not found["fell"].met
    assert not found["arrived"].met
    assert found["cadence"].met


def test_sliding_feet_and_a_wrong_speed_are_not(planned_trial, design):
    faster = planned_trial.base_position * [
        1.1,
        1.0,
        1.0,
    ]  # the same steps, so the feet are dragged along
    found = findings([dataclasses.replace(planned_trial, base_position=faster)], design)
    stance = 0.1 * 1.33 * 0.62  # of a stride of one second
    assert 0.4 * stance < found["foot_drift"].found < stance
    assert not found["foot_drift"].met
    assert not found["steady_speed"].met


def test_nothing_measured_is_not_met(planned_trial, design):
    found = findings([dataclasses.replace(planned_trial, outcome=FELL)], design)
    assert not found["cadence"].met
