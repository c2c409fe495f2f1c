"""What the page says of evaluated policies."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest

from hyperleg_design.evaluation.plans.analysis_plan import load_plan
from hyperleg_design.report.drawer import FIGURES, Drawer
from hyperleg_design.report.page import Cell, Details, Missing, Picture, Table
from hyperleg_design.report.pictures import gif
from hyperleg_design.report.walks import policy_parts as study_policies
from hyperleg_design.report.walks import walk_parts
from hyperleg_design.report.walks.evaluated import Evaluated
from hyperleg_design.writing import write_bytes


@pytest.fixture(scope="module")
def parts(found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    (folder / FIGURES).mkdir()
    with pytest.MonkeyPatch.context() as patch:  # animations are drawn in test_gif
        patch.setattr(gif, "render_gif", lambda made, path: write_bytes(path, b"GIF89a"))
        patch.setattr(
            "hyperleg_design.report.pictures.picture.render",
            lambda scene, path: write_bytes(path, b"PNG"),
        )
        made = study_policies.parts(found, Drawer(folder))
    return folder, {part.title: list(part.content) for part in made}


def flat(content):
    for item in content:
        if isinstance(item, list):
            yield from flat(item)
        else:
            yield item


def test_every_part_is_there_and_every_figure_drawn(parts):
    folder, content = parts
    assert len(content) == 11
    pictures = [
        item for some in content.values() for item in flat(some) if isinstance(item, Picture)
    ]
    assert len(pictures) >= 12
    assert all((folder / picture.file).stat().st_size for picture in pictures)
    assert not [
        item for some in content.values() for item in flat(some) if isinstance(item, Missing)
    ]


def test_the_plan_gets_a_row_an_outcome_and_says_how_few_trainings_there_are(parts):
    content = list(flat(parts[1]["What the analysis plan says"]))
    primary, secondary = (item for item in content if isinstance(item, Table))
    plan = load_plan()
    assert (len(primary.rows), len(secondary.rows)) == (len(plan.primary), len(plan.secondary))
    assert primary.rows[0][0] == "walk: steady cost of transport"
    assert primary.rows[0][10] == "3, 3"
    assert "3 of 8 trainings" in " ".join(item for item in content if isinstance(item, str))
    time = next(row for row in primary.rows if row[0] == "t-test: time")
    assert time[6] == Cell("not measured", "note")


def test_seeds_falls_and_missing_trainings_are_stated(parts):
    what = parts[1]["What was evaluated"]
    assert what[0].startswith("7 policies of 7 trainings")
    toe = next(row for row in what[1].rows if row[:2] == ["walk", "toe"])
    assert toe[2:6] == ["0, 1, 2", 3, 9, Cell(1, "bad")]
    assert "walk_upright-toe-3..4, t_test-toe_removed_matched-0" in what[2]
    assert isinstance(what[3], Details)
    assert ["walk", "clock", "gait clock"] in what[3].content[0].rows


def test_demands_that_are_not_met_are_marked(parts):
    (table,) = (
        item for item in parts[1]["Walks that a person would believe"] if isinstance(item, Table)
    )
    falls = next(row for row in table.rows if row[0] == "no fall")
    assert falls[2:] == [Cell(pytest.approx(1 / 9), "bad"), Cell(0.0, "good")]


def test_a_table_that_lacks_a_robot_is_not_reproduced_and_says_so(parts):
    assert any(
        "cannot be reproduced yet" in item
        for item in parts[1]["Table IV: the T-test, beside the paper"]
        if isinstance(item, str)
    )


def test_the_time_of_a_t_test_is_broken_down(parts, found):
    tables = [
        item
        for item in flat(parts[1]["Table IV: the T-test, beside the paper"])
        if isinstance(item, Table) and item.headers[0] == "stretch"
    ]
    (table,) = tables
    assert [row[0] for row in table.rows][:2] == ["A to B", "turn at B (1)"]
    (run,) = found.of("t_test", "toe")
    total = sum(float(row[1]) for row in table.rows)
    assert total == pytest.approx(np.mean(run.end_times), abs=0.2)
    assert "16.06 s" in table.caption


def test_cost_of_transport_is_drawn_over_speed_where_cadence_is_free(tmp_path):
    (tmp_path / FIGURES).mkdir()
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
    found = Evaluated([], [], speeds={"walk_free": pd.DataFrame(rows)})
    part = walk_parts.speeds(found, Drawer(tmp_path))
    (picture,) = (item for item in part.content if isinstance(item, Picture))
    assert (tmp_path / picture.file).stat().st_size > 10_000
    assert "walk free" in picture.caption


def test_the_pad_behind_the_contact_is_stated(parts):
    content = parts[1]["Impacts over the stiffness of the sole"]
    assert "12 mm of a soft sole on 9.0 cm²" in content[0]
    stiff, own = content[1].rows
    assert stiff[1] == pytest.approx(4 * own[1])
    assert own[0] == "20 ms (all else here)"


def test_one_policy_is_enough_for_a_page(found, tmp_path):
    (tmp_path / FIGURES).mkdir()
    alone = dataclasses.replace(
        found, policies=found.policies[-1:], evaluations=[found.evaluations[-1].light(0)], band={}
    )
    made = {
        part.title: list(part.content) for part in study_policies.parts(alone, Drawer(tmp_path))
    }
    assert "Table III: walking, beside the paper" not in made
    assert made["What was evaluated"][0].startswith("1 policies of 1 trainings")
