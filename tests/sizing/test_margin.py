import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits
from hyperleg_design.sizing.margin import margin, trajectory_margin

SEEDS = st.integers(0, 2**32 - 1)


def random_set(seed, joints, motors):
    rng = np.random.default_rng(seed)
    return (
        rng,
        rng.normal(size=(joints, motors)) * 20,
        -rng.uniform(0.5, 3, motors),
        rng.uniform(0.5, 7, motors),
    )


@settings(max_examples=40, deadline=None)
@given(seed=SEEDS, reach=st.floats(0.1, 2))
def test_with_as_many_motors_as_joints_it_is_read_off_the_motors(seed, reach):
    rng, matrix, lower, upper = random_set(seed, 5, 5)
    motor = reach * rng.uniform(lower, upper)
    found = margin(matrix, lower, upper, matrix @ motor)
    share = np.maximum(motor / upper, motor / lower)
    assert found.load == pytest.approx(share.max(), rel=1e-8)
    assert found.motor == np.argmax(share)
    assert found.slack == pytest.approx(
        np.minimum(upper - motor, motor - lower).min(), rel=1e-8, abs=1e-9
    )


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(6, 7), (3, 5)]), reach=st.floats(0.2, 2))
def test_with_more_motors_it_is_cvxpys(seed, shape, reach):
    rng, matrix, lower, upper = random_set(seed, *shape)
    torque = reach * matrix @ rng.uniform(lower, upper)
    motor, load, slack = cp.Variable(shape[1]), cp.Variable(), cp.Variable()
    cp.Problem(
        cp.Minimize(load), [matrix @ motor == torque, motor <= load * upper, motor >= load * lower]
    ).solve(solver=cp.CLARABEL)
    cp.Problem(
        cp.Maximize(slack),
        [matrix @ motor == torque, motor <= upper - slack, motor >= lower + slack],
    ).solve(solver=cp.CLARABEL)
    found = margin(matrix, lower, upper, torque)
    assert found.load == pytest.approx(load.value, rel=1e-5, abs=1e-6)
    assert found.slack == pytest.approx(slack.value, rel=1e-5, abs=1e-5)


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS, reach=st.floats(0.2, 1.5))
def test_with_a_motor_that_must_brake_it_is_cvxpys_too(seed, reach):
    rng, matrix, lower, upper = random_set(seed, 3, 5)
    upper[0], lower[1] = 0.3 * lower[0], 0.4 * upper[1]
    torque = matrix @ (reach * rng.uniform(lower, upper))
    motor, load = cp.Variable(5), cp.Variable(nonneg=True)
    limits = [
        motor[0] >= load * lower[0],
        motor[0] <= upper[0],
        motor[1] <= load * upper[1],
        motor[1] >= lower[1],
    ]
    limits += [motor[2:] <= load * upper[2:], motor[2:] >= load * lower[2:]]
    problem = cp.Problem(cp.Minimize(load), [matrix @ motor == torque, *limits])
    problem.solve(solver=cp.CLARABEL)
    found = margin(matrix, lower, upper, torque)
    if problem.status == "infeasible":
        assert np.isinf(found.load)
    else:
        assert found.load == pytest.approx(load.value, rel=1e-5, abs=1e-6)


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, shape=st.sampled_from([(4, 4), (6, 7)]))
def test_both_measures_agree_on_what_is_inside(seed, shape):
    rng, matrix, lower, upper = random_set(seed, *shape)
    torque = rng.uniform(*zonotope.box(matrix, lower, upper), (50, shape[0])) * rng.uniform(
        0, 1, (50, 1)
    )
    found = margin(matrix, lower, upper, torque)
    inside = zonotope.contains(matrix, lower, upper, torque)
    np.testing.assert_array_equal(found.inside, inside)
    np.testing.assert_array_equal(found.slack >= 0, inside)
    np.testing.assert_allclose(
        margin(matrix, lower, upper, 1.7 * torque).load, 1.7 * found.load, rtol=1e-9
    )
    edge = margin(matrix, lower, upper, torque / found.load[:, None])
    np.testing.assert_allclose(edge.load, 1, rtol=1e-9)
    np.testing.assert_allclose(edge.slack, 0, atol=1e-8)


