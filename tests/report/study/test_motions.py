"""What the study says of pushing and moving follows the numbers, also where they turn out
otherwise.
"""

from __future__ import annotations

import json

import pytest

from hyperleg_design.report.drawer import FIGURES
from hyperleg_design.report.page import Table
from hyperleg_design.report.study import motions as study_motion
from hyperleg_design.report.study.context import Context
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import capability


def context_of(design, folder):
    (folder / FIGURES).mkdir()
    return Context(design, variants(design), folder)


@pytest.mark.slow
def test_the_weak_toe_is_told_from_its_numbers(tmp_path):
    made = study_motion.capability(context_of(load_design("hyperleg"), tmp_path))
    rows = json.loads((tmp_path / "capability.json").read_text())
    forces = {
        r["design"]: r["force"]
        for r in rows
        if r["posture"] == "toe_off" and r["direction"] == "vertical"
    }
    assert forces["toe"] < forces["toe_locked"]
    texts = [t for t in made.section.content if isinstance(t, str)]
    assert any("weak link" in t and f"{forces['toe']:.0f} N" in t for t in texts)


def test_a_stronger_toe_is_not_called_weak(tmp_path, monkeypatch):
    real = capability.capability_table

    def stronger(*arguments, **options):
        rows = real(*arguments, **options)
        return [{**r, "force": 2 * r["force"]} if r["design"] == "toe" else r for r in rows]

    monkeypatch.setattr(capability, "capability_table", stronger)
    made = study_motion.capability(context_of(load_design("hyperleg"), tmp_path))
    texts = [t for t in made.section.content if isinstance(t, str)]
    assert not any("weak link" in t for t in texts)
    assert any("costs no force" in t for t in texts)


@pytest.fixture(scope="module")
def demand(tmp_path_factory):
    folder = tmp_path_factory.mktemp("demand")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_motion, "MOTIONS", ("walk", "squat"))  # the study's own test has all
        return study_motion.demand(context_of(load_design("hyperleg"), folder)), folder


def test_the_table_holds_every_variant_in_every_motion(demand):
    made, folder = demand
    found = json.loads((folder / "demand.json").read_text())
    table = next(c for c in made.section.content if isinstance(c, Table))
    assert len(table.rows) == sum(len(v) for v in found.values()) == 8
    for row in table.rows:
        assert row[4] == pytest.approx(row[2] + row[3])  # motors = Joule + mechanical


def test_the_headline_is_the_walks_cost(demand):
    made, folder = demand
    walk = json.loads((folder / "demand.json").read_text())["walk"]
    assert (
        made.facts[0][0] == f"{walk['toe']['cost_of_transport']:.3f} / "
        f"{walk['toe_removed_matched']['cost_of_transport']:.3f}"
    )
