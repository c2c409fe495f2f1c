"""Printed numbers inside our intervals agree, others differ, what was not measured cannot be
reproduced.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures, paper
from hyperleg_design.evaluation.statistics import AGREES, DIFFERS, NOT_TOLD_APART, TOO_FEW_SEEDS
from hyperleg_design.evaluation.versus_paper import NOT_REPRODUCED, paper_rows

ITEM = paper.Printed("Table X", "time", "s", 10.0, 12.0, "time", "nothing is stated")


def table(toe, ablation, seeds=5, spread=0.1):
    rng = np.random.default_rng(0)
    rows = [
        {
            "variant": variant,
            "policy": f"{variant}_{seed}",
            "seed": seed,
            "time": mean + spread * rng.normal(),
            "outcome": "arrived",
        }
        for variant, mean in (("toe", toe), ("toe_removed_matched", ablation))
        for seed in range(seeds)
        for _ in range(10)
    ]
    return pd.DataFrame(rows)


def test_what_lies_in_the_interval_agrees():
    (row,) = paper_rows(table(10.0, 12.0), [ITEM])
    assert (row.toe_verdict, row.ablation_verdict, row.change_verdict, row.why) == (
        AGREES,
        AGREES,
        AGREES,
        "",
    )
    assert row.difference.verdict == DIFFERS
    assert row.difference.relative == pytest.approx(ITEM.change, abs=0.01)


def test_what_lies_outside_differs_and_says_what_is_open():
    (row,) = paper_rows(table(10.0, 10.0), [ITEM])
    assert (row.toe_verdict, row.ablation_verdict, row.change_verdict) == (AGREES, DIFFERS, DIFFERS)
    assert row.difference.verdict == NOT_TOLD_APART
    assert row.why == "nothing is stated"


def test_one_seed_says_nothing():
    (row,) = paper_rows(table(10.0, 12.0, seeds=1), [ITEM])
    assert {row.toe_verdict, row.ablation_verdict, row.change_verdict} == {TOO_FEW_SEEDS}


def test_what_was_not_measured_cannot_be_reproduced():
    rows = table(10.0, 12.0)
    rows.loc[rows["variant"] == "toe", "time"] = np.nan
    (row,) = paper_rows(rows, [ITEM])
    assert (row.toe_verdict, row.change_verdict) == (NOT_REPRODUCED, NOT_REPRODUCED)
    assert "50 of 50 trials of toe gave no value" in row.why


def test_what_a_fall_measures_does_not_count():
    rows = table(10.0, 12.0)
    fallen = (rows["variant"] == "toe") & (rows.index % 10 < 3)
    rows.loc[fallen, ["time", "outcome"]] = [99.0, "fell"]
    (row,) = paper_rows(rows, [ITEM])
    assert row.toe.mean == pytest.approx(10.0, abs=0.1)
    assert row.why == "15 of 50 trials of toe gave no value"


def test_a_missing_variant_is_told():
    with pytest.raises(InputError, match="has no trials"):
        paper_rows(table(1.0, 2.0), [ITEM], ("toe", "toe_locked"))


def test_every_printed_number_has_a_measure():
    for item in (*paper.TABLE_THREE, *paper.RIGHT_LEG_POWER):
        assert item.measure in measures.WALK
    for item in paper.TABLE_FOUR:
        assert item.measure in measures.T_TEST
