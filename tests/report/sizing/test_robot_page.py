from __future__ import annotations

import json

import pytest

from hyperleg_design.errors import OutputError
from hyperleg_design.report.sizing import robot_page
from hyperleg_design.report.sizing.robot_page import parameters_content, write_robot_page
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sizing.analysis import analyze
from tests.robot.tree_files import leg


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(robot_page.picture, "render", lambda scene, path: path.write_bytes(b"png"))


@pytest.mark.parametrize(
    "name",
    [
        "hyperleg",
        "toe_removed",
        "mini_cheetah",
        pytest.param("parallel_ankle", marks=pytest.mark.slow),
    ],
)
def test_a_page_states_the_analysis_of_any_robot(name, tmp_path):
    design = load_robot(name)
    page = write_robot_page(design, tmp_path / "page")
    analysis = json.loads((page.parent / "analysis.json").read_text())
    assert analysis == json.loads(json.dumps(analyze(design)))
    html = page.read_text()
    assert f"{analysis['total_mass']:.2f} kg" in html
    for part in (*analysis["joints"], *analysis["motors"]):
        assert part in html


def test_pages_of_others_are_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(OutputError):
        write_robot_page(leg(), tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


def test_every_parameter_is_listed_with_its_label():
    design = leg()
    sentence, details = parameters_content(design)
    (table,) = details.content
    assert [row[0] for row in table.rows] == list(design.rules)
    assert f"{len(design.rules)} parameters" in sentence
