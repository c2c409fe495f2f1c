from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.held_out import check_held_out, compared, held_out_designs
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Steady, TTestProtocol, WalkProtocol
from hyperleg_design.evaluation.training_fit import training_fit
from hyperleg_design.simulation.design_observation import DesignRanges, Range
from hyperleg_design.simulation.design_spread import (
    DesignSpread,
    design_spread,
    load_design_spread,
)

CONDITIONED = sorted((resources.content_folder("sim") / "conditioned").glob("*-[0-9]"))


def rows(cost: list[float], fell: list[int]) -> pd.DataFrame:
    return pd.DataFrame({"cost_of_transport": cost, "fell": fell, "trials": 10})


def test_ratio_ranks_and_falls_by_hand() -> None:
    nan = float("nan")
    first = rows([0.4, 0.6, 0.5, nan, 0.9], [0, 1, 0, 10, 0])
    other = rows([0.4, 0.5, 0.25, 0.3, nan], [0, 0, 0, 2, 10])
    found = compared(first, other)
    assert found["designs"] == 3
    assert found["cost_ratio"] == pytest.approx(1.2)
    # ranks 1 3 2 and 2 3 1: 1 - 6 (1 + 0 + 1) / (3 (9 - 1))
    assert found["rank_correlation"] == pytest.approx(0.5)
    assert found["more_falls"] == pytest.approx((11 - 12) / 50)


def test_t_tests_are_ranked_by_their_times() -> None:
    first = rows([0.4, 0.5, 0.6], [0, 0, 1]).assign(time=[16.0, 18.0, 20.0])
    other = rows([0.5, 0.5, 0.5], [0, 0, 0]).assign(time=[16.0, 15.0, 10.0])
    found = compared(first, other.set_axis([3, 4, 5]))
    assert found["time_ratio"] == pytest.approx(1.2)
    assert found["cost_ratio"] == pytest.approx(1.0)
    assert found["rank_correlation"] == pytest.approx(-1.0)


def test_one_common_design_gives_no_numbers() -> None:
    found = compared(rows([0.4, np.nan], [0, 0]), rows([0.4, 0.5], [0, 0]))
    assert np.isnan(found["cost_ratio"])
    assert np.isnan(found["rank_correlation"])


def test_policies_are_compared_on_the_same_designs() -> None:
    spread = DesignSpread(
        ranges=DesignRanges({"toe.mass": Range(0.1, 0.4)}), pool=4, held_out=2, held_out_seed=9
    )
    short = WalkProtocol(trials=2, distance=0.5, time_limit=1.0, steady=Steady(begin=0.1, end=0.5))
    policies = ["walk_upright-toe-0", "walk_upright-toe-1"]
    check = check_held_out(policies, held_out_designs(policies, spread), short, threads=1)
    assert set(check.rows["design"]) == {0, 1}
    assert set(check.rows["trained"]) == {"zero-shot"}
    assert set(check.rows["trials"]) == {2}
    (row,) = check.comparisons.to_dict("records")
    assert (row["policy"], row["against"]) == tuple(policies)
    falls = (
        check.rows.groupby("policy")["fell"].sum() / check.rows.groupby("policy")["trials"].sum()
    )
    assert row["more_falls"] == falls[row["policy"]] - falls[row["against"]]
    np.testing.assert_array_less(check.rows["toe.mass"], 0.4)


def test_t_tests_report_times_and_deviations() -> None:
    spread = DesignSpread(
        ranges=DesignRanges({"toe.mass": Range(0.1, 0.4)}), pool=4, held_out=2, held_out_seed=9
    )
    ahead = {"A": (0.0, 0.0), "B": (1.5, 0.0)}
    near = TTestProtocol(trials=1, points=ahead, order=("A", "B"), time_limit=5.0)
    check = check_held_out(
        ["t_test_free-toe-0"], held_out_designs(["t_test_free-toe-0"], spread), near, threads=1
    )
    assert check.rows["arrived"].tolist() == [1, 1]
    assert (check.rows["time"] < 5).all()
    assert (check.rows["mean_deviation"] < 0.8).all()
    assert "steady_speed" not in check.rows


@pytest.mark.parametrize("policies", [[], ["runs/{}/policy.onnx"]])
def test_needs_a_policy_for_all_designs(policies: list[str]) -> None:
    with pytest.raises(InputError, match="one policy for all"):
        held_out_designs(policies, "toe")


@pytest.mark.parametrize("training", CONDITIONED, ids=lambda training: training.name)
def test_a_shipped_conditioned_policy_was_not_trained_on_held_out_designs(training: Path) -> None:
    policy = load_policy(training / "policy.onnx")
    spread = load_design_spread("toe" if policy.design.variant == "toe" else "no_toe")
    trained = design_spread(policy.metadata["designs"], "policy")
    assert dataclasses.replace(trained, variants=spread.variants) == spread
    held_out = spread.held_out_designs(policy.design)
    pool = spread.designs(policy.design)
    for i in range(spread.held_out):
        assert training_fit(policy, held_out.take(i)).kind == "conditioned"
    assert not np.isin(held_out["toe.mass"], pool["toe.mass"]).any()
