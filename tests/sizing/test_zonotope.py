import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import paper
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope

SEEDS = st.integers(0, 2**32 - 1)


def random_set(seed, joints, motors):
    rng = np.random.default_rng(seed)
    return (
        rng,
        rng.normal(size=(joints, motors)) * 20,
        -rng.uniform(0.5, 3, motors),
        rng.uniform(0.5, 7, motors),
    )


def corners(matrix, lower, upper):
    """Images of all 2^m corners of the box of motor torques."""
    picks = np.array(np.meshgrid(*[(0, 1)] * len(lower), indexing="ij")).reshape(len(lower), -1).T
    return np.where(picks, upper, lower) @ matrix.T


def largest(matrix, lower, upper, direction, held=()):
    """Cvxpy's answer to `support`, with the torque of some joints held at zero."""
    motor = cp.Variable(len(lower))
    joint = matrix @ motor
    problem = cp.Problem(
        cp.Maximize(direction @ joint),
        [motor >= lower, motor <= upper, *(joint[i] == 0 for i in held)],
    )
    problem.solve(solver=cp.CLARABEL)
    return problem.value


@pytest.fixture(scope="module")
def walking():
    design = load_design("hyperleg")
    return transmission.joint_from_motor(design, "walking"), motor_envelope(design).peak_torque


def test_table_one_maxima_are_supports(walking):
    design = load_design("hyperleg")
    standing, peak = transmission.joint_from_motor(design, "standing"), walking[1]
    found = zonotope.support(standing, -peak, peak, np.eye(7)) * transmission.derate(design)
    np.testing.assert_allclose(found, list(paper.MAX_JOINT_TORQUE.values()), rtol=1e-3)
    np.testing.assert_allclose(found, transmission.max_joint_torque(design), rtol=1e-12)


def test_audited_numbers_of_the_walking_posture(walking):
    matrix, peak = walking[0][3:, 3:], walking[1][3:]
    assert zonotope.zonotope_to_box_volume(matrix, -peak, peak) == pytest.approx(0.130, abs=5e-4)
    with_zero_knee = zonotope.alone(matrix, -peak, peak, 1, held=[0])
    assert with_zero_knee == pytest.approx(75.9, abs=0.05)
    assert 0.9 * with_zero_knee == pytest.approx(68.3, abs=0.05)
    knee = zonotope.alone(matrix, -peak, peak, 0)
    assert knee == pytest.approx(83.4, abs=0.05)
    assert 0.9 * knee == pytest.approx(75.0, abs=0.05)
    # the hip shares no motor, so counting it in changes neither
    assert zonotope.alone(walking[0], -walking[1], walking[1], 3) == pytest.approx(knee)
    assert zonotope.zonotope_to_box_volume(walking[0], -walking[1], walking[1]) == pytest.approx(
        0.130, abs=5e-4
    )


@settings(max_examples=12, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(4, 4), (6, 7), (7, 7), (3, 5)]))
def test_support_is_cvxpys(seed, shape):
    rng, matrix, lower, upper = random_set(seed, *shape)
    direction = rng.normal(size=shape[0])
    assert zonotope.support(matrix, lower, upper, direction) == pytest.approx(
        largest(matrix, lower, upper, direction), rel=1e-6, abs=1e-5
    )


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS)
def test_support_bounds_every_torque_and_is_reached(seed):
    rng, matrix, lower, upper = random_set(seed, 6, 7)
    direction = rng.normal(size=6)
    torque = corners(matrix, lower, upper) @ direction
    assert torque.max() == pytest.approx(
        float(zonotope.support(matrix, lower, upper, direction)), rel=1e-12
    )


@pytest.mark.parametrize("shape", [(2, 2), (3, 3), (2, 5), (3, 4), (3, 6), (4, 6)])
def test_volume_is_that_of_the_hull_of_all_corners(shape):
    for seed in range(3):
        _, matrix, lower, upper = random_set(seed, *shape)
        assert zonotope.volume(matrix, lower, upper) == pytest.approx(
            ConvexHull(corners(matrix, lower, upper)).volume, rel=1e-9
        )


