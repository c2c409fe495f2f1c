import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.kinematics import about_y
from hyperleg_design.sizing.motions.foot_path import (
    FLAT,
    ON_HEEL,
    ON_TOE,
    SWING,
    Step,
    bump,
    foot_path,
    quintic,
    rolling,
)

STEP = Step(0.1, 0.2, 0.6, 0.7, (0.0, 0.1, 0.0), (0.5, 0.12, 0.1), 0.5, -0.2, 0.05)
NUMBER = st.floats(-3, 3)


@settings(max_examples=40)
@given(*[st.tuples(NUMBER, NUMBER, NUMBER)] * 2, st.floats(-1, 1), st.floats(0.05, 3))
def test_quintic_meets_both_states(first, last, begin, span):
    found = quintic(np.array([begin, begin + span]), begin, begin + span, first, last)
    scale = 1 + 60 * 3 / span**2
    np.testing.assert_allclose(found[:, 0], first, atol=1e-12 * scale)
    np.testing.assert_allclose(found[:, 1], last, atol=1e-12 * scale)


def test_bump_rests_at_both_ends():
    np.testing.assert_allclose(bump(np.array([1.0, 3.0]), 1.0, 3.0, 0.2), 0.0, atol=1e-14)
    assert bump(np.array([2.0]), 1.0, 3.0, 0.2)[0, 0] == pytest.approx(0.2)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("row", ["heel", "tip"])
def test_rolling_pads_stay_on_the_floor_and_do_not_slip(variant, row):
    design = load_design(variant=variant)
    rate = np.full(9, 1.7)
    angle = np.linspace(-0.6, 0.0, 9) if row == "heel" else np.linspace(0.0, 0.9, 9)
    moved = rolling(design, row, np.stack([angle, rate, 0 * rate]))
    radius = design.contact.pad_radius
    hinge = row == "tip" and design.toe.joint == "active"
    forward = (
        -design.foot.heel_length + radius
        if row == "heel"
        else design.foot.ball_length + (0 if hinge else design.toe.length - radius)
    )
    below = -design.foot.ankle_height + (design.toe.axis_height if hinge else radius)
    turned = about_y(angle) @ np.array([forward, 0.0, below])
    center = (
        np.array([0.0, 0.0, design.foot.ankle_height])
        + np.stack([moved[0, :, 0], 0 * angle, moved[0, :, 1]], -1)
        + turned
    )
    np.testing.assert_allclose(
        center[:, 2], design.toe.axis_height if hinge else radius, atol=1e-12
    )
    # the ankle's velocity plus w x r gives what touches the floor no velocity
    arm = turned - np.array([0, 0, 0.0 if hinge else radius])
    velocity = np.stack([moved[1, :, 0], 0 * angle, moved[1, :, 1]], -1) + np.cross(
        np.array([0.0, 1.7, 0.0]), arm
    )
    np.testing.assert_allclose(velocity, 0.0, atol=1e-12)


@pytest.mark.parametrize("variant", ["toe", "toe_removed"])
def test_path_is_smooth_through_all_phases(variant):
    design = load_design(variant=variant)
    time = np.linspace(0, 0.9, 9001)
    path = foot_path(design, time, [STEP])
    changes = np.flatnonzero(np.diff(path.phase))
    assert path.phase[[0, *changes + 1]].tolist() == [FLAT, ON_TOE, SWING, ON_HEEL, FLAT]
    step = time[1]
    for value in (path.position, path.pitch[..., None], path.toe[..., None]):
        for order in (0, 1):
            slope = (value[order, 2:] - value[order, :-2]) / (2 * step)
            size = np.abs(value[order + 1]).max() + 1e-9
            assert np.abs(slope - value[order + 1, 1:-1]).max() < 2e-2 * size + 1e-9
            assert np.abs(np.diff(value[order], axis=0)).max() <= 1.01 * step * size
    np.testing.assert_allclose(
        path.position[0, -1], [0.5, 0.12, 0.1 + design.foot.ankle_height], atol=1e-12
    )
    assert (np.ptp(path.toe[0]) > 0.4) == (variant == "toe")


def test_stands_before_and_after():
    path = foot_path(load_design(), np.array([0.0, 0.05, 0.8]), [STEP])
    np.testing.assert_allclose(path.position[1:], 0.0)
    assert path.bears("heel").all()
    assert path.bears("tip").all()


def test_flat_step_never_pitches():
    flat = Step(0.1, 0.1, 0.5, 0.5, (0, 0, 0), (0.3, 0, 0.1), 0.0, 0.0, 0.05)
    path = foot_path(load_design(), np.linspace(0, 1, 101), [flat])
    assert not path.pitch.any()
    assert set(path.phase) == {FLAT, SWING}
