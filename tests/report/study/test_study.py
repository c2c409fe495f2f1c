"""The study as a whole: every part is there, every figure it names exists, nothing is left
undrawn.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from hyperleg_design.errors import HyperlegError, OutputError
from hyperleg_design.report.study import study
from hyperleg_design.sweep.trials.stored import stored_names


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    empty = tmp_path_factory.mktemp("policies")  # trained ones are evaluated in test_paper_page
    return study.run_study(tmp_path_factory.mktemp("study") / "out", policies=empty, progress=False)


def test_every_part_is_on_the_page(page):
    html = page.read_text()
    assert html.count("<h2 ") == len(study.STEPS)
    for word in (
        "32.00 kg",
        "13.0 %",
        "212 → 166 Nm",
        "75.9 Nm",
        "Cassie",
        "RI70",
        "toe_removed_matched",
        "holds no finished one",
        "Nothing of them was run again for this page",
    ):
        assert word in html


def test_every_picture_exists_and_has_words(page):
    html = page.read_text()
    named = re.findall(r'<img(?: class="chart")? src="([^"]+)" alt="([^"]+)"', html)
    assert len(named) >= 15
    for file, caption in named:
        assert (page.parent / file).stat().st_size > 2000
        assert len(caption) > 20


def test_what_could_not_be_drawn_is_said(page):
    missing = re.findall(r'class="missing"><b>Not drawn:</b>([^<]+)<', page.read_text())
    assert all("OpenGL" in reason for reason in missing), missing


def test_tables_stand_beside_the_page(page):
    analysis = json.loads((page.parent / "analysis.json").read_text())
    assert analysis["total_mass"] == pytest.approx(32.0)
    demand = json.loads((page.parent / "demand.json").read_text())
    assert set(demand) == {"walk", "stair", "squat", "hop"}
    swept = {table.parent.name for table in (page.parent / "sweeps").glob("*/designs.parquet")}
    sized = {"combined", "laws", "motors", "reduction_ratios", "toe_mass"}
    assert swept == sized | set(stored_names())


def test_a_foreign_folder_is_refused_before_any_work(tmp_path, monkeypatch):
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(OutputError):
        study.run_study(tmp_path, progress=False)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.txt"]


def test_an_error_in_a_part_leaves_nothing_behind(tmp_path, monkeypatch):
    def fails(context: object) -> object:
        raise HyperlegError("broken part")

    monkeypatch.setattr(study, "STEPS", {"broken": fails})
    with pytest.raises(HyperlegError, match="broken part"):
        study.run_study(tmp_path / "out", progress=False)
    assert not list(tmp_path.iterdir())
