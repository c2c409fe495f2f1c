"""The table of all arms holds the mean of every training, and an interval only over several."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.report.page import Table
from hyperleg_design.report.walks.arms_part import arms


def only_table(evaluated, group):
    tables = [item for item in arms(evaluated).content if isinstance(item, Table)]
    (table,) = [table for table in tables if table.caption.startswith(group)]
    return table


def test_every_arm_of_the_t_test_is_there_with_its_interval_over_trainings(courses):
    table = only_table(courses, "t test free")
    assert table.headers == ["measure", "unit", "toe", "toe removed matched", "toe locked"]
    assert "toe: seeds 0, 1, 12 trials" in table.caption
    cells = dict(zip(table.headers, next(r for r in table.rows if r[0] == "time"), strict=True))
    assert cells["unit"] == "s"
    for design in ("toe", "toe_locked", "toe_removed_matched"):
        runs = courses.of("t_test_free", design)
        mean = np.mean([run.values("time").mean() for run in runs])
        text = cells[design.replace("_", " ")]
        assert float(text.split(" ")[0]) == pytest.approx(mean, rel=5e-3)
        low, high = (float(end) for end in text.split("[")[1].rstrip("]").split(", "))
        assert low < mean < high


def test_a_single_training_has_no_interval(found):
    table = only_table(found, "t test")
    assert table.headers[2:] == ["toe"]
    assert not any("[" in row[2] for row in table.rows)
    assert [row[2] for row in table.rows if row[0] == "arrived"] == ["100"]


def test_falls_count_among_arrivals_and_are_left_out_of_times(found):
    table = only_table(found, "walk")
    arrived, time = (next(r for r in table.rows if r[0] == name) for name in ("arrived", "time"))
    assert arrived[2].startswith("88.9 [")  # 8 of 9
    assert time[2].endswith("(1 missing)")
    assert arrived[3].startswith("100 [")
    assert not time[3].endswith("missing)")


def test_without_t_tests_there_are_walks_only(found):
    walks = dataclasses.replace(
        found, policies=found.policies[:-1], evaluations=found.evaluations[:-1]
    )
    assert [type(item) for item in arms(walks).content] == [str, Table]
