"""Solids stand where the robot stands, and motors are drawn where they are installed."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.report.pictures.solids import PAD, link_solids, robot_solids
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.kinematics.tree import build_tree
from tests.robot.tree_files import leg, leg_file


@pytest.fixture(scope="module")
def design():
    return load_design("hyperleg")


def test_robot_stands_on_the_floor(design):
    for angles in ({}, {"left_knee": 1.0, "left_hip_pitch": -0.5, "left_ankle_pitch": -0.5}):
        pads = [s for s in robot_solids(design, angles=angles) if s.colour == PAD]
        assert min(s.position[2] - s.size[0] for s in pads) == pytest.approx(0, abs=1e-12)


def test_yaw_turns_the_robot_as_a_whole(design):
    plain, turned = robot_solids(design), robot_solids(design, yaw=0.7)
    steps = [
        np.linalg.norm(np.diff([s.position for s in solids], axis=0), axis=1)
        for solids in (plain, turned)
    ]
    assert np.allclose(steps[0], steps[1], atol=1e-12)
    assert not np.allclose([s.position for s in plain], [s.position for s in turned])


def test_only_installed_motors_are_drawn(design):
    counts = {}
    for name, variant in variants(design).items():
        with_motors = len(robot_solids(variant, motors=True))
        counts[name] = with_motors - len(robot_solids(variant, motors=False))
    assert counts == {"toe": 14, "toe_locked": 14, "toe_removed_matched": 12, "toe_removed": 12}


def test_robots_without_drawings_get_rods_from_joint_to_joint_and_to_their_pads():
    whole = leg()
    tree = build_tree(whole)
    solids = link_solids(whole, tree, motors=False)
    ends = {
        name: [2 * s.position for s in own if s.kind == "cylinder"] for name, own in solids.items()
    }
    assert np.allclose(ends["thigh"], [[0, 0, -0.2]])
    assert np.allclose(ends["shank"], [[0, 0, -0.2]])
    assert ends["base"] == []  # the hip is at its origin
    for own in solids.values():
        for rod in (s for s in own if s.kind == "cylinder"):
            along = rod.rotation @ [0, 0, rod.size[1]]
            assert np.allclose(along, 2 * rod.position)
            assert np.linalg.det(rod.rotation) == pytest.approx(1)


def test_a_link_without_a_shape_gets_rods_though_another_has_one():
    box = {"mass": 1.0, "gyration": [0.1] * 3, "shape": "box", "size": [0.2, 0.1, 0.1]}
    parts = leg_file()
    design = leg(links={**parts["links"], "base": box})
    solids = link_solids(design, build_tree(design), motors=False)
    assert [s.kind for s in solids["base"]] == ["box"]
    assert [s.kind for s in solids["thigh"]] == ["cylinder"]
    assert [s.kind for s in solids["shank"]] == ["sphere", "cylinder"]
    design = leg(pads={})
    (rod,) = link_solids(design, build_tree(design), motors=False)["shank"]
    assert np.allclose(2 * rod.position, [0, 0, -0.1])  # to the centre of mass


@pytest.mark.parametrize("axis", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
def test_motors_turn_about_the_axes_of_their_joints(axis):
    parts = leg_file()
    hip = parts["joints"]["hip"] | {"axis": axis}
    knee = parts["joints"]["knee"] | {"axis": axis, "turn_deg": [90, 0, 0]}
    design = leg(joints={"hip": hip, "knee": knee})
    tree = build_tree(design)
    both, plain = (link_solids(design, tree, motors=m) for m in (True, False))
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    for link, along in (("base", axis), ("thigh", turn @ axis)):
        (motor,) = [s for s in both[link] if s.size not in [p.size for p in plain[link]]]
        assert abs(motor.rotation[:, 2] @ along) == pytest.approx(1)
