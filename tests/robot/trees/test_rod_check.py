"""Damaged rods are refused by the field that is wrong, before their kinematics is solved."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.trees.rod_check import spanned
from tests.robot.tree_files import leg

ROD = {
    "carrier": "thigh",
    "end": "shank",
    "axis": [0, 1, 0],
    "crank_axis": [0, 0, -0.05],
    "crank_end": [-0.04, 0, -0.05],
    "rod_end": [-0.04, 0, 0],
}


def with_rod(**fields):
    """A leg whose knee, at 0.2 m below the hip, a rod along the thigh drives."""
    return leg(rods={"knee": ROD | fields})


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"rod_end": [0, 0, 0]}, "rod_end = [0.0, 0.0, 0.0]: lies on the axis of knee"),
        ({"rod_end": [0, 0.1, 0]}, "rod_end = [0.0, 0.1, 0.0]: lies on the axis of knee"),
        ({"crank_end": [0, 0, -0.05]}, "crank_end = [0.0, 0.0, -0.05]: lies on the crank's axis"),
        ({"crank_end": [0, 0.1, -0.05]}, "crank_end = [0.0, 0.1, -0.05]: lies on the crank's axis"),
        ({"crank_end": [-0.04, 0, -0.2]}, "rod_end = [-0.04, 0.0, 0.0]: is the place of crank_end"),
        (
            {"crank_end": [0, 0, -0.1], "rod_end": [0, 0, -0.1]},
            "crank_end = [0.0, 0.0, -0.1]: is in",
        ),
        ({"axis": [0, 0, 1]}, "axis = [0.0, 0.0, 1.0]: is not across crank and rod"),
        ({"axis": [1, 0, 0]}, "crank_end = [-0.04, 0.0, -0.05]: lies on the crank's axis"),
        (
            {"end": "thigh"},
            "end = 'thigh': no joint moves it against the carrier thigh; the links ",
        ),
        ({"end": "base"}, "the links behind joints of thigh are shank"),
        ({"carrier": "shank"}, "no joint lies behind the carrier shank"),
    ],
)
def test_the_field_that_is_wrong_is_named(fields, words):
    with pytest.raises(InputError) as caught:
        with_rod(**fields)
    assert "leg.yaml: rods.knee." in str(caught.value)
    assert words in str(caught.value)


def test_a_rod_that_points_at_its_joint_does_not_turn_it():
    """The knee lies on the line from crank_end to rod_end, 0.2 m below the hip."""
    with pytest.raises(
        InputError, match=r"rods\.knee: does not turn the joint knee in the default"
    ):
        with_rod(rod_end=[0.02, 0, -0.075])


def test_a_batch_is_refused_by_the_design_that_is_wrong():
    ends = np.array([[-0.04, 0, 0], [0, 0, 0], [-0.05, 0, 0]])
    with pytest.raises(InputError, match=r"rod_end = \[0\.0, 0\.0, 0\.0\]: lies on") as caught:
        with_rod().with_values({"rods.knee.rod_end": ends})
    assert list(caught.value.bad) == [False, True, False]


def test_good_rods_pass_and_span_the_joints_between_their_links():
    assert spanned(with_rod(), "knee") == ["knee"]
    design = load_robot("parallel_ankle")
    for motor in design.rod_sections:
        assert spanned(design, motor) == ["ankle_pitch", "ankle_roll"]
