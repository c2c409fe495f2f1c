"""The planned analysis against independent implementations, and what it leaves out."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from hyperleg_design.evaluation.plans.analysis_plan import load_plan, plan_from_mapping
from hyperleg_design.evaluation.plans.planned_analysis import (
    DIFFERENT,
    EQUIVALENT,
    NOT_MEASURED,
    TOO_FEW,
    UNDECIDED,
    planned_analysis,
    training_means,
    welch,
)


def plan(secondary=("cadence", "steady_joule_power"), level=0.05):
    return plan_from_mapping(
        {
            "name": "small",
            "arms": {"active": "toe", "compared": "toe_removed_matched"},
            "attribution": ["toe_locked"],
            "seeds": {"walk": 3, "t_test": 3},
            "level": level,
            "power": 0.8,
            "primary": [
                {
                    "protocol": "walk",
                    "measure": "steady_cost_of_transport",
                    "margin": 0.05,
                    "trials": "all",
                },
                {"protocol": "t_test", "measure": "time", "margin": 0.03, "trials": "arrived"},
            ],
            "secondary": [{"protocol": "walk", "measure": m, "trials": "all"} for m in secondary],
        },
        "plan.yaml",
    )


def trials(columns, outcome="arrived"):
    """A table with two trials a training around the given means."""
    rows = []
    for variant, values in columns.items():
        for seed, means in enumerate(values):
            rows += [
                {
                    "policy": f"{variant}-{seed}",
                    "variant": variant,
                    "seed": seed,
                    "outcome": outcome,
                    **{name: mean * spread for name, mean in means.items()},
                }
                for spread in (0.99, 1.01)
            ]
    return pd.DataFrame(rows)


def arms(name, first, second):
    return {
        "toe": [{name: v} for v in first],
        "toe_removed_matched": [{name: v} for v in second],
    }


def test_a_row_is_welchs_t_test_on_the_trainings_means():
    first, second = [0.30, 0.32, 0.29, 0.31], [0.36, 0.35, 0.39]
    table = trials(arms("steady_cost_of_transport", first, second))
    row = planned_analysis(plan(), {"walk": table})[0]
    expected = stats.ttest_ind(first, second, equal_var=False)
    base = np.mean(second)
    assert row.change == pytest.approx(np.mean(first) / base - 1)
    mean, error, freedom = welch(first, second)
    assert mean / error == pytest.approx(expected.statistic)
    assert freedom == int(expected.df)  # rounded down, so p is a little larger
    assert row.p_value == pytest.approx(2 * stats.t.sf(abs(mean / error), freedom))
    reach = stats.t.ppf(0.975, freedom) * error / base
    assert (row.low, row.high) == pytest.approx((row.change - reach, row.change + reach))
    assert (row.verdict, row.trainings) == (DIFFERENT, (4, 3))


def test_an_arm_like_the_other_is_equivalent_or_undecided_by_its_spread():
    close, wide = [0.300, 0.301, 0.299, 0.300], [0.20, 0.40, 0.25, 0.35]
    for values, verdict in ((close, EQUIVALENT), (wide, UNDECIDED)):
        table = trials(arms("steady_cost_of_transport", values, values[::-1]))
        row = planned_analysis(plan(), {"walk": table})[0]
        assert row.verdict == verdict
        assert row.detectable > 0


def test_only_arrivals_count_where_the_plan_says_so():
    table = trials(arms("time", [16.0, 17.0, 18.0], [16.5, 17.5, 18.5]))
    table.loc[0, ["outcome", "time"]] = ["fell", 3.0]
    means, missing = training_means(table, "toe", "time", "arrived")
    assert (means[0], missing) == (pytest.approx(16.16), 1)
    assert training_means(table, "toe", "time", "all")[0][0] == pytest.approx((3.0 + 16.16) / 2)
    rows = planned_analysis(plan(), {"t_test": table})
    assert rows[1].missing == (1, 0)
    assert rows[0].verdict == NOT_MEASURED


def test_secondary_outcomes_are_corrected_together_and_missing_ones_count():
    rng = np.random.default_rng(0)
    first, second = 2.0 + 0.05 * rng.normal(size=4), 2.2 + 0.05 * rng.normal(size=4)
    table = trials(arms("cadence", first, second))
    rows = planned_analysis(plan(("cadence", "steady_joule_power")), {"walk": table})
    cadence, joule = rows[2:]
    assert cadence.corrected == pytest.approx(2 * cadence.p_value)
    assert cadence.p_value < cadence.corrected < 0.05
    assert cadence.verdict == DIFFERENT
    assert joule.verdict == NOT_MEASURED
    single = planned_analysis(plan(("cadence",)), {"walk": table})[2]
    assert single.corrected == pytest.approx(single.p_value)
    assert single.detectable < cadence.detectable


def test_two_trainings_are_too_few():
    table = trials(arms("steady_cost_of_transport", [0.30, 0.31], [0.40, 0.41]))
    assert planned_analysis(plan(), {"walk": table})[0].verdict == TOO_FEW


def test_late_policies_of_a_training_are_one_observation():
    table = trials(arms("steady_cost_of_transport", [0.3, 0.4, 0.5], [0.3, 0.4, 0.5]))
    late = table[table["seed"] == 0].assign(
        policy=lambda part: part["policy"] + "-late", steady_cost_of_transport=0.5
    )
    means, _ = training_means(pd.concat([table, late]), "toe", "steady_cost_of_transport", "all")
    assert means == pytest.approx([0.4, 0.4, 0.5])


def test_the_shipped_plan_gives_a_row_an_outcome_without_any_trial():
    shipped = load_plan()
    rows = planned_analysis(shipped, {})
    assert len(rows) == len(shipped.primary) + len(shipped.secondary)
    assert {row.verdict for row in rows} == {NOT_MEASURED}
