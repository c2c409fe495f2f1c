import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.simulation.drives import actuation
from hyperleg_design.sizing.envelope import clip_torque, motor_envelope

DESIGNS = {name: ablate(load_design(), name) for name in VARIANTS}
seeds = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("name", VARIANTS)
@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_motor_power_equals_joint_power(name, seed):
    rng = np.random.default_rng(seed)
    model = actuation.actuation_model(DESIGNS[name])
    joints, motors = model.joint_from_motor.shape
    torque, velocity = rng.normal(size=(5, 2, motors)), rng.normal(size=(5, 2, joints))
    speed = actuation.motor_speed(model.joint_from_motor, velocity)
    joint_torque = actuation.applied(model.joint_from_motor, torque)
    at_motors = (torque * speed).sum(-1)
    at_joints = (joint_torque * velocity).sum(-1)
    np.testing.assert_allclose(at_motors, at_joints, rtol=1e-10, atol=1e-9)


@pytest.mark.parametrize("name", VARIANTS)
def test_map_to_motors_gives_the_joint_torques_at_least_heat(name):
    rng = np.random.default_rng(0)
    model = actuation.actuation_model(DESIGNS[name])
    wanted = rng.normal(size=(4, 2, len(model.stiffness))) * 20
    torque = actuation.applied(model.motor_from_joint, wanted)
    np.testing.assert_allclose(actuation.applied(model.joint_from_motor, torque), wanted, atol=1e-9)
    expected = transmission.motor_torque(
        model.joint_from_motor, wanted, model.envelope.power_constant
    )
    np.testing.assert_allclose(torque, expected, atol=1e-10)
    null = np.linalg.svd(model.joint_from_motor)[2][len(model.stiffness) :]
    heat = (model.envelope.power_constant * torque**2).sum(-1)
    for direction in null:
        for sign in (1e-3, -1e-3):
            assert np.all(
                (model.envelope.power_constant * (torque + sign * direction) ** 2).sum(-1) > heat
            )


@settings(max_examples=30, deadline=None)
@given(seed=seeds)
def test_drive_is_the_envelope_clip(seed):
    rng = np.random.default_rng(seed)
    model = actuation.actuation_model(DESIGNS["toe"])
    wanted, speed = rng.normal(size=(6, 2, 7)) * 200, rng.normal(size=(6, 2, 7)) * 400
    torque = actuation.driven_torque(model, wanted, speed)
    expected = clip_torque(
        motor_envelope(DESIGNS["toe"]),
        np.linalg.solve(model.joint_from_motor, wanted[..., None])[..., 0],
        speed,
    )
    np.testing.assert_allclose(torque, expected, atol=1e-9)


def four_quadrant(wanted, speed, constant, resistance, voltage, current):
    """One winding on a bus, its driver's voltage and current both limited, by Ohm's law."""
    asked = resistance * wanted / constant + constant * speed
    given = (max(-voltage, min(voltage, asked)) - constant * speed) / resistance
    return constant * max(-current, min(current, given))


