"""The page of a written-out robot: whose forces, which linkages, and one reason for no force."""

from __future__ import annotations

import pytest

from hyperleg_design.report.tree_text import MOST_LINKS, tree_analysis_text
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.mass.mass_rows import mass_rows
from hyperleg_design.sizing.analysis import analyze
from tests.robot.tree_files import bolted_file, leg, leg_file


def test_a_robot_with_limbs_speaks_of_one_limb_and_gives_reductions_of_its_rods():
    text = tree_analysis_text(analyze(load_robot("parallel_ankle")))
    assert text.startswith("parallel_ankle (limbs: left, right): 60.00 kg, limb 9.66 kg")
    assert "largest vertical force of one limb" in text
    assert "rod of motor ankle_inner: reduction -26.82 .. -10.83 to ankle_roll" in text


def test_a_robot_that_is_described_as_a_whole_has_no_limbs():
    text = tree_analysis_text(analyze(leg()))
    assert text.startswith("leg (described as a whole): 3.00 kg, all but the trunk 2.00 kg")
    assert "limb" not in text
    assert "rod" not in text


def test_all_but_the_trunk_is_all_that_moves_against_an_empty_root():
    design = leg(**bolted_file())
    analysis = analyze(design)
    assert analysis["limb_mass"] == pytest.approx(2.0)
    assert "7.10 kg, all but the trunk 2.00 kg" in tree_analysis_text(analysis)
    (row,) = (row for row in mass_rows(design) if row.kind == "limb")
    assert row.mass == pytest.approx(2.0)
    links = [row for row in mass_rows(design) if row.kind == "link"]
    assert sum(row.count * row.mass for row in links) == pytest.approx(7.100001)


def test_without_pads_the_reason_stands_once():
    text = tree_analysis_text(analyze(leg(pads={})))
    assert text.count("has no pads") == 1


def test_without_pads_a_floating_robot_has_no_standing_height():
    trunk = {"link": "base", "motion": "floating"}
    text = tree_analysis_text(analyze(leg(pads={}, trunk=trunk)))
    assert "standing height unknown without pads" in text


def test_of_many_links_the_heaviest_are_listed_and_the_rest_summed():
    frames = {f"frame_{i}": {"mass": 0.01, "gyration": [0.1] * 3} for i in range(30)}
    bolts = {name: {"parent": "base", "child": name, "type": "fixed"} for name in frames}
    whole = leg_file()
    many = leg(links=whole["links"] | frames, joints=whole["joints"] | bolts)
    (line,) = [x for x in tree_analysis_text(analyze(many)).splitlines() if x.startswith("links")]
    masses = [float(entry.split()[-1]) for entry in line.removeprefix("links [kg]: ").split(", ")]
    assert len(masses) == MOST_LINKS + 1
    assert "13 lighter ones 0.13" in line
    assert sum(masses) == pytest.approx(3.3, rel=1e-3)
