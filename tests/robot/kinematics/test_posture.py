from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.robot.kinematics.posture import (
    axis_rotation,
    default_angles,
    link_poses,
    lowest_point,
)
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.models import rigid_body_model


@given(
    axis=st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(
        lambda a: np.linalg.norm(a) > 0.1
    ),
    angle=st.floats(-4, 4),
)
def test_axis_rotation_is_the_exponential(axis, angle):
    from scipy.spatial.transform import Rotation

    unit = np.array(axis) / np.linalg.norm(axis)
    np.testing.assert_allclose(
        axis_rotation(unit, angle), Rotation.from_rotvec(unit * angle).as_matrix(), atol=1e-14
    )


@pytest.fixture(scope="module")
def body(hyperleg):
    return rigid_body_model(hyperleg)


@given(angles=st.lists(st.floats(-1, 1), min_size=14, max_size=14))
@settings(max_examples=20)
def test_poses_are_pinocchios(body, angles):
    q = body.neutral()
    q[:7] = 0, 0, 0, 0, 0, 0, 1
    q[7:] = angles
    poses = link_poses(
        body.tree, dict(zip([j.name for j in body.tree.moving], angles, strict=True))
    )
    for link in body.tree.links:
        np.testing.assert_allclose(
            poses[link.name][1], body.frame_position(q, link.name), atol=1e-12
        )


def test_default_posture(hyperleg):
    tree = build_tree(hyperleg)
    angles = default_angles(tree)
    assert angles["left_knee"] == pytest.approx(0.5)
    assert lowest_point(tree, link_poses(tree, angles)) > -0.786
    with pytest.raises(KeyError, match="left_elbow"):
        link_poses(tree, {"left_elbow": 1.0})