@settings(max_examples=60, deadline=None)
@given(
    torque=st.lists(st.floats(-20, 20), min_size=7, max_size=7).map(np.array),
    over=st.lists(st.floats(-3, 3), min_size=7, max_size=7).map(np.array),
)
def test_drive_is_the_four_quadrant_motor(torque, over):
    """Far past no-load speed as well, where the voltage's bounds leave the torque's limits: up to
    1.06 times no-load speed at the hip, where the peak torque is 1 / 17 of the stall torque.
    """
    model = actuation.actuation_model(DESIGNS["toe"])
    limits = model.envelope
    speed = over * limits.no_load_speed
    given_torque = actuation.driven_torque(
        model,
        np.tile(model.joint_from_motor @ torque, (1, 2, 1)),
        np.tile(speed, (1, 2, 1)),
    )
    constant = 0.1  # of any winding; the limits fix the rest
    expected = [
        four_quadrant(t, w, constant, constant**2 * heat, constant * free, peak / constant)
        for t, w, heat, free, peak in zip(
            torque,
            speed,
            limits.power_constant,
            limits.no_load_speed,
            limits.peak_torque,
            strict=True,
        )
    ]
    np.testing.assert_allclose(given_torque[0, 0], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(given_torque[0, 0], given_torque[0, 1])
    past = np.abs(over) > 1
    assert np.all((given_torque[0, 0] * speed)[past] < 0)  # it brakes, and never drives


def test_drive_gives_what_is_wanted_inside_the_envelope():
    model = actuation.actuation_model(DESIGNS["toe"])
    wanted = np.full((1, 2, 7), 5.0)
    torque = actuation.driven_torque(model, wanted, np.zeros((1, 2, 7)))
    np.testing.assert_allclose(
        actuation.applied(model.joint_from_motor, torque), wanted, atol=1e-10
    )


@given(velocity=st.floats(-50, 50), width=st.floats(0.01, 1))
def test_friction_damping_times_velocity_is_the_friction(velocity, width):
    coulomb, viscous, velocity = np.array([5.59]), np.array([0.1]), np.array([velocity])
    torque = actuation.friction_torque(coulomb, viscous, velocity, width)
    damping = actuation.friction_damping(coulomb, viscous, velocity, width)
    np.testing.assert_allclose(damping * velocity, torque, rtol=1e-9, atol=1e-12)
    assert torque * velocity >= 0


def test_friction_at_rest_is_its_slope():
    damping = actuation.friction_damping(np.array([3.3]), np.array([0.08]), np.zeros(1), 0.1)
    assert damping == pytest.approx(33.08)


def test_motor_friction_is_exact_where_a_motor_has_its_own_joint():
    design = DESIGNS["toe"]
    coulomb, viscous = actuation.motor_friction(design)
    np.testing.assert_allclose(coulomb[:3], 3.30 / 25)
    np.testing.assert_allclose(viscous[:3], 0.08 / 25**2)
    assert np.all(coulomb >= 0)
    assert np.all(viscous >= 0)
    # The printed joint values cannot all come from motors that share joints: ankle pitch would meet
    # more than printed.
    met = np.abs(transmission.joint_from_motor(design)) @ coulomb
    assert not np.allclose(met, actuation.actuation_model(design).coulomb, rtol=0.05)


def test_smoothing_is_a_moving_average_of_the_actions():
    actions = np.random.default_rng(0).normal(size=(30, 2, 3))
    value = np.zeros((2, 3))
    for action in actions:
        value = actuation.smoothed_action(value, action, 0.2)
    weights = 0.2 * 0.8 ** np.arange(29, -1, -1)
    np.testing.assert_allclose(value, np.einsum("t,tij->ij", weights, actions))


def test_a_batch_of_designs_is_each_design():
    batch = DESIGNS["toe"].with_values(
        {
            "transmission.scale.knee": np.array([0.8, 1.0, 1.3]),
            "joints.knee.stiffness": np.array([100.0, 120.0, 90.0]),
        }
    )
    rng = np.random.default_rng(1)
    target, position, velocity = rng.normal(size=(3, 3, 2, 7))
    model = actuation.actuation_model(batch)
    speed = actuation.motor_speed(model.joint_from_motor, velocity)
    torque = actuation.driven_torque(
        model, actuation.controller_torque(model, target, position, velocity), speed
    )
    for i in range(3):
        one = actuation.actuation_model(batch.take(i))
        alone = actuation.motor_speed(one.joint_from_motor, velocity[i])
        np.testing.assert_allclose(speed[i], alone, atol=1e-9)
        wanted = actuation.controller_torque(one, target[i], position[i], velocity[i])
        np.testing.assert_allclose(
            torque[i], actuation.driven_torque(one, wanted, alone), atol=1e-9
        )