@pytest.mark.parametrize("variant", ["toe", "toe_locked"])
def test_volume_is_that_of_random_points_inside(variant):
    design = load_design("hyperleg", variant=variant)
    matrix, peak = (
        transmission.joint_from_motor(design)[3:, 3:],
        motor_envelope(design).peak_torque[3:],
    )
    low, high = zonotope.box(matrix, -peak, peak)
    points = np.random.default_rng(7).uniform(low, high, (200_000, len(low)))
    share = float(np.mean(zonotope.contains(matrix, -peak, peak, points)))
    expected = float(zonotope.zonotope_to_box_volume(matrix, -peak, peak))
    assert share == pytest.approx(
        expected, abs=5 * np.sqrt(expected * (1 - expected) / len(points))
    )


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(3, 3), (3, 5), (6, 7)]))
def test_volume_goes_with_the_determinant(seed, shape):
    rng, matrix, lower, upper = random_set(seed, *shape)
    change = rng.normal(size=(shape[0], shape[0]))
    changed = zonotope.volume(change @ matrix, lower, upper)
    assert changed == pytest.approx(
        abs(np.linalg.det(change)) * zonotope.volume(matrix, lower, upper), rel=1e-8
    )


def test_volume_of_a_box_is_the_box_and_flat_sets_have_none():
    matrix, upper = np.diag([2.0, 3.0, 5.0]), np.ones(3)
    assert zonotope.zonotope_to_box_volume(matrix, -upper, upper) == pytest.approx(1)
    assert zonotope.volume(matrix[:, :2], -upper[:2], upper[:2]) == 0
    assert zonotope.volume(np.ones((2, 2)), -upper[:2], upper[:2]) == 0


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(4, 4), (3, 5)]))
def test_box_is_the_support_along_each_joint(seed, shape):
    _, matrix, lower, upper = random_set(seed, *shape)
    low, high = zonotope.box(matrix, lower, upper)
    unit = np.eye(shape[0])
    np.testing.assert_allclose(high, zonotope.support(matrix, lower, upper, unit))
    np.testing.assert_allclose(low, -zonotope.support(matrix, lower, upper, -unit))


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(3, 3), (2, 4), (3, 5), (6, 7)]))
def test_halfspaces_hold_all_that_motors_give_and_every_facet_is_reached(seed, shape):
    rng, matrix, lower, upper = random_set(seed, *shape)
    normal, offset = zonotope.halfspaces(matrix, lower, upper)
    heights = corners(matrix, lower, upper) @ normal.T
    np.testing.assert_allclose(heights.max(0), offset, rtol=1e-9, atol=1e-9)
    # what the facets let through, motors can give: distances along rays from the centre agree with
    # the hull's support
    inside = rng.uniform(lower, upper, (20, shape[1])) @ matrix.T
    assert zonotope.contains(matrix, lower, upper, inside).all()


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_edge_along_any_line_is_cvxpys(seed):
    rng, matrix, lower, upper = random_set(seed, 6, 7)
    start, direction = matrix @ rng.uniform(lower, upper), rng.normal(size=6)
    motor, reach = cp.Variable(7), cp.Variable()
    cp.Problem(
        cp.Maximize(reach),
        [matrix @ motor == start + reach * direction, motor >= lower, motor <= upper],
    ).solve(solver=cp.CLARABEL)
    assert zonotope.chord(matrix, lower, upper, start, direction)[1] == pytest.approx(
        reach.value, rel=1e-5, abs=1e-5
    )


@pytest.mark.parametrize("variant", ["toe", "toe_locked", "toe_removed"])
@pytest.mark.parametrize("held", [None, [3], [3, 5], []])
def test_torque_alone_is_cvxpys(variant, held):
    design = load_design("hyperleg", variant=variant)
    matrix, peak = (
        transmission.joint_from_motor(design, "walking"),
        motor_envelope(design).peak_torque,
    )
    for joint in range(3, len(matrix)):
        others = [i for i in (range(len(matrix)) if held is None else held) if i != joint]
        expected = largest(matrix, -peak, peak, np.eye(len(matrix))[joint], others)
        assert zonotope.alone(matrix, -peak, peak, joint, held) == pytest.approx(expected, rel=1e-6)


def test_a_motor_past_its_no_load_speed_leaves_no_torque_alone():
    design = load_design("hyperleg")
    matrix = transmission.joint_from_motor(design)
    moving = np.zeros(7)
    moving[5] = 25.0  # ankle roll, past 22.2 rad/s
    lower, upper = zonotope.speed_dependent(design, matrix, moving)
    assert np.isnan(zonotope.alone(matrix, lower, upper, 3))
    assert not zonotope.contains(matrix, lower, upper, np.zeros(7))
    assert zonotope.contains(matrix, lower, upper, matrix @ ((lower + upper) / 2))


