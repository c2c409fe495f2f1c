"""Linkages over the ranges of their joints: parallelograms, dead centres, and rods that are too
short.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.check import _rod_findings
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.trees.limb_actuation import joint_from_motor
from hyperleg_design.robot.trees.rod_range import rod_ranges
from tests.robot.tree_files import leg

GEAR = 9.0


def with_rod(crank: float, lever: float, upper_deg: float):
    """A knee that a rod along the thigh drives; crank and lever stand across it at zero."""
    return leg(
        joints={
            "hip": {"parent": "base", "child": "thigh"},
            "knee": {
                "parent": "thigh",
                "child": "shank",
                "position": [0, 0, -0.2],
                "lower_deg": 0,
                "upper_deg": upper_deg,
                "default_deg": 30,
            },
        },
        rods={
            "knee": {
                "carrier": "thigh",
                "end": "shank",
                "crank_axis": [0, 0, -0.05],
                "crank_end": [-crank, 0, -0.05],
                "rod_end": [-lever, 0, 0],
            }
        },
    )


def test_a_parallelogram_has_one_reduction_up_to_its_dead_centre():
    (rod,) = rod_ranges(with_rod(0.04, 0.04, 85.0))
    np.testing.assert_allclose(rod.reduction["knee"], (GEAR, GEAR), rtol=1e-9)
    assert rod.default["knee"] == pytest.approx(GEAR)
    assert rod.beyond == {}
    assert rod.reversed == {}
    assert _rod_findings(rod) == []


def test_behind_a_right_angle_a_parallelogram_turns_back():
    (rod,) = rod_ranges(with_rod(0.04, 0.04, 120.0))
    assert 90 < rod.reversed["knee"]["knee"] < 91
    assert rod.reduction["knee"][0] < 0
    (found,) = _rod_findings(rod)
    assert found.severity == "warning"
    assert "dead centre at knee 90." in found.message


def test_a_short_crank_reaches_until_it_lies_along_its_rod():
    """Then crank's end, rod's end and crank's axis are in line: their distance is crank + rod."""
    crank, lever = 0.03, 0.05
    (rod,) = rod_ranges(with_rod(crank, lever, 80.0))
    length = np.hypot(0.15, lever - crank)
    angles = np.deg2rad(np.linspace(0, 80, 8001))
    distance = np.hypot(lever * np.cos(angles), 0.15 - lever * np.sin(angles))
    reach = (distance >= abs(length - crank)) & (distance <= length + crank)
    first = np.rad2deg(angles[np.argmin(reach)])
    assert first <= rod.beyond["knee"] < first + 80 / 199 + 0.1
    assert "does not reach at knee" in _rod_findings(rod)[0].message


def test_two_rods_of_an_ankle_span_both_of_its_joints():
    design = load_robot("parallel_ankle")
    joints = list(design.joint_sections)
    matrix = joint_from_motor(design)
    for rod in rod_ranges(design):
        column = list(design.actuator_sections).index(rod.motor)
        assert set(rod.reduction) == {"ankle_pitch", "ankle_roll"}
        for joint, (low, high) in rod.reduction.items():
            own = matrix[joints.index(joint), column]
            assert rod.default[joint] == pytest.approx(own)
            assert low <= own <= high
        assert not rod.beyond
        assert not rod.reversed


def test_a_robot_without_rods_has_no_ranges():
    assert rod_ranges(leg()) == ()
