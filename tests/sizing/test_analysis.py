"""The analysis object: its numbers against the functions and the paper they come from."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import paper
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing.analysis import analyze


@pytest.fixture(scope="module")
def found():
    return analyze(load_design("hyperleg"))


def test_it_is_plain_json(found):
    assert json.loads(json.dumps(found, allow_nan=False)) == found


def test_matrices_are_the_papers(found):
    assert found["reduction"]["walking"] == [list(row) for row in paper.WALKING_MATRIX]
    standing = np.array(found["reduction"]["standing"])
    assert standing[4].tolist() == [0, 0, 0, 0, 26.0, 26.0, 24.14]
    assert standing[6, 6] == 31.93


def test_torques_and_speeds_are_the_papers(found):
    for joint, printed in paper.MAX_JOINT_TORQUE.items():
        assert found["max_joint_torque"][joint] == pytest.approx(printed, rel=1e-3)
    for joint, speed in {
        "knee": 10.5,
        "ankle_pitch": 13.7,
        "ankle_roll": 22.2,
        "toe": 17.2,
    }.items():
        assert found["single_joint_speed"][joint] == pytest.approx(speed, abs=0.05)


def test_reflected_inertia_is_that_of_the_rotors(found):
    matrix, rotors = (
        np.array(found["reduction"]["walking"]),
        [m["rotor_inertia"] for m in found["motors"].values()],
    )
    assert np.allclose(
        found["reflected_inertia"], matrix @ np.diag(rotors) @ matrix.T, rtol=1e-12, atol=1e-15
    )


def test_a_joint_alone_never_gives_more_than_at_its_best(found):
    sums = np.abs(np.array(found["reduction"]["walking"])) @ [
        m["peak_torque"] for m in found["motors"].values()
    ]
    assert all(
        alone <= best + 1e-9
        for alone, best in zip(found["torque_alone"].values(), sums, strict=True)
    )
    assert found["torque_alone"]["knee"] == pytest.approx(83.4, abs=0.05)


def test_what_a_box_hides(found):
    assert found["zonotope_to_box_volume"] == pytest.approx(0.130, abs=5e-4)


@pytest.mark.parametrize("name", ["toe_locked", "toe_removed_matched", "toe_removed"])
def test_variants_lose_the_toe_and_say_so(name):
    found = analyze(variants(load_design("hyperleg"))[name])
    assert "toe" not in found["max_joint_torque"]
    assert ("toe" in found["motors"]) == (name == "toe_locked")
    assert found["ablation_confound"] is None


def test_a_batch_is_refused():
    with pytest.raises(InputError, match="batch"):
        analyze(load_design("hyperleg").with_values({"toe.mass": np.array([0.1, 0.2])}))


def test_at_half_the_voltage_the_ankle_is_limited_by_its_stall_torque():
    low = analyze(load_design("hyperleg", overrides={"electrical.voltage_ratio": 0.5}))
    motor = low["motors"]["ankle_left"]
    assert motor["stall_torque"] == pytest.approx(0.5 * 2.938, rel=1e-3)
    assert motor["corner_speed"] == 0.0
    assert low["joint_limits"]["max_torque"]["ankle_roll"] == pytest.approx(
        2 * 16.51 * motor["stall_torque"]
    )
    assert low["torque_alone"]["ankle_roll"] <= 2 * 16.51 * motor["stall_torque"] + 1e-9
    assert "stall torque" in low["joint_limits"]["convention"]
    hip = low["motors"]["hip_pitch"]
    assert hip["corner_speed"] == pytest.approx(150 * (1 - 5.04 / (0.5 * 84.7458)), rel=1e-4)
