from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.layout import GRAVITY, layout_of


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
