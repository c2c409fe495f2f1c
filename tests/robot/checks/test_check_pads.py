"""Feet that hang in the air in the default posture are named with their heights."""

from __future__ import annotations

import pytest
import yaml

from hyperleg_design.report.tree_text import tree_analysis_text
from hyperleg_design.robot.check import check_file
from hyperleg_design.robot.checks.check_pads import check_pads, hanging_pads
from hyperleg_design.robot.load import load_robot
from hyperleg_design.sizing.analysis import analyze
from tests.robot.tree_files import SHIPPED, leg, leg_file

RAISED = {"left": {}, "right": {"mirror": True, "position": [0, 0, 0.02]}}


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_robots_stand_on_all_their_pads(name):
    design = load_robot(name)
    assert check_pads(design) == []
    assert analyze(design)["hanging_pads"] == {}


def test_a_limb_that_is_mounted_higher_hangs_by_as_much():
    design = leg(limbs=RAISED)
    assert hanging_pads(design) == {"right_foot": pytest.approx(0.02)}
    (finding,) = check_pads(design)
    assert (finding.severity, finding.place) == ("warning", "pads")
    assert "right_foot 20 mm" in finding.message
    analysis = analyze(design)
    assert analysis["hanging_pads"] == {"right_foot": pytest.approx(0.02)}
    assert "right_foot 20 mm; these forces" in tree_analysis_text(analysis)


def test_pads_on_a_foot_that_is_tilted_hang_by_the_sine_of_its_angle():
    pads = {
        "heel": {"link": "shank", "position": [-0.1, 0, -0.2], "radius": 0.02},
        "toe": {"link": "shank", "position": [0.1, 0, -0.2], "radius": 0.02},
    }
    joints = leg_file()["joints"]
    assert hanging_pads(leg(pads=pads)) == {}
    joints["hip"]["default_deg"] = 30
    assert hanging_pads(leg(pads=pads, joints=joints)) == {"heel": pytest.approx(0.1)}


def test_pads_of_other_radii_and_pads_of_the_trunk_do_not_hang():
    pads = {
        "foot": {"link": "shank", "position": [0, 0, -0.2], "radius": 0.02},
        "large": {"link": "shank", "position": [0, 0.1, -0.17], "radius": 0.05},
        "belly": {"link": "base", "position": [0, 0, -0.1], "radius": 0.02},
    }
    assert hanging_pads(leg(pads=pads)) == {}


def test_check_warns_of_a_file(tmp_path):
    path = tmp_path / "raised.yaml"
    path.write_text(yaml.safe_dump(leg_file(name="raised", limbs=RAISED)))
    (finding,) = (f for f in check_file(path) if f.place == "pads")
    assert "right_foot 20 mm" in finding.message
