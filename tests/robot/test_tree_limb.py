"""The limb of a written-out tree: M is the gradient of motor positions, rods keep their length."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot import tree_limb
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.masses import actuator_mass
from tests.robot.tree_files import SHIPPED, leg


@pytest.mark.parametrize("name", SHIPPED)
def test_joint_from_motor_is_the_gradient_of_motor_positions(name):
    design = load_robot(name)
    default = tree_limb.default_position(design)
    rng, step = np.random.default_rng(3), 1e-6
    for position in default + rng.uniform(-0.1, 0.1, (4, len(default))):
        numeric = np.stack(
            [
                tree_limb.motor_position(design, position + step * unit)
                - tree_limb.motor_position(design, position - step * unit)
                for unit in np.eye(len(default))
            ]
        ) / (2 * step)
        matrix = tree_limb.joint_from_motor(design, position)
        assert np.allclose(matrix, numeric, atol=1e-6)
    assert np.allclose(tree_limb.motor_position(design, np.zeros_like(default)), 0, atol=1e-12)


def test_rods_keep_their_length_and_power_is_the_same_on_both_sides():
    design = load_robot("parallel_ankle")
    rod = design.rod_sections["ankle_outer"]
    joints = list(design.joint_sections)
    position = np.zeros(len(joints))
    position[joints.index("ankle_pitch")], position[joints.index("ankle_roll")] = -0.4, 0.2
    turn = tree_limb.crank_turn(design, "ankle_outer", position)[0]

    def length(angles, crank):
        frames = tree_limb.link_frames(design, angles)
        arm = tree_limb.axis_rotation(rod.axis, crank) @ (rod.crank_end - rod.crank_axis)
        (carrier, place), (end, origin) = frames["shank"], frames["foot"]
        held = place + carrier @ (rod.crank_axis + arm)
        return np.linalg.norm(origin + end @ rod.rod_end - held)

    assert length(position, turn) == pytest.approx(length(0 * position, 0.0), abs=1e-12)
    rng = np.random.default_rng(0)
    torque, speed = rng.normal(size=6), rng.normal(size=6)
    matrix = tree_limb.joint_from_motor(design, position)
    assert (matrix @ torque) @ speed == pytest.approx(torque @ (matrix.T @ speed))


def test_ankle_motors_pitch_together_and_roll_against_each_other():
    design = load_robot("parallel_ankle")
    matrix = tree_limb.joint_from_motor(design)
    pitch, roll = matrix[4, 4:], matrix[5, 4:]
    assert pitch[0] == pytest.approx(pitch[1])
    assert roll[0] == pytest.approx(-roll[1])
    assert abs(roll[0]) > 1


def test_a_rod_that_does_not_reach_is_named():
    design = load_robot("parallel_ankle")
    design = design.with_values({"rods.ankle_outer.crank_end": [-0.03, 0.045, -0.12]})
    position = np.zeros(6)
    position[4] = np.deg2rad(60)
    with pytest.raises(InfeasibleError, match=r"ankle_(outer|inner).*does not reach"):
        tree_limb.joint_from_motor(design, position)


def test_another_motor_changes_the_mass_of_the_link_that_houses_it():
    design = leg()
    other = design.with_values({"actuators.knee.motor": "RI80"})
    per_torque = design.masses.gear_mass_per_torque
    change = actuator_mass("RI80", 9, per_torque) - actuator_mass("RI60", 9, per_torque)
    before, after = tree_limb.limb_masses(design), tree_limb.limb_masses(other)
    assert after.total - before.total == pytest.approx(change)
    assert after.links["thigh"].mass == pytest.approx(1.0 + change)
    fixed = other.with_values({"masses.law": "fixed"})
    assert tree_limb.limb_masses(fixed).total == before.total


def test_a_motor_in_the_trunk_counts_once_a_limb():
    design = load_robot("mini_cheetah")
    other = design.with_values({"actuators.abduction.gear": 9.0})
    change = tree_limb.limb_masses(other).trunk - tree_limb.limb_masses(design).trunk
    peak = 2.83
    assert change == pytest.approx(4 * 0.010 * 3 * peak)
    com = tree_limb.limb_masses(other).links["trunk"].com
    assert np.allclose(com[1:], 0, atol=1e-15)


def test_a_batch_is_its_robots_one_by_one():
    batch = load_robot("parallel_ankle").with_values(
        {
            "links.thigh.mass": np.array([4.4, 5.0, 6.0]),
            "joints.knee.position": np.array([[0, 0, -0.4], [0, 0, -0.42], [0, 0, -0.45]]),
            "rods.ankle_outer.crank_end": np.array(
                [[-0.05, 0.045, -0.12], [-0.04, 0.045, -0.12], [-0.06, 0.045, -0.12]]
            ),
            "actuators.knee.motor": np.array(["RI100", "RI80", "U10"]),
        }
    )
    assert batch.batch_shape == (3,)
    for index in range(3):
        one = batch.take(index)
        assert np.allclose(
            tree_limb.joint_from_motor(batch)[index], tree_limb.joint_from_motor(one)
        )
        assert tree_limb.limb_masses(batch).total[index] == tree_limb.limb_masses(one).total
        height = tree_limb.standing_height(batch)[index]
        assert height == pytest.approx(tree_limb.standing_height(one))
