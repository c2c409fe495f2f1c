"""M is the gradient of motor positions, and rods keep their length."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.trees import limb_actuation, tree_limb
from tests.robot.tree_files import SHIPPED


@pytest.mark.parametrize("name", SHIPPED)
def test_joint_from_motor_is_the_gradient_of_motor_positions(name):
    design = load_robot(name)
    default = tree_limb.default_position(design)
    rng, step = np.random.default_rng(3), 1e-6
    for position in default + rng.uniform(-0.1, 0.1, (4, len(default))):
        numeric = np.stack(
            [
                limb_actuation.motor_position(design, position + step * unit)
                - limb_actuation.motor_position(design, position - step * unit)
                for unit in np.eye(len(default))
            ]
        ) / (2 * step)
        matrix = limb_actuation.joint_from_motor(design, position)
        assert np.allclose(matrix, numeric, atol=1e-6)
    assert np.allclose(limb_actuation.motor_position(design, np.zeros_like(default)), 0, atol=1e-12)


def test_rods_keep_their_length_and_power_is_the_same_on_both_sides():
    design = load_robot("parallel_ankle")
    rod = design.rod_sections["ankle_outer"]
    joints = list(design.joint_sections)
    position = np.zeros(len(joints))
    position[joints.index("ankle_pitch")], position[joints.index("ankle_roll")] = -0.4, 0.2
    turn = limb_actuation.crank_turn(design, "ankle_outer", position)[0]

    def length(angles, crank):
        frames = tree_limb.link_frames(design, angles)
        arm = tree_limb.axis_rotation(rod.axis, crank) @ (rod.crank_end - rod.crank_axis)
        (carrier, place), (end, origin) = frames["shank"], frames["foot"]
        held = place + carrier @ (rod.crank_axis + arm)
        return np.linalg.norm(origin + end @ rod.rod_end - held)

    assert length(position, turn) == pytest.approx(length(0 * position, 0.0), abs=1e-12)
    rng = np.random.default_rng(0)
    torque, speed = rng.normal(size=6), rng.normal(size=6)
    matrix = limb_actuation.joint_from_motor(design, position)
    assert (matrix @ torque) @ speed == pytest.approx(torque @ (matrix.T @ speed))


def test_ankle_motors_pitch_together_and_roll_against_each_other():
    design = load_robot("parallel_ankle")
    matrix = limb_actuation.joint_from_motor(design)
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
        limb_actuation.joint_from_motor(design, position)
