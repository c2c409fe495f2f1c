from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.linkage import FourBar, LinkageModel
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.names import JOINTS


@pytest.fixture(scope="module")
def linkage(hyperleg) -> LinkageModel:
    return LinkageModel.of(hyperleg)


@pytest.fixture(scope="module")
def limits(hyperleg) -> np.ndarray:
    joints = [getattr(hyperleg.joints, name) for name in JOINTS]
    return np.deg2rad([[j.lower_deg, j.upper_deg] for j in joints])


fractions = st.lists(st.floats(0, 1), min_size=7, max_size=7).map(np.array)


def within(limits: np.ndarray, fraction: np.ndarray) -> np.ndarray:
    return limits[:, 0] + fraction * (limits[:, 1] - limits[:, 0])


def test_both_printed_postures_hold(hyperleg, linkage):
    np.testing.assert_allclose(
        linkage.joint_from_motor(np.zeros(7)),
        transmission.joint_from_motor(hyperleg, "standing"),
        atol=1e-7,
    )
    walking = linkage.joint_from_motor(linkage.walking_posture(hyperleg))
    np.testing.assert_allclose(
        walking, transmission.joint_from_motor(hyperleg, "walking"), atol=1e-7
    )


@given(fraction=fractions)
@settings(max_examples=40)
def test_m_is_the_gradient_of_the_motor_positions(linkage, limits, fraction):
    q = within(limits, fraction)
    step = 1e-6
    steps = step * np.eye(7)
    difference = (linkage.motor_position(q + steps) - linkage.motor_position(q - steps)) / (
        2 * step
    )
    np.testing.assert_allclose(linkage.joint_from_motor(q), difference, atol=2e-5)


@given(corners=st.lists(fractions, min_size=2, max_size=4))
@settings(max_examples=20)
def test_motors_come_back_after_a_closed_path(linkage, limits, corners):
    """Integral of M^T dq around a polygon in joint space is zero, and along a side it is the change
    of motor position.
    """
    nodes, weights = np.polynomial.legendre.leggauss(60)
    points = [within(limits, c) for c in corners]
    total = np.zeros(7)
    for start, end in zip(points, points[1:] + points[:1], strict=True):
        # pieces end where a linkage's ratio is held constant, so that each is smooth enough for the
        # quadrature
        pieces = np.linspace(0, 1, 41)
        part = np.zeros(7)
        for low, high in itertools.pairwise(pieces):
            t = low + (high - low) * (nodes + 1) / 2
            matrices = linkage.joint_from_motor(start + t[:, None] * (end - start))
            part += (high - low) / 2 * np.einsum("i,ijm,j->m", weights, matrices, end - start)
        np.testing.assert_allclose(
            part, linkage.motor_position(end) - linkage.motor_position(start), atol=1e-4
        )
        total += part
    np.testing.assert_allclose(total, 0, atol=2e-4)


@given(fraction=fractions)
@settings(max_examples=60)
def test_m_is_invertible_all_over_the_range_of_motion(linkage, limits, fraction):
    matrix = linkage.joint_from_motor(within(limits, fraction))
    assert np.linalg.cond(matrix) < 1e3
    assert np.linalg.det(matrix) != 0


def test_m_is_invertible_at_every_corner(linkage, limits):
    corners = np.stack(np.meshgrid(*limits[3:], indexing="ij"), -1).reshape(-1, 4)
    matrices = linkage.joint_from_motor(np.concatenate([np.zeros((16, 3)), corners], -1))
    assert np.linalg.cond(matrices).max() < 1e3


def test_batches_of_postures(linkage, limits, rng):
    q = within(limits, rng.random((4, 3, 7)))
    assert linkage.joint_from_motor(q).shape == (4, 3, 7, 7)
    np.testing.assert_array_equal(
        linkage.joint_from_motor(q)[1, 2], linkage.joint_from_motor(q[1, 2])
    )
    np.testing.assert_array_equal(linkage.motor_position(q)[1, 2], linkage.motor_position(q[1, 2]))
    np.testing.assert_allclose(linkage.motor_position(np.zeros(7)), 0, atol=1e-12)
    with pytest.raises(ValueError, match="last axis"):
        linkage.motor_position(np.zeros(6))


