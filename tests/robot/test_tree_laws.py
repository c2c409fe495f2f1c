"""Friction and gear laws on robots that write their tree out."""

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.load import load_robot, robot_from_mapping
from hyperleg_design.robot.motors import find_motor, motor_arrays

LAWS = {
    "friction.law": "reflected",
    "friction.motor_share": 0.5,
    "gears.law": "catalogue",
    "gears.inertia_per_torque": 7e-9,
    "gears.loss_per_doubling": 0.011,
}
SHIPPED = ["mini_cheetah", "parallel_ankle", "teaching_leg"]


@pytest.mark.parametrize("name", SHIPPED)
def test_laws_change_nothing_at_the_build_that_the_file_describes(name):
    declared, lawful = load_robot(name), load_robot(name, overrides=LAWS)
    for one, other in zip(joint_friction(declared), joint_friction(lawful), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(rotor_inertia(declared), rotor_inertia(lawful))


def test_friction_of_a_larger_gear_by_hand():
    """Half of the Coulomb friction grows with the gear, half of the viscous one with its square,
    and 1.1 % of the rated torque is lost for each doubling.
    """
    robot = load_robot("mini_cheetah", overrides=LAWS | {"actuators.knee.gear": 12.0})
    coulomb, viscous = joint_friction(robot)
    rated = find_motor("MiniCheetah").rated_torque
    loss = 0.011 * np.log2(2.0) * 12 * 1.555 * rated
    np.testing.assert_allclose(coulomb, [0.2, 0.2, 0.2 * 1.5 + loss], rtol=1e-12)
    np.testing.assert_allclose(viscous, [0.01, 0.01, 0.01 * (0.5 + 0.5 * 4)], rtol=1e-12)
    peak = find_motor("MiniCheetah").peak_torque("vendor")
    grown = 7e-9 * ((12 * peak) ** (5 / 3) - (6 * peak) ** (5 / 3))
    rotors = motor_arrays(robot).rotor_inertia
    np.testing.assert_allclose(rotor_inertia(robot) - rotors, [0, 0, grown], rtol=1e-9, atol=0)


def test_both_motors_of_a_parallel_ankle_share_its_friction():
    robot = load_robot("parallel_ankle", overrides=LAWS | {"gears.law": "declared"})
    changed = robot.with_values(
        {
            f"actuators.{m}.gear": 2 * robot[f"actuators.{m}.gear"]
            for m in ("ankle_outer", "ankle_inner")
        }
    )
    before, after = joint_friction(robot)[0], joint_friction(changed)[0]
    np.testing.assert_allclose(after[:4], before[:4])
    np.testing.assert_allclose(after[4:], 1.5 * before[4:], rtol=1e-9)


def test_models_have_the_friction_of_the_law():
    robot = load_robot("mini_cheetah", overrides=LAWS | {"actuators.knee.gear": 12.0})
    knees = [j for j in build_tree(robot).moving if j.name.endswith("knee")]
    assert [j.coulomb for j in knees] == pytest.approx([joint_friction(robot)[0][2]] * 4)


def test_a_batch_has_the_friction_of_each_of_its_robots():
    gears = np.array([4.0, 6.0, 9.0])
    batch = load_robot("mini_cheetah", overrides=LAWS).with_values({"actuators.knee.gear": gears})
    coulomb = joint_friction(batch)[0]
    for i in range(3):
        np.testing.assert_allclose(coulomb[i], joint_friction(batch.take(i))[0])


@pytest.mark.parametrize("section", ["friction", "gears"])
def test_an_unknown_law_is_an_error_when_the_file_is_read(section):
    with pytest.raises(InputError, match=rf"{section}\.law.*expects one of"):
        load_robot("mini_cheetah", overrides=[f"{section}.law=guessed"])


@pytest.mark.parametrize("name", SHIPPED)
def test_laws_survive_a_round_trip_through_a_mapping(name):
    robot = load_robot(name, overrides=LAWS)
    again = robot_from_mapping(robot.to_mapping(), name)
    assert again["friction.law"] == "reflected"
    assert again["gears.loss_per_doubling"] == 0.011
