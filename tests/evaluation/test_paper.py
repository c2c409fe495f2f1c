"""The paper's numbers agree with each other where it says they should, and fail to where the list
says so.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation import paper
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.transmission import joint_from_motor


def test_eq_3_is_the_walking_matrix_of_the_design():
    assert np.array_equal(
        joint_from_motor(load_design("hyperleg"), "walking"), np.array(paper.WALKING_MATRIX)
    )


def test_maxima_follow_from_reductions_and_peak_torques():
    peak = {"U10": 5.04, "RI70": 2.68, "RI60": 1.63}
    below = 0.9 * 31.11 * (peak["RI70"] + 3 * peak["RI60"])
    assert below == pytest.approx(paper.MAX_JOINT_TORQUE["knee"], rel=1e-3)
    assert 25 * peak["U10"] == pytest.approx(paper.MAX_JOINT_TORQUE["hip_pitch"], rel=1e-3)
    assert 0.9 * 2 * 16.51 * peak["RI60"] == pytest.approx(
        paper.MAX_JOINT_TORQUE["ankle_roll"], rel=1e-3
    )
    assert 0.9 * 31.93 * peak["RI60"] == pytest.approx(paper.MAX_JOINT_TORQUE["toe"], rel=1e-3)


def test_the_inconsistencies_are_real():
    """Numbers quoted in the list, recomputed."""
    weight = paper.TOTAL_MASS * 9.81
    assert 260.2 / (weight * 1.33) == pytest.approx(0.623, abs=1e-3)
    assert 313.0 / (weight * 1.33) == pytest.approx(0.750, abs=1e-3)
    assert 260.2 * 15.96 / (weight * 20) == pytest.approx(0.661, abs=1e-3)
    assert 313.0 * 16.13 / (weight * 20) == pytest.approx(0.804, abs=1e-3)
    assert pytest.approx(0.137, abs=1e-3) == 125 / (70 * 9.81 * 1.33)
    assert pytest.approx(213, abs=0.5) == 103.7 + 61.8 + 47.5
    assert pytest.approx(256, abs=0.5) == 126.0 + 68.9 + 61.1
    assert pytest.approx(260.2, abs=0.05) == 125.9 + 134.3
    assert pytest.approx(24.7, abs=0.05) == 0.418 / 0.130**2
    assert pytest.approx(0.418 / 0.1118**2, rel=1e-3) == 33.44


def test_every_inconsistency_says_where_what_and_what_is_done():
    assert len(paper.INCONSISTENCIES) >= 10
    for item in paper.INCONSISTENCIES:
        assert item.place
        assert item.finding
        assert item.choice


def test_tables_three_and_four_agree_with_the_changes_printed():
    printed = {
        "total power": -16.9,
        "Joule heating": -24.9,
        "mechanical loss": -7.6,
        "CoT": -17.5,
        "time to goal": -1.1,
        "average heel-strike GRF": -5.0,
    }
    for row in paper.TABLE_THREE:
        assert 100 * row.change == pytest.approx(printed[row.quantity], abs=0.06), row.quantity
    printed = {
        "time to goal": -0.1,
        "max speed": -6.6,
        "average speed": -4.4,
        "average path deviation": -25.0,
        "max path deviation": -34.0,
    }
    for row in paper.TABLE_FOUR:
        assert 100 * row.change == pytest.approx(printed[row.quantity], abs=0.06), row.quantity


def test_total_power_is_joule_and_mechanical_and_the_legs_do_not_reach_it():
    total, joule, mechanical = paper.TABLE_THREE[:3]
    for side in ("toe", "ablation"):
        assert getattr(total, side) == pytest.approx(
            getattr(joule, side) + getattr(mechanical, side), abs=0.06
        )
        leg = sum(getattr(row, side) for row in paper.RIGHT_LEG_POWER)
        assert getattr(total, side) / 2 < leg < getattr(total, side)
    printed = {"hip": 22, "knee": 11, "ankle": 29}
    for row, name in zip(paper.RIGHT_LEG_POWER, printed, strict=True):
        assert name in row.quantity
        assert 100 * (row.ablation / row.toe - 1) == pytest.approx(printed[name], abs=0.6)


def test_the_t_test_is_shorter_than_the_human_one():
    time, _, speed = paper.TABLE_FOUR[:3]
    assert time.toe * speed.toe == pytest.approx(33.5, abs=0.05)
    assert time.ablation * speed.ablation == pytest.approx(35.1, abs=0.05)
    grf = paper.TABLE_THREE[-1]
    assert (grf.toe / (32 * 9.81), grf.ablation / (32 * 9.81)) == pytest.approx(
        (3.09, 3.25), abs=0.005
    )
