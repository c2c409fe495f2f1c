"""What evaluated designs say in a terminal: counts, policies and the best designs."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.report.sweep import trials_text
from hyperleg_design.sweep.trial_runs import REJECTED


@pytest.fixture
def trials():
    rows = [
        (0, "toe", "walk", 0, "a", "specialist", "arrived", ""),
        (0, "toe", "walk", 1, "a", "specialist", "arrived", ""),
        (1, "toe", "walk", 0, "a", "zero-shot", "fell", ""),
        (1, "toe", "walk", 0, "b", "zero-shot", "arrived", ""),
        (2, "toe", "walk", 0, "a", "zero-shot", "arrived", ""),
        (3, "toe", "walk", -1, "", "", REJECTED, "cannot stand"),
        (3, "toe", "t_test", -1, "", "", REJECTED, "cannot stand"),
        (4, "toe", "walk", -1, "", "", REJECTED, "cannot stand"),
        (5, "toe", "walk", -1, "", "", REJECTED, "too heavy"),
    ]
    names = ["sample", "variant", "protocol", "trial", "policy", "trained", "outcome", "reason"]
    return pd.DataFrame(rows, columns=names)


def test_policies_are_counted_once_for_each_way_of_training(trials):
    specialist, zero_shot = trials_text.policies_of(trials)
    assert (specialist["trained"], specialist["policies"], specialist["designs"]) == (
        "specialist",
        ["a"],
        1,
    )
    assert (zero_shot["policies"], zero_shot["designs"]) == (["a", "b"], 2)
    text = trials_text.policy_text(trials)
    assert "walk, toe: 1 designs specialist (1 policy)" in text
    assert "2 designs zero-shot (2 policies)" in text


def test_a_refused_design_counts_once_however_many_protocols(trials):
    assert trials_text.unsimulated_text(trials).splitlines() == [
        "2 cannot be simulated: cannot stand",
        "1 cannot be simulated: too heavy",
    ]
    assert trials_text.unsimulated_text(trials[trials["reason"] == ""]) == ""


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ({"x": 1.23456}, "1.235"),
        ({"x": 1.23456, "x.low": np.nan, "x.high": np.nan}, "1.235"),
        ({"x": 1.23456, "x.low": 1.0, "x.high": 1.5}, "1.235 [1, 1.5]"),
    ],
)
def test_a_measure_has_its_interval_where_there_is_one(row, text):
    assert trials_text.with_interval(pd.Series(row), "x") == text


@pytest.mark.parametrize(
    ("kinds", "outside", "text"),
    [
        (("specialist", "specialist"), ("", ""), "specialist"),
        (("specialist", "zero-shot"), ("", ""), "specialist, zero-shot"),
        (("conditioned", None), ("toe.mass", None), "conditioned (outside the trained range)"),
    ],
)
def test_kinds_of_policies_are_named_once(kinds, outside, text):
    row = {"walk.trained": kinds[0], "t_test.trained": kinds[1]}
    row |= {"walk.outside": outside[0], "t_test.outside": outside[1]}
    assert trials_text.policy_kind(pd.Series(row)) == text
    assert trials_text.policy_kind(row) == text


def test_the_policy_of_each_protocol_is_named():
    row = {"walk.policy": "walks-toe-1", "t_test.policy": "turns-toe-0", "walk.trained": "unknown"}
    assert trials_text.policy_names(pd.Series(row)) == "walks-toe-1, turns-toe-0"
    assert trials_text.policy_names({**row, "t_test.policy": np.nan}) == "walks-toe-1"


def test_the_best_design_by_each_objective_comes_with_its_command():
    axes = (SimpleNamespace(name="toe.mass", label="toe.mass [kg]"),)
    sweep = SimpleNamespace(axes=axes, has_variants=True)
    rows = [
        {"by": "cost", "sample": 4.0, "variant": "toe", "toe.mass": 0.123456, "cost": 0.4},
        {"by": "cost", "sample": 2.0, "variant": "toe", "toe.mass": 0.2, "cost": 0.5},
        {"by": "heat", "sample": 0.0, "variant": "toe", "toe.mass": 0.3, "cost": 0.6},
    ]
    chosen = pd.DataFrame(rows, index=[1, 0, 2])
    text = trials_text.best_text(sweep, chosen, ("cost",), ["zero", "one", "two"])
    lines = text.splitlines()
    heads = "best by sample variant toe.mass [kg] cost policy policy is"
    assert " ".join(lines[0].split()) == heads
    assert lines[2].split() == ["cost", "4", "toe", "0.1235", "0.4"]
    assert [line for line in lines if line.startswith("build")] == [
        "build this one: one",
        "build this one: two",
    ]


def test_where_no_design_walks_the_rule_and_the_endings_of_each_policy_are_told():
    designs = pd.DataFrame({"sample": [0, 1, 2], "walk.arrived": [0.5, 0.75, np.nan]})
    text = trials_text.no_walk_text(designs)
    assert "in at least 95 % of the trials of the policy that is best on it" in text
    assert "Sample 1 arrives most often, in 75 %." in text
    assert "--constraint 'walk.arrived>=0.7'" in text
    nothing = trials_text.no_walk_text(designs[2:])
    assert nothing == "No design could be simulated under every protocol."
    assert "has a value" in trials_text.no_walk_text(designs.assign(**{"walk.arrived": 1.0}))
    rows = {"trial": [0, 1, 0, -1], "protocol": "walk", "policy": ["a", "a", "b", ""]}
    endings = {"arrived": [0.0, 0.0, 1.0, np.nan], "fell": [1.0, 0.0, 0.0, np.nan]}
    trials = pd.DataFrame(rows | endings)
    judged = designs.assign(**{"walk.policy": ["b", "b", np.nan]})
    assert trials_text.endings_table(trials, judged)[1] == [
        ["walk", "a", 2, 0.0, 50.0, 0],
        ["walk", "b", 1, 100.0, 0.0, 2],
    ]


def test_designs_without_variants_have_no_cell_of_one():
    sweep = SimpleNamespace(axes=(), has_variants=False)
    row = pd.Series({"sample": 4, "variant": "as_described"})
    assert trials_text.design_cells(sweep, row) == [4]
    assert trials_text.design_heads(sweep) == ["sample"]
