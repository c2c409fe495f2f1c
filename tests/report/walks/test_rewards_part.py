"""Both arms under several rewards: means over trainings, Welch's comparison, one term at a time."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from hyperleg_design.learning.campaigns.campaign import compared_groups
from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.compared import REWARDS
from hyperleg_design.report.walks.rewards_part import MEASURES, reward_rows, rewards
from hyperleg_design.simulation.tasks import load_task


@pytest.fixture
def trials() -> pd.DataFrame:
    """Four walks of each of three trainings, of two arms under two rewards."""
    rng = np.random.default_rng(5)
    rows = []
    for group in ("walk_free", "walk_clock"):
        for variant, mean in (("toe", 0.40), ("toe_removed_matched", 0.44)):
            for seed in range(3):
                own = mean + 0.02 * rng.standard_normal()
                for _ in range(4):
                    cost = own + 0.01 * rng.standard_normal()
                    rows.append((group, variant, seed, f"{group}-{variant}-{seed}", cost, 1.0))
    columns = ["group", "variant", "seed", "policy", "steady_cost_of_transport", "arrived"]
    return pd.DataFrame(rows, columns=columns)


def test_arms_are_compared_by_the_means_of_their_trainings(trials: pd.DataFrame) -> None:
    rows = reward_rows(trials)
    assert list(rows) == ["walk_free", "walk_clock"]
    for group, some in rows.items():
        assert [row.outcome.measure for row in some] == list(MEASURES)
        own = trials[trials["group"] == group]
        means = own.groupby(["variant", "seed"]).mean(numeric_only=True)
        x, y = (
            means.loc[arm, "steady_cost_of_transport"].to_numpy()
            for arm in ("toe", "toe_removed_matched")
        )
        row = some[0]
        assert row.active == pytest.approx(x.mean())
        assert row.change == pytest.approx(x.mean() / y.mean() - 1)
        assert row.trainings == (3, 3)
        found = stats.ttest_ind(x, y, equal_var=False)
        p_value = 2 * stats.t.sf(abs(found.statistic), np.floor(found.df))
        assert row.p_value == pytest.approx(p_value)
        assert not np.isfinite(some[MEASURES.index("cadence")].active)


def test_the_page_says_what_each_reward_adds_to_the_papers(trials: pd.DataFrame) -> None:
    compared, differing = (item for item in rewards(trials).content if isinstance(item, Table))
    assert len(compared.rows) == 2 * len(MEASURES)
    own = {row[0]: {r[1] for r in differing.rows if r[0] == row[0]} for row in differing.rows}
    assert {row[0] for row in compared.rows} <= set(own)
    plain = own["the paper's"]
    assert own["with contact match and clock"] - plain == {"clock", "contact match"}
    assert own["with another weight of power"] - plain == {"power"}
    assert own["with ground force"] - plain == {"ground force"}


def test_each_group_has_a_reward_of_its_own() -> None:
    tasks = compared_groups(REWARDS)
    assert set(tasks) == {"walk_free", "walk_clock", "walk_power", "walk_force"}
    assert {load_task(task).name for task in tasks.values()} == set(tasks)