def test_no_torque_is_no_load_and_the_weakest_motor_has_the_slack():
    design = load_design("hyperleg")
    peak = motor_envelope(design).peak_torque
    found = margin(transmission.joint_from_motor(design), -peak, peak, np.zeros(7))
    assert (found.load, found.slack) == (0, pytest.approx(1.63))


def test_a_single_joint_torque_loads_the_leg_as_much_as_it_is_of_the_largest():
    for variant in ("toe", "toe_locked", "toe_removed"):
        design = load_design("hyperleg", variant=variant)
        matrix, peak = transmission.joint_from_motor(design), motor_envelope(design).peak_torque
        for joint in range(len(matrix)):
            largest = zonotope.alone(matrix, -peak, peak, joint)
            assert margin(
                matrix, -peak, peak, np.eye(len(matrix))[joint] * 30
            ).load == pytest.approx(30 / largest)


def test_past_no_load_speed_too_little_braking_is_infinite_load():
    envelope = motor_envelope(load_design("hyperleg")).select([4])
    lower, upper = torque_limits(envelope, 1.2 * envelope.no_load_speed)
    assert upper < 0
    torque = np.array([[0.5 * upper[0]], [upper[0]], [lower[0]], [1.5 * lower[0]], [0.0]])
    found = margin(np.eye(1), lower, upper, torque)
    np.testing.assert_allclose(found.load, [np.inf, upper[0] / lower[0], 1, 1.5, np.inf])
    assert found.inside.tolist() == [False, True, True, False, False]
    assert np.sign(np.round(found.slack, 12)).tolist() == [-1, 0, 0, -1, -1]


def test_trajectory_uses_each_samples_speed_and_names_the_motor():
    design = load_design("hyperleg")
    matrix, envelope = transmission.joint_from_motor(design), motor_envelope(design)
    rng = np.random.default_rng(3)
    torque, velocity = rng.normal(size=(40, 7)) * 20, rng.normal(size=(40, 7)) * 3
    found = trajectory_margin(matrix, envelope, torque, velocity)
    assert found.load.shape == found.slack.shape == found.motor.shape == (40,)
    motor, speed = np.linalg.solve(matrix, torque.T).T, velocity @ matrix
    for i in range(40):
        limits = torque_limits(envelope, speed[i])
        one = margin(matrix, *limits, torque[i])
        assert (found.load[i], found.slack[i], found.motor[i]) == (
            pytest.approx(one.load),
            pytest.approx(one.slack),
            one.motor,
        )
        at = found.motor[i]
        assert found.load[i] == pytest.approx(
            max(motor[i, at] / limits[0][at], motor[i, at] / limits[1][at])
        )
    assert found.worst == int(np.argmax(found.load))
    # the same motion with a matrix for each sample
    each = trajectory_margin(np.tile(matrix, (40, 1, 1)), envelope, torque, velocity)
    np.testing.assert_allclose(each.load, found.load)


def test_faster_motion_never_gains_margin_against_driving():
    design = load_design("hyperleg")
    matrix, envelope = transmission.joint_from_motor(design), motor_envelope(design)
    torque, velocity = np.zeros((30, 7)), np.zeros((30, 7))
    torque[:, 4], velocity[:, 4] = 40, np.linspace(0, 13, 30)
    load = trajectory_margin(matrix, envelope, torque, velocity).load
    assert np.all(np.diff(load) >= -1e-12)
    assert load[0] < 1 < load[-1]


def test_bad_input_is_refused():
    design = load_design("hyperleg")
    matrix, envelope = transmission.joint_from_motor(design), motor_envelope(design)
    peak = envelope.peak_torque
    with pytest.raises(InputError, match="torque"):
        margin(matrix, -peak, peak, np.zeros(6))
    with pytest.raises(InputError, match="torque"):
        margin(matrix, -peak, peak, np.full(7, np.nan))
    with pytest.raises(InputError, match="velocity"):
        trajectory_margin(matrix, envelope, np.zeros((5, 7)), np.zeros((4, 7)))
    with pytest.raises(InputError, match="velocity"):
        trajectory_margin(matrix, envelope, np.zeros((5, 7)), np.full((5, 7), np.inf))