@pytest.mark.parametrize(("variant", "shape"), [("toe_locked", (6, 7)), ("toe_removed", (6, 6))])
def test_variants(hyperleg, linkage, variant, shape, rng):
    model = LinkageModel.of(ablate(hyperleg, variant))
    q = rng.uniform(-0.3, 0.3, 6)
    assert model.joint_from_motor(q).shape == shape
    full = linkage.joint_from_motor(np.append(q, 0.0))
    np.testing.assert_allclose(model.joint_from_motor(q), full[: shape[0], : shape[1]], atol=1e-12)


def test_gears_multiply_columns(hyperleg, linkage):
    q = np.array([0, 0, 0, 0.5, -0.2, 0.1, -0.3])
    geared = LinkageModel.of(hyperleg.with_values({"actuators.toe.gear": 14.0}))
    expected = linkage.joint_from_motor(q)
    expected[:, 6] *= 2
    np.testing.assert_allclose(geared.joint_from_motor(q), expected, rtol=1e-12)


def coupler_length(bar: FourBar, turn: np.ndarray) -> np.ndarray:
    """Between the pins of crank and lever, from plane geometry alone."""
    crank, lever = bar.crank_start + bar(turn)[0], bar.lever_start + turn
    pin = np.stack([-bar.crank * np.sin(crank), bar.crank * np.cos(crank)], -1)
    other = np.stack([bar.ground - bar.lever * np.sin(lever), bar.lever * np.cos(lever)], -1)
    return np.linalg.norm(pin - other, axis=-1)


@pytest.mark.parametrize("name", ["ankle", "toe_shank", "toe_foot"])
def test_four_bars_close(linkage, name):
    bar = getattr(linkage, name)
    turns = np.linspace(*bar.turns, 200)
    lengths = coupler_length(bar, turns)
    np.testing.assert_allclose(lengths, coupler_length(bar, np.zeros(1))[0], rtol=1e-12)
    assert bar(0.0)[0] == pytest.approx(0, abs=1e-12)
    slopes = np.gradient(bar(turns)[0], turns, edge_order=2)
    np.testing.assert_allclose(bar(turns)[1], slopes, rtol=5e-3)


def test_a_parallelogram_turns_one_to_one():
    bar = FourBar(0.03, 0.03, 0.3, 0.0, 0.0, (-1.0, 1.0))
    turns = np.linspace(-1.5, 1.5, 31)
    crank, ratio = bar(turns)
    np.testing.assert_allclose(crank, turns, atol=1e-12)
    np.testing.assert_allclose(ratio, 1, atol=1e-12)


def test_what_no_such_linkage_can_be(hyperleg):
    with pytest.raises(InputError, match="one robot at a time"):
        LinkageModel.of(hyperleg.with_values({"toe.mass": np.array([0.2, 0.3])}))
    with pytest.raises(InputError, match="belt's ratio"):
        LinkageModel.of(hyperleg.with_values({"transmission.walking.knee": 30.0}))
    with pytest.raises(InputError, match="decouples"):
        LinkageModel.of(hyperleg.with_values({"transmission.scale.toe_ankle_pitch": 0.0}))
    with pytest.raises(InputError, match=r"walking_ankle_pitch_deg = -10\.0.*no four-bar"):
        LinkageModel.of(hyperleg.with_values({"transmission.walking.ankle_pitch": 500.0}))
    with pytest.raises(InputError, match=r"walking_toe_deg = 30"):  # outside the toe's range
        LinkageModel.of(hyperleg.with_values({"transmission.linkage.walking_toe_deg": 30.0}))


def test_a_tree_has_no_such_linkage():
    with pytest.raises(InputError, match=r"mini_cheetah.*family.*joint_from_motor"):
        LinkageModel.of(load_robot("mini_cheetah"))
