import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.names import VARIANTS
from hyperleg_design.sizing.energy import (
    cost_of_transport,
    energy_ledger,
    joint_power,
)

SAMPLES = arrays(float, (5, 3), elements=st.floats(-1e3, 1e3))
CP = np.array([3.54, 33.44, 124.57])


@settings(max_examples=80)
@given(torque=SAMPLES, velocity=SAMPLES, out=st.floats(0.05, 1), regen=st.floats(0, 1))
def test_balance_closes_for_every_motor_and_in_sum(torque, velocity, out, regen):
    ledger = energy_ledger(torque, velocity, 0.002, CP, out, regen)
    assert np.max(ledger.residual()) < 1e-9
    sums = ledger.energy()
    assert np.max(sums.residual()) < 1e-9
    assert sums.total().residual() < 1e-9
    for part in (ledger.joule, ledger.driver_loss, ledger.drawn, ledger.returned):
        assert np.all(part >= 0)
    # the battery never gets more, nor gives less, than the motors' side
    assert np.all(ledger.battery >= ledger.motor_side - 1e-9 * np.abs(ledger.motor_side))


def test_one_motor_by_hand():
    # drives at 2 Nm and 10 rad/s, brakes at 2 Nm and -50 rad/s, brakes too slowly to give anything
    # back
    ledger = energy_ledger([[2.0], [2.0], [2.0]], [[10.0], [-50.0], [-5.0]], 0.5, [3.0], 0.9, 0.8)
    np.testing.assert_allclose(ledger.joule[:, 0], 12.0)
    np.testing.assert_allclose(ledger.mechanical[:, 0], [20, -100, -10])
    np.testing.assert_allclose(ledger.motor_side[:, 0], [32, -88, 2])
    np.testing.assert_allclose(ledger.battery[:, 0], [32 / 0.9, -88 * 0.8, 2 / 0.9])
    np.testing.assert_allclose(ledger.driver_loss[:, 0], [32 / 0.9 - 32, 88 * 0.2, 2 / 0.9 - 2])
    energy, power = ledger.energy(), ledger.mean_power()
    assert energy.joule[0] == pytest.approx(18)
    assert energy.mechanical_positive[0] == pytest.approx(10)
    assert energy.mechanical_negative[0] == pytest.approx(-55)
    assert energy.mechanical_absolute[0] == pytest.approx(65)
    assert energy.returned[0] == pytest.approx(0.5 * 70.4)
    assert energy.motor_side[0] == pytest.approx(-27)
    assert power.battery[0] * ledger.duration == pytest.approx(energy.battery[0])


def test_perfect_drivers_leave_the_papers_total():
    rng = np.random.default_rng(1)
    ledger = energy_ledger(
        rng.normal(size=(2, 50, 3)), 100 * rng.normal(size=(2, 50, 3)), 0.01, CP, 1.0, 1.0
    )
    np.testing.assert_allclose(ledger.battery, ledger.motor_side, rtol=1e-12, atol=1e-9)
    assert not np.any(ledger.driver_loss)
    # without regeneration the battery sees only what is drawn
    assert not np.any(energy_ledger([[1.0]], [[-900.0]], 0.01, [1.0], 1.0, 0.0).battery)


@settings(max_examples=30)
@given(
    seed=st.integers(0, 10_000),
    variant=st.sampled_from(VARIANTS),
    posture=st.sampled_from(["walking", "standing"]),
)
def test_joint_powers_sum_to_the_motors(seed, variant, posture):
    design = load_design("hyperleg", variant=variant)
    matrix = transmission.joint_from_motor(design, posture)
    rng = np.random.default_rng(seed)
    motor_torque = rng.normal(size=(40, matrix.shape[1]))
    joint_velocity = 5 * rng.normal(size=(40, matrix.shape[0]))
    constants = motor_arrays(design).power_constant[: matrix.shape[1]]
    velocity = transmission.motor_velocity(matrix, joint_velocity)
    ledger = energy_ledger(motor_torque, velocity, 0.005, constants)
    joints = joint_power(transmission.joint_torque(matrix, motor_torque), joint_velocity)
    np.testing.assert_allclose(joints.sum(-1), ledger.mechanical.sum(-1), atol=1e-9)
    assert ledger.joule[0, 4] == pytest.approx(124.57 * motor_torque[0, 4] ** 2, rel=2e-3)


def test_table_three_adds_up_on_the_motor_side():
    # Joule 125.9 W and mechanical 134.3 W make 260.2 W without driver losses
    ledger = energy_ledger(
        [[np.sqrt(125.9 / 3.54)]], [[134.3 / np.sqrt(125.9 / 3.54)]], 1.0, [3.54]
    )
    assert ledger.motor_side[0, 0] == pytest.approx(260.2, abs=0.05)
    assert ledger.battery[0, 0] == pytest.approx(260.2 / 0.9, abs=0.1)


def test_costs_of_transport_of_the_paper_at_its_two_speeds():
    # energy in a second, and over 20 m
    np.testing.assert_allclose(
        cost_of_transport([260.2, 313.0], 32.0, 1.33), [0.623, 0.750], atol=5e-4
    )
    np.testing.assert_allclose(
        cost_of_transport(np.array([260.2 * 15.96, 313.0 * 16.13]), 32.0, 20.0),
        [0.661, 0.804],
        atol=5e-4,
    )


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"motor_torque": [1.0, 2.0]}, "motor_torque"),
        ({"motor_torque": np.zeros((0, 3))}, "motor_torque"),
        ({"motor_torque": np.full((4, 3), np.nan)}, "motor_torque"),
        ({"motor_velocity": np.zeros((5, 3))}, "motor_velocity"),
        ({"time_step": 0.0}, "time_step"),
        ({"time_step": np.nan}, "time_step"),
        ({"power_constant": [1.0, 2.0]}, "power_constant"),
        ({"power_constant": [1.0, 2.0, -3.0]}, "power_constant"),
        ({"efficiency_out": 0.0}, "efficiency_out"),
        ({"efficiency_out": 90}, "efficiency_out"),
        ({"efficiency_regen": -0.1}, "efficiency_regen"),
    ],
)
def test_bad_input_is_one_error_that_names_the_field(change, field):
    good = {
        "motor_torque": np.zeros((4, 3)),
        "motor_velocity": np.zeros((4, 3)),
        "time_step": 0.01,
        "power_constant": CP,
    }
    with pytest.raises(InputError) as caught:
        energy_ledger(**{**good, **change})
    assert caught.value.field == field


def test_no_cost_without_transport():
    for bad in (0.0, -1.0, np.nan, np.array([1.0, 0.0])):
        with pytest.raises(InputError, match="distance"):
            cost_of_transport(100.0, 32.0, bad)
    with pytest.raises(InputError, match="mass"):
        cost_of_transport(100.0, 0.0, 1.0)
    with pytest.raises(InputError, match="distance"):
        cost_of_transport(100.0, 32.0, 0.0)
    with pytest.raises(InputError, match="joint_velocity"):
        joint_power(np.zeros((3, 7)), np.zeros((3, 6)))
