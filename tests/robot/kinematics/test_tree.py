from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate, variants
from hyperleg_design.robot.kinematics.posture import link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.names import JOINTS

MIRROR = np.diag([1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def tree(hyperleg):
    return build_tree(hyperleg)


def test_leg_length_and_height(hyperleg, tree):
    poses = link_poses(tree)
    assert poses["left_ankle_cross"][1][2] == pytest.approx(-(0.786 - 0.071), abs=1e-12)
    assert lowest_point(tree, poses) == pytest.approx(-0.786, abs=1e-12)
    box = tree.link("pelvis").visuals[0]
    top = box.position[2] + box.size[2] / 2
    assert top - lowest_point(tree, poses) == pytest.approx(0.9586, abs=1e-12)


def test_every_pad_touches_the_ground_that_a_straight_robot_stands_on(tree):
    poses = link_poses(tree)
    pads = [
        (poses[link.name][1] + pad.position)[2] - pad.size[0]
        for link in tree.links
        for pad in link.pads
    ]
    assert len(pads) == 12
    np.testing.assert_allclose(pads, -0.786, atol=1e-12)


def test_order_and_names(tree):
    assert [j.name for j in tree.moving] == [
        f"{side}_{name}" for side in ("left", "right") for name in JOINTS
    ]
    assert tree.links[0].name == "pelvis"
    known = {"pelvis"}
    for joint in tree.joints:  # parents come first
        assert joint.parent in known
        known.add(joint.child)
    assert known == {link.name for link in tree.links}


@given(st.data())
@settings(max_examples=15)
def test_equal_angles_are_mirrored_postures(random_designs, data):
    tree = build_tree(data.draw(random_designs))
    angles = {
        j.name.removeprefix("left_"): data.draw(st.floats(j.lower, j.upper))
        for j in tree.moving
        if j.name.startswith("left")
    }
    poses = link_poses(
        tree,
        {f"{side}_{name}": angle for side in ("left", "right") for name, angle in angles.items()},
    )
    for link in tree.links:
        if link.name.startswith("left_"):
            rotation, position = poses[link.name]
            other_rotation, other_position = poses[link.name.replace("left_", "right_")]
            np.testing.assert_allclose(other_position, MIRROR @ position, atol=1e-12)
            np.testing.assert_allclose(other_rotation, MIRROR @ rotation @ MIRROR, atol=1e-12)
            mirrored = tree.link(link.name.replace("left_", "right_"))
            np.testing.assert_allclose(mirrored.com, MIRROR @ link.com, atol=1e-15)
            np.testing.assert_allclose(mirrored.inertia, MIRROR @ link.inertia @ MIRROR, atol=1e-15)


@pytest.mark.parametrize(
    ("joint", "link", "direction"),
    [
        ("left_hip_pitch", "left_foot", [-1, 0, 0]),  # positive is extension: the leg goes back
        ("left_knee", "left_foot", [-1, 0, 0]),  # flexion: the heel goes back
        ("left_hip_roll", "left_foot", [0, 1, 0]),  # abduction: outward
        ("right_hip_roll", "right_foot", [0, -1, 0]),
        ("left_ankle_pitch", "left_toe_plate", [0, 0, -1]),  # plantar flexion: the toes go down
    ],
)
def test_what_positive_means(tree, joint, link, direction):
    moved = link_poses(tree, {joint: 0.05})[link][1] - link_poses(tree)[link][1]
    assert moved @ np.array(direction) > 0.8 * np.linalg.norm(moved)


def test_positive_toe_is_plantar_flexion(tree):
    tip = np.array([0.065, 0, 0])
    rotation, _ = link_poses(tree, {"left_toe": 0.1})["left_toe_plate"]
    assert (rotation @ tip)[2] < 0


def test_limits_efforts_and_speeds_are_the_designs(hyperleg, tree):
    torque, speed = (
        transmission.max_joint_torque(hyperleg, "walking"),
        transmission.single_joint_speed(hyperleg, "walking"),
    )
    for index, joint in enumerate(tree.moving[:7]):
        declared = getattr(hyperleg.joints, JOINTS[index])
        assert (joint.effort, joint.velocity) == (torque[index], speed[index])
        np.testing.assert_allclose(
            np.rad2deg([joint.lower, joint.upper]),
            [declared.lower_deg, declared.upper_deg],
            atol=1e-12,
        )
        assert (joint.coulomb, joint.viscous) == (declared.coulomb, declared.viscous)


def test_a_locked_toe_is_a_fixed_link(hyperleg):
    for name, variant in variants(hyperleg).items():
        made = build_tree(variant)
        assert len(made.moving) == (14 if name == "toe" else 12)
        assert len(made.links) == 15
    assert build_tree(ablate(hyperleg, "toe_removed")).link("left_toe_plate").mass == 0


def test_a_batch_has_no_tree(hyperleg):
    with pytest.raises(InputError, match="batch"):
        build_tree(hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])}))