def test_speed_dependence_is_the_motors_own():
    design = load_design("hyperleg")
    matrix, envelope = transmission.joint_from_motor(design), motor_envelope(design)
    still = zonotope.speed_dependent(design, matrix, np.zeros(7))
    np.testing.assert_array_equal(still, (-envelope.peak_torque, envelope.peak_torque))
    free = transmission.single_joint_speed(design)
    for joint in range(7):
        at = zonotope.support(
            matrix,
            *zonotope.speed_dependent(envelope, matrix, np.eye(7)[joint] * free[joint]),
            np.eye(7)[joint],
        )
        slow = zonotope.support(
            matrix,
            *zonotope.speed_dependent(envelope, matrix, np.eye(7)[joint] * 0.9 * free[joint]),
            np.eye(7)[joint],
        )
        assert at < slow
    assert zonotope.support(
        matrix, *zonotope.speed_dependent(envelope, matrix, np.eye(7)[5] * free[5]), np.eye(7)[5]
    ) == pytest.approx(0, abs=1e-9)


def test_batch_equals_each_set():
    design = load_design("hyperleg", variant="toe_locked").with_values(
        {
            "transmission.scale.knee": np.array([0.8, 1.0, 1.2]),
            "electrical.voltage_ratio": np.array([1.0, 0.8, 1.4]),
        }
    )
    matrix = transmission.joint_from_motor(design)
    lower, upper = zonotope.speed_dependent(design, matrix, np.full(6, 4.0))
    direction, point = np.arange(1.0, 7.0), np.full(6, 5.0)
    for i in range(3):
        one = matrix[i], lower[i], upper[i]
        assert zonotope.support(matrix, lower, upper, direction)[i] == pytest.approx(
            zonotope.support(*one, direction)
        )
        assert zonotope.volume(matrix, lower, upper)[i] == pytest.approx(zonotope.volume(*one))
        assert zonotope.zonotope_to_box_volume(matrix, lower, upper)[i] == pytest.approx(
            zonotope.zonotope_to_box_volume(*one)
        )
        assert zonotope.contains(matrix, lower, upper, point)[i] == zonotope.contains(*one, point)
        assert zonotope.alone(matrix, lower, upper, 4, [3])[i] == pytest.approx(
            zonotope.alone(*one, 4, [3]), nan_ok=True
        )
        np.testing.assert_allclose(
            np.array(zonotope.box(matrix, lower, upper))[:, i], zonotope.box(*one)
        )


def test_parallel_motors_are_no_trouble():
    matrix = np.array([[1.0, 2.0, 0.0], [0.0, 0.0, 3.0]])
    upper = np.ones(3)
    assert zonotope.volume(matrix, -upper, upper) == pytest.approx(36)
    assert zonotope.alone(matrix, -upper, upper, 0) == pytest.approx(3)
    np.testing.assert_array_equal(
        zonotope.contains(
            matrix, -upper, upper, np.array([[2.99, -2.99], [3.01, 0.0], [0.0, 3.01]])
        ),
        [True, False, False],
    )
    uncoupled = load_design(
        "hyperleg", variant="toe_locked", overrides={"transmission.scale.toe_ankle_pitch": 0.0}
    )
    drive, peak = transmission.joint_from_motor(uncoupled), motor_envelope(uncoupled).peak_torque
    assert zonotope.alone(drive, -peak, peak, 4) == pytest.approx(
        largest(drive, -peak, peak, np.eye(6)[4], [0, 1, 2, 3, 5]), rel=1e-6
    )


@pytest.mark.parametrize(
    ("matrix", "lower", "upper", "said"),
    [
        (np.eye(2), -np.ones(3), np.ones(3), "shapes"),
        (np.ones(3), -np.ones(3), np.ones(3), "shapes"),
        (np.eye(2), -np.ones(2), np.array([1.0, np.nan]), "finite"),
        (np.full((2, 2), np.inf), -np.ones(2), np.ones(2), "finite"),
        (np.eye(2), np.array([0.0, 2.0]), np.ones(2), "must not exceed"),
        (np.ones((2, 2)), -np.ones(2), np.ones(2), "driven by no motor"),
        (np.ones((2, 3)), -np.ones(3), np.ones(3), "driven by no motor"),
        (np.eye(3)[:, :2], -np.ones(2), np.ones(2), "driven by no motor"),
    ],
)
def test_what_is_no_set_is_refused(matrix, lower, upper, said):
    with pytest.raises(InputError, match=said):
        zonotope.halfspaces(matrix, lower, upper)
