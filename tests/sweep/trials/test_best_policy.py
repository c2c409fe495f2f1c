"""The policy that a design is judged by is chosen by other trials than those that are reported."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.sweep.trials.best_policy import best_policy, reported_trials


def trials_of(outcomes, costs=0.5):
    """Trials of each policy, its outcomes in the order of their numbers."""
    rows = [
        {
            "policy": policy,
            "trial": k,
            "outcome": outcome,
            "fell": float(outcome == "fell"),
            "cost_of_transport": costs[policy] if isinstance(costs, dict) else costs,
        }
        for policy, own in outcomes.items()
        for k, outcome in enumerate(own)
    ]
    return pd.DataFrame(rows)


def drawn(rng, policies, count, arrives=0.8):
    """Random trials; `arrives` is the probability of an arrival, of one or of each policy."""
    happened = rng.random((policies, count)) < np.reshape(arrives, (-1, 1))
    names = np.where(happened, "arrived", "fell").tolist()
    trials = trials_of({f"p-{i}": own for i, own in enumerate(names)})
    return trials.assign(cost_of_transport=rng.normal(0.5, 0.1, len(trials)))


def test_a_policy_that_falls_does_not_hide_a_design_that_another_one_walks():
    trials = trials_of({"falls": ["fell"] * 4, "walks": ["arrived"] * 4})
    reported = reported_trials(trials)
    assert set(reported["policy"]) == {"walks"}
    assert reported["trial"].tolist() == [0, 2]
    assert reported["fell"].mean() == 0


def test_a_robot_that_only_stands_is_not_the_best():
    trials = trials_of({"stands": ["timed_out"] * 4, "walks": ["arrived"] * 3 + ["fell"]})
    assert best_policy(trials) == "walks"


@pytest.mark.parametrize(
    ("outcomes", "costs", "name"),
    [
        (("arrived", "arrived"), (0.6, 0.5), "b"),
        (("arrived", "arrived"), (0.5, 0.5), "a"),
        (("arrived", "arrived"), (np.nan, 0.5), "b"),
        (("arrived", "timed_out"), (0.6, 0.5), "a"),
        (("fell", "timed_out"), (-2.0, 0.9), "b"),  # what a fall costs does not count
    ],
)
def test_arrivals_come_first_and_then_the_cost_of_transport(outcomes, costs, name):
    names = ("a", "b")
    trials = trials_of(
        {policy: [outcome] * 2 for policy, outcome in zip(names, outcomes, strict=True)},
        dict(zip(names, costs, strict=True)),
    )
    assert best_policy(trials) == name


@given(st.integers(0, 2**32 - 1), st.integers(2, 4), st.integers(2, 9))
def test_reported_trials_have_no_say_in_the_choice(seed, policies, count):
    rng = np.random.default_rng(seed)
    trials = drawn(rng, policies, count)
    reported = reported_trials(trials)
    assert reported["policy"].nunique() == 1
    assert len(reported) == (count + 1) // 2
    other = drawn(rng, policies, count, 0.2)
    mixed = pd.concat([trials[trials["trial"] % 2 == 1], other[other["trial"] % 2 == 0]])
    again = reported_trials(mixed)
    assert set(again["policy"]) == set(reported["policy"])
    assert set(again["trial"]).isdisjoint(trials.loc[trials["trial"] % 2 == 1, "trial"])


@given(st.integers(0, 2**32 - 1), st.integers(1, 9))
def test_of_a_single_policy_all_trials_are_reported(seed, count):
    trials = drawn(np.random.default_rng(seed), 1, count)
    pd.testing.assert_frame_equal(reported_trials(trials), trials)


@pytest.mark.slow
def test_equal_policies_are_reported_without_flattery():
    """Of equally good policies, the lowest mean of all trials is too low; that of reported trials
    is right.
    """
    rng = np.random.default_rng(0)
    chosen, flattered = [], []
    for _ in range(200):
        trials = drawn(rng, 3, 10, 1.0)
        chosen.append(reported_trials(trials)["cost_of_transport"].mean())
        flattered.append(trials.groupby("policy")["cost_of_transport"].mean().min())
    error = 0.1 / np.sqrt(5 * 200)
    assert np.mean(chosen) == pytest.approx(0.5, abs=4 * error)
    assert np.mean(flattered) < 0.5 - 4 * error
