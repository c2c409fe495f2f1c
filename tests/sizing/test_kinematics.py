import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.kinematics import (
    about_x,
    about_y,
    check_range,
    hip_center,
    leg_angles,
    leg_reach,
)

DESIGN = load_design()
MODEL = rigid_body_model(DESIGN)
LOWER = np.deg2rad([-35, -5, -60, 2, -56, -30])
UPPER = np.deg2rad([15, 90, 60, 150, 60, 30])


def _foot(q: np.ndarray, side: str) -> tuple[np.ndarray, np.ndarray]:
    import pinocchio as pin

    pin.framesForwardKinematics(MODEL.model, MODEL.data, q)
    place = MODEL.data.oMf[MODEL.model.getFrameId(f"{side}_foot")]
    return np.array(place.translation), np.array(place.rotation)


@settings(max_examples=60)
@given(
    st.lists(st.floats(0, 1), min_size=6, max_size=6),
    st.sampled_from(SIDES),
    st.floats(-0.5, 0.5),
    st.floats(-0.5, 0.5),
)
def test_inverse_of_forward_kinematics(share, side, pitch, roll):
    angles = LOWER + np.array(share) * (UPPER - LOWER)
    if (
        abs(angles[2]) + abs(angles[1]) > 2.0
    ):  # beyond, the hip's roll and yaw have a second solution
        angles[1] = 0.3
    q = MODEL.neutral()
    base = about_x(np.array(roll)) @ about_y(np.array(pitch))
    (a, b), (c, d) = (np.sin([roll / 2, pitch / 2]), np.cos([roll / 2, pitch / 2]))
    q[3:7] = [a * d, c * b, a * b, c * d]
    start = 7 + 7 * SIDES.index(side)
    q[start : start + 6] = angles
    position, rotation = _foot(q, side)
    offset = base.T @ (position - q[:3]) - hip_center(DESIGN, side)
    found = leg_angles(DESIGN, side, offset, base.T @ rotation, check_limits=False)
    q[start : start + 6] = found
    again, turned = _foot(q, side)
    np.testing.assert_allclose(again, position, atol=1e-9)
    np.testing.assert_allclose(turned, rotation, atol=1e-9)
    assert found[3] >= 0


def test_batches_equal_single_poses(rng):
    offsets = np.array([0.0, 0.0, -0.6]) + rng.uniform(-0.08, 0.08, (20, 3))
    rotations = about_y(rng.uniform(-0.3, 0.3, 20)) @ about_x(rng.uniform(-0.2, 0.2, 20))
    together = leg_angles(DESIGN, "left", offsets, rotations, check_limits=False)
    single = [
        leg_angles(DESIGN, "left", o, r, check_limits=False)
        for o, r in zip(offsets, rotations, strict=True)
    ]
    np.testing.assert_allclose(together, single, atol=1e-14)


def test_mirrored_feet_give_equal_angles():
    left = leg_angles(
        DESIGN,
        "left",
        np.array([0.05, 0.04, -0.62]),
        about_x(np.array(0.1)) @ about_y(np.array(0.2)),
    )
    right = leg_angles(
        DESIGN,
        "right",
        np.array([0.05, -0.04, -0.62]),
        about_x(np.array(-0.1)) @ about_y(np.array(0.2)),
    )
    np.testing.assert_allclose(left, right, atol=1e-12)


def test_straight_leg_reaches_the_sum_of_its_lengths():
    assert leg_reach(DESIGN) == pytest.approx(0.370 + 0.345)
    assert leg_reach(DESIGN, np.pi) == pytest.approx(0.025)
    angles = leg_angles(DESIGN, "left", np.array([0.0, 0.0, -leg_reach(DESIGN, 0.5)]), np.eye(3))
    assert angles[3] == pytest.approx(0.5)
    assert angles[2] + angles[3] + angles[4] == pytest.approx(0.0, abs=1e-12)


def test_out_of_reach_says_how_far():
    with pytest.raises(
        InfeasibleError,
        match=r"left leg: the ankle is 0\.8000 m from the hip; the leg reaches 0\.0250 \.\. "
        r"0\.7150 m",
    ):
        leg_angles(DESIGN, "left", np.array([0.0, 0.0, -0.8]), np.eye(3))


def test_range_names_joint_and_angle():
    with pytest.raises(
        InfeasibleError,
        match=r"right ankle_pitch would have to turn to -\d+\.\d deg; its range is -56 \.\. 60 deg",
    ):
        leg_angles(DESIGN, "right", np.array([0.0, 0.0, -0.6]), about_y(np.array(-0.9)))
    with pytest.raises(InfeasibleError, match="left toe"):
        check_range(DESIGN, "left", np.array([0, 0, 0, 0.1, 0, 0, 0.5]))
    with pytest.raises(InfeasibleError):
        check_range(DESIGN, "left", np.array([np.nan, 0, 0, 0.1, 0, 0, 0]))


def test_bad_input():
    with pytest.raises(InputError, match="side"):
        leg_angles(DESIGN, "middle", np.zeros(3), np.eye(3))
    with pytest.raises(InputError, match="batch"):
        leg_angles(
            DESIGN.with_values({"toe.mass": np.array([0.2, 0.3])}),
            "left",
            np.array([0, 0, -0.6]),
            np.eye(3),
        )
