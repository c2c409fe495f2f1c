from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.kinematics.dimensions import zero_height
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.simulation.layout import layout_of


@pytest.mark.parametrize(
    ("name", "joints", "motors"), [("toe", 14, 14), ("toe_locked", 12, 14), ("toe_removed", 12, 12)]
)
def test_both_legs_in_the_same_order(name: str, joints: int, motors: int) -> None:
    layout = layout_of(load_design(name))
    assert (len(layout.joints), len(layout.motors)) == (joints, motors)
    left, right = layout.joints[: layout.leg_joints], layout.joints[layout.leg_joints :]
    assert [x.removeprefix("left_") for x in left] == [x.removeprefix("right_") for x in right]
    assert list(layout.pad_foot) == sorted(layout.pad_foot)
    assert np.bincount(layout.pad_foot).tolist() == [len(layout.pads) // 2] * 2
    assert np.all(layout.lower < layout.upper)
    assert np.all((layout.lower <= layout.default) & (layout.default <= layout.upper))


def test_pads_lie_side_by_side_mirrored() -> None:
    layout = layout_of(load_design("toe"))
    left, right = (layout.pad_position[layout.pad_foot == foot] for foot in (0, 1))
    mirrored = {tuple(np.round(p * [1, -1, 1], 9)) for p in right}
    assert {tuple(np.round(p, 9)) for p in left} == mirrored


def test_weight_and_names() -> None:
    layout = layout_of(load_design("toe"))
    assert layout.weight == pytest.approx(32.0 * GRAVITY, rel=1e-6)
    assert [layout.joints[i] for i in layout.hip_sideways] == [
        "left_hip_yaw",
        "left_hip_roll",
        "right_hip_yaw",
        "right_hip_roll",
    ]
    assert layout.joint_indices("tail").size == 0


def test_a_quadrupeds_diagonal_feet_step_together() -> None:
    layout = layout_of(load_robot("mini_cheetah"))
    assert layout.limbs == ("front_left", "front_right", "rear_left", "rear_right")
    assert layout.own_joints == ("abduction", "hip", "knee")
    assert layout.feet == tuple(f"{limb}_shank" for limb in layout.limbs)
    assert layout.foot_phase == (0.0, 0.5, 0.5, 0.0)
    assert layout.mirror_feet == (1, 0, 3, 2)
    assert layout.pads_of_foot == (1, 1, 1, 1)
    assert layout.joint_indices("knee").tolist() == [2, 5, 8, 11]
    # thigh 0.209 m and shank 0.195 m, hip at -0.8 rad and knee at 1.6 rad, and the foot's radius
    assert layout.default_height == pytest.approx(0.404 * np.cos(0.8) + 0.0175, abs=1e-3)


def test_heights_of_the_two_postures() -> None:
    design = load_design("toe")
    layout = layout_of(design)
    assert layout.feet == ("left_foot", "right_foot")
    assert 0.9 * zero_height(design) < layout.default_height <= zero_height(design)
