from __future__ import annotations

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate, variants
from hyperleg_design.robot.motors import motor_arrays
from tests.robot.tree_files import leg

WALKING = np.zeros((7, 7))
WALKING[range(3), range(3)] = 25.0
WALKING[3, 3:] = -31.11
WALKING[4, 4:] = 26.69, 26.69, 19.23
WALKING[5, 4:6] = 16.51, -16.51
WALKING[6, 6] = 21.27
STANDING = WALKING.copy()
STANDING[4, 4:] = 26.00, 26.00, 24.14
STANDING[6, 6] = 31.93
PRINTED = {"walking": WALKING, "standing": STANDING}

vectors = st.lists(st.floats(-100, 100), min_size=7, max_size=7).map(np.array)


@pytest.mark.parametrize("posture", PRINTED)
def test_the_printed_matrices_entry_by_entry(hyperleg, posture):
    np.testing.assert_array_equal(
        transmission.joint_from_motor(hyperleg, posture), PRINTED[posture]
    )


def test_the_designs_own_posture_is_the_default(hyperleg):
    np.testing.assert_array_equal(transmission.joint_from_motor(hyperleg), WALKING)
    np.testing.assert_array_equal(
        transmission.joint_from_motor(hyperleg.with_values({"transmission.posture": "standing"})),
        STANDING,
    )
    with pytest.raises(InputError, match=r"running.*walking, standing"):
        transmission.joint_from_motor(hyperleg, "running")


def test_a_tree_has_one_posture_and_refuses_names_of_others():
    design = leg()
    for posture in ("default", "walking", "standing"):
        np.testing.assert_array_equal(
            transmission.joint_from_motor(design, posture), [[7.0, 0.0], [0.0, 9.0]]
        )
    for function in (transmission.joint_from_motor, transmission.max_joint_torque):
        with pytest.raises(InputError, match=r"posture.*garbage.*default"):
            function(design, "garbage")


def test_the_maxima_of_table_one(hyperleg):
    printed = [126.0, 126.0, 126.0, 212.0, 111.7, 48.4, 46.8]
    np.testing.assert_allclose(transmission.max_joint_torque(hyperleg), printed, rtol=1e-3)


def test_at_half_the_voltage_a_motor_gives_its_stall_torque_where_that_is_below_its_peak():
    motors = {"actuators.hip.motor": "MF0076008", "actuators.hip.gear": 20}
    design = leg().with_values({**motors, "electrical.voltage_ratio": 0.5})
    hip, knee = transmission.max_joint_torque(design)
    # w0 Kt^2 / R at half the speed, and the peak of the RI60, whose stall torque stays above it
    assert hip == pytest.approx(20 * 0.5 * (4249 * 2 * np.pi / 60) * 0.1**2 / 0.92)
    assert knee == pytest.approx(9 * 1.63)


def test_single_joint_speeds(hyperleg):
    np.testing.assert_allclose(
        transmission.single_joint_speed(hyperleg)[3:], [10.5, 13.7, 22.2, 17.2], atol=0.05
    )
    np.testing.assert_allclose(transmission.single_joint_speed(hyperleg)[:3], 12.0, rtol=1e-12)


def test_without_the_toe_motor(hyperleg):
    bare = ablate(hyperleg, "toe_removed")
    knee, ankle = transmission.max_joint_torque(bare)[3:5]
    assert (knee, ankle) == (pytest.approx(166, abs=0.5), pytest.approx(76.3, abs=0.05))


def test_shapes_of_the_variants(hyperleg):
    shapes = {
        name: transmission.joint_from_motor(v).shape for name, v in variants(hyperleg).items()
    }
    assert shapes == {
        "toe": (7, 7),
        "toe_locked": (6, 7),
        "toe_removed_matched": (6, 6),
        "toe_removed": (6, 6),
    }


@given(torque=vectors, velocity=vectors)
def test_power_is_the_same_on_both_sides(hyperleg, torque, velocity):
    for variant in variants(hyperleg).values():
        matrix = transmission.joint_from_motor(variant)
        joints, motors = matrix.shape
        motor_torque, joint_velocity = torque[:motors], velocity[:joints]
        at_joint = transmission.joint_torque(matrix, motor_torque) * joint_velocity
        at_motor = transmission.motor_velocity(matrix, joint_velocity) * motor_torque
        scale = np.abs(matrix).T @ np.abs(joint_velocity) @ np.abs(motor_torque)
        assert abs(at_joint.sum() - at_motor.sum()) <= 4e-15 * scale


