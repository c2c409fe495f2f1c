"""What the page says of walks: pictures, demands, speeds, Table III and the gait cycle."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.evaluation.believable import DEMANDS
from hyperleg_design.report.page import Cell, Missing, Picture, Table
from hyperleg_design.report.walks import walk_parts
from hyperleg_design.report.walks.evaluated import Evaluated
from tests.report.conftest import of_kind


def only(evaluated, design):
    """The policies of one design alone."""
    pairs = [
        (policy, evaluation)
        for policy, evaluation in zip(evaluated.policies, evaluated.evaluations, strict=True)
        if policy.design == design
    ]
    return dataclasses.replace(
        evaluated, policies=[p for p, _ in pairs], evaluations=[e for _, e in pairs]
    )


def test_walks_are_shown_and_demands_that_are_not_met_are_marked(found, draw):
    content = walk_parts.walks(found, draw).content
    names = [picture.file for picture in of_kind(content, Picture)]
    assert names == [
        "figures/gait_walk.png",
        "figures/walk_toe.gif",
        "figures/walk_toe_removed_matched.gif",
    ]
    (table,) = of_kind(content, Table)
    assert table.headers == ["demand", "range", "walk: toe", "walk: toe_removed_matched"]
    assert [row[0] for row in table.rows[:-1]] == [demand.why for demand in DEMANDS]
    falls = next(row for row in table.rows if row[0] == "no fall")
    assert falls[1:] == ["0 … 0", Cell(pytest.approx(1 / 9), "bad"), Cell(0.0, "good")]


def test_designs_that_the_paper_lacks_are_shown_by_one_cycle_only(found, draw):
    alone = only(found, "toe")
    other = dataclasses.replace(
        alone, policies=[dataclasses.replace(p, design="toe_passive") for p in alone.policies]
    )
    content = walk_parts.walks(other, draw).content
    assert [picture.file for picture in of_kind(content, Picture)] == ["figures/gait_walk.png"]


def test_walks_without_kept_signals_have_demands_and_no_pictures(found, draw):
    light = dataclasses.replace(found, evaluations=[e.light(0) for e in found.evaluations])
    content = walk_parts.walks(light, draw).content
    assert not of_kind(content, (Picture, Missing))
    (table,) = of_kind(content, Table)
    assert table == of_kind(walk_parts.walks(found, draw).content, Table)[0]


def test_cost_of_transport_is_drawn_over_speed_where_cadence_is_free(draw):
    rows = [
        {
            "condition": "speed",
            "level": level,
            "variant": design,
            "design": "hyperleg",
            "policy": f"{design}-{seed}",
            "seed": seed,
            "outcome": "arrived",
            "arrived": 1.0,
            "steady_cost_of_transport": 0.3 + 0.1 * abs(level - 1.2) + 0.01 * seed,
        }
        for level in (0.6, 1.33, 2.0)
        for design in ("toe", "toe_removed_matched")
        for seed in range(3)
    ]
    evaluated = Evaluated([], [], speeds={"walk_free": pd.DataFrame(rows)})
    (picture,) = of_kind(walk_parts.speeds(evaluated, draw).content, Picture)
    assert (draw.folder / picture.file).stat().st_size > 10_000
    assert "walk free" in picture.caption


def test_table_three_has_the_papers_numbers_our_means_and_both_changes(found, draw):
    """Our means are those over trainings of the walks that arrived."""
    (table,) = of_kind(walk_parts.table_three(found, draw).content[:3], Table)
    power = next(row for row in table.rows if row[0] == "total power [W]")
    means = [
        np.mean([e.values("power")[e.values("fell") == 0].mean() for e in found.of("walk", design)])
        for design in ("toe", "toe_removed_matched")
    ]
    assert (power[1], power[3], power[5]) == (260.2, 313.0, "-16.9 %")
    assert power[2].value.startswith(f"{means[0]:.0f} [")
    assert power[2].value.endswith("(1 missing)")
    assert power[4].value.startswith(f"{means[1]:.0f} [")
    change = float(power[6].value.split(" ")[0])
    assert change == pytest.approx(100 * (means[0] / means[1] - 1), abs=0.3)


def test_table_three_needs_both_of_the_papers_robots(found, draw):
    last = walk_parts.table_three(only(found, "toe"), draw).content[-1]
    assert last.startswith("Table III cannot be reproduced yet")


def test_the_gait_cycle_is_drawn_for_groups_with_a_robot_of_the_paper(found, draw):
    (picture,) = walk_parts.cycle(found, draw).content
    assert picture.file == "figures/cycle_walk.png"
    assert (draw.folder / picture.file).stat().st_size > 10_000
    other = dataclasses.replace(
        found, policies=[dataclasses.replace(p, design="toe_passive") for p in found.policies]
    )
    assert walk_parts.cycle(other, draw).content == []
