"""Words and cells beside the paper follow the numbers."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hyperleg_design.evaluation import statistics
from hyperleg_design.report.page import Cell, Details, Table
from hyperleg_design.report.walks import beside_paper


@pytest.fixture(scope="module")
def rows(found):
    return beside_paper.rows_beside_paper(found)


def by_name(rows):
    return {row.printed.quantity: row for row in rows}


def test_tables_need_both_of_the_papers_robots(rows):
    assert list(rows) == ["Table III, walk"]  # the T-test has one of them only


def test_ten_percent_less_power_is_told(rows):
    power = by_name(rows["Table III, walk"])["total power"]
    assert power.difference.relative < -0.05
    assert power.toe.seeds == power.ablation.seeds == 3
    assert (
        power.toe_verdict == statistics.DIFFERS
    )  # a planned walk draws less than the paper's robot


def test_a_row_as_plain_numbers(rows):
    facts = [beside_paper.row_facts(row) for row in rows["Table III, walk"]]
    json.dumps(facts, allow_nan=False)
    power = facts[0]
    assert (power["toe"]["paper"], power["ablation"]["paper"]) == (260.2, 313.0)
    assert power["change"]["mean"] == pytest.approx(
        by_name(rows["Table III, walk"])["total power"].difference.relative
    )
    time = next(f for f in facts if f["quantity"] == "time to goal")
    assert (time["toe"]["missing"], time["ablation"]["missing"]) == (
        1,
        0,
    )  # a fallen walk has no time of arrival
    assert time["toe"]["trials"] == 8


def test_every_row_has_a_verdict_and_falls_are_not_dropped(rows):
    made = beside_paper.beside(rows["Table III, walk"], "Table III")
    table = made[0]
    assert isinstance(table, Table)
    assert len(table.rows) == 9
    assert all(row[-1] for row in table.rows)
    assert "3 and 3 seeds, 9 and 9 trials" in table.caption
    assert isinstance(made[1], Details)
    assert any("gave no value" in why for _, why in made[1].content[0].rows)


def test_what_is_told_about_the_toe(rows):
    text = beside_paper.toe_sentence(
        [r for r in rows["Table III, walk"] if r.printed.quantity == "total power"]
    )
    assert text.startswith(
        ("With the toe total power changes by -", "Cannot be told apart: total power")
    )


def test_few_seeds_say_nothing(rows):
    import dataclasses

    row = rows["Table III, walk"][0]
    few = dataclasses.replace(
        row, difference=dataclasses.replace(row.difference, verdict=statistics.TOO_FEW_SEEDS)
    )
    assert "tells nothing about the toe" in beside_paper.toe_sentence([few])


def test_differences_are_there_unpaired_and_paired(found):
    made = beside_paper.differences(found, "walk", "walk")
    (table,) = made.content
    power = next(row for row in table.rows if row[0] == "power")
    assert power[1] == "W"
    unpaired, paired = power[5], power[7]
    assert unpaired.split(" ")[0] == paired.split(" ")[0]  # the same mean
    assert power[8] == Cell(statistics.DIFFERS, "bad")  # seeds share their spread, so pairs see it


def test_numbers_that_are_not_there_are_dashes():
    nan = float("nan")
    assert beside_paper.interval(nan, nan, nan, "W") == "–"
    assert beside_paper.interval(1.23456, nan, nan, "W") == "1.23 W"
    assert beside_paper.interval(1234.5, 1000.2, 2000.4, "N") == "1234 [1000, 2000] N"
    assert beside_paper.percent(-0.1, -0.2, 0.05) == "-10.0 % [-20.0, +5.0]"
    assert beside_paper.percent(nan, nan, nan) == "–"
    assert beside_paper.short(statistics.estimate([[np.nan, np.nan]])) == "–"