@given(torque=vectors)
def test_motor_torques_give_back_the_joint_torques(hyperleg, torque):
    for variant in variants(hyperleg).values():
        matrix = transmission.joint_from_motor(variant)
        wanted = torque[: len(matrix)]
        found = transmission.joint_torque(matrix, transmission.motor_torque(matrix, wanted))
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13 * (1 + np.abs(wanted).max()))


@given(torque=vectors)
@settings(max_examples=20)
def test_least_heat_against_least_squares(hyperleg, torque):
    """Minimum of sum C tau^2 at M tau = t: the minimum-norm solution in the variables sqrt(C)
    tau.
    """
    locked = ablate(hyperleg, "toe_locked")
    matrix, heat = transmission.joint_from_motor(locked), motor_arrays(locked).power_constant
    ours = transmission.motor_torque(matrix, torque[:6], heat)
    theirs = np.linalg.lstsq(matrix / np.sqrt(heat), torque[:6], rcond=None)[0] / np.sqrt(heat)
    np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-11)


def test_least_heat_against_cvxpy(hyperleg, rng):
    locked = ablate(hyperleg, "toe_locked")
    matrix, heat = transmission.joint_from_motor(locked), motor_arrays(locked).power_constant
    for _ in range(3):
        wanted = rng.normal(size=6) * 30
        tau = cp.Variable(7)
        problem = cp.Problem(
            cp.Minimize(cp.sum(cp.multiply(heat, cp.square(tau)))), [matrix @ tau == wanted]
        )
        problem.solve(solver=cp.CLARABEL)
        ours = transmission.motor_torque(matrix, wanted, heat)
        np.testing.assert_allclose(ours, tau.value, atol=1e-5)
        assert np.sum(heat * ours**2) <= problem.value * (1 + 1e-7)


@given(
    rotor=st.lists(st.floats(1e-7, 1e-3), min_size=7, max_size=7).map(np.array), velocity=vectors
)
def test_reflected_inertia_keeps_the_kinetic_energy(hyperleg, rotor, velocity):
    matrix = transmission.joint_from_motor(hyperleg)
    reflected = transmission.reflected_inertia(matrix, rotor)
    assert velocity @ reflected @ velocity == pytest.approx(
        rotor @ transmission.motor_velocity(matrix, velocity) ** 2, rel=1e-12, abs=1e-12
    )
    np.testing.assert_allclose(reflected, reflected.T, atol=1e-14 * np.abs(reflected).max())
    assert np.linalg.eigvalsh(reflected)[0] > 0


def test_knee_and_ankle_share_rotors(hyperleg):
    reflected = transmission.reflected_inertia(
        transmission.joint_from_motor(hyperleg), motor_arrays(hyperleg).rotor_inertia
    )
    assert reflected[3, 4] == pytest.approx(-31.11 * 33.05e-7 * (26.69 * 2 + 19.23), rel=1e-12)
    assert reflected[3, 5] == pytest.approx(0, abs=1e-15)


def test_gears_scale_columns_and_levers_scale_rows(hyperleg):
    made = hyperleg.with_values(
        {"actuators.ankle.gear": 14, "transmission.scale.knee": 0.5, "actuators.hip_yaw.gear": 10}
    )
    expected = WALKING.copy()
    expected[3] *= 0.5
    expected[:, 4:6] *= 2
    expected[0, 0] = 10
    np.testing.assert_allclose(transmission.joint_from_motor(made), expected, rtol=1e-15)


def test_the_toe_decouples_from_the_ankle_at_scale_zero(hyperleg):
    matrix = transmission.joint_from_motor(
        hyperleg.with_values({"transmission.scale.toe_ankle_pitch": 0})
    )
    assert matrix[4, 6] == 0
    assert np.linalg.matrix_rank(matrix) == 7


def test_a_batch_is_its_designs(hyperleg):
    batch = hyperleg.with_values(
        {
            "transmission.scale.toe": np.linspace(0.5, 2, 4),
            "actuators.knee.gear": np.linspace(5, 9, 4),
            "actuators.ankle.derate": np.linspace(0.5, 1, 4),
        }
    )
    torque = np.arange(28.0).reshape(4, 7)
    functions = {
        "matrix": transmission.joint_from_motor,
        "torque": transmission.max_joint_torque,
        "speed": transmission.single_joint_speed,
        "derate": transmission.derate,
        "gears": transmission.gear_ratios,
    }
    for index in range(4):
        for function in functions.values():
            np.testing.assert_array_equal(function(batch)[index], function(batch.take(index)))
        many, one = (
            transmission.motor_torque(transmission.joint_from_motor(batch), torque),
            transmission.motor_torque(
                transmission.joint_from_motor(batch.take(index)), torque[index]
            ),
        )
        np.testing.assert_allclose(many[index], one, rtol=1e-13, atol=1e-14)
