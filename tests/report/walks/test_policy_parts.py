"""What the page says of evaluated policies."""

from __future__ import annotations

import dataclasses

import pytest

from hyperleg_design.evaluation.plans.analysis_plan import load_plan
from hyperleg_design.report.drawer import FIGURES, Drawer
from hyperleg_design.report.page import Cell, Details, Missing, Picture, Table
from hyperleg_design.report.pictures import gif
from hyperleg_design.report.walks import policy_parts as study_policies
from hyperleg_design.writing import write_bytes
from tests.report.conftest import flat


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
