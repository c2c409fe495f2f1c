"""The limb of a written-out tree: a batch is its robots one by one."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.trees import limb_actuation, limb_masses, tree_limb


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
            limb_actuation.joint_from_motor(batch)[index], limb_actuation.joint_from_motor(one)
        )
        assert limb_masses.limb_masses(batch).total[index] == limb_masses.limb_masses(one).total
        height = tree_limb.standing_height(batch)[index]
        assert height == pytest.approx(tree_limb.standing_height(one))
