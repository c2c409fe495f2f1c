"""What every family of designs can do: leaves by path, batches, and robots taken out of them."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.robot.transmission import max_joint_torque

GEARS = np.array([5.0, 6.0, 8.0])


@pytest.fixture(scope="module", params=["hyperleg", "teaching_leg", "parallel_ankle"])
def design(request):
    return load_robot(request.param)


def test_a_leaf_is_found_by_its_path_and_a_wrong_path_names_the_nearest(design):
    assert design["actuators.knee.gear"] == design.actuators.knee.gear
    with pytest.raises(InputError, match=r"did you mean actuators\.knee\.gear\?"):
        design["actuators.knee.gears"]


def test_robots_of_a_batch_are_the_single_robots(design):
    batch = design.with_values({"actuators.knee.gear": GEARS})
    assert batch.batch_shape == (3,)
    assert batch.batch_sizes() == {"actuators.knee.gear": 3}
    for index, gear in enumerate(GEARS):
        single = batch.take(index)
        assert single.batch_shape == ()
        assert float(single["actuators.knee.gear"]) == gear
        np.testing.assert_array_equal(max_joint_torque(single), max_joint_torque(batch)[index])
    assert design.take(5) is design


def test_rows_repeat_robots_to_the_last_digit(design):
    batch = design.with_values({"actuators.knee.gear": GEARS})
    index = np.array([2, 0, 0])
    rows = batch.rows(index)
    np.testing.assert_array_equal(max_joint_torque(rows), max_joint_torque(batch)[index])
    copies = design.rows(np.zeros(4, int))
    assert copies.batch_shape == (4,)
    torque = max_joint_torque(design)
    np.testing.assert_array_equal(max_joint_torque(copies), np.tile(torque, (4, 1)))


def test_a_replaced_leaf_remembers_who_set_it(design):
    changed = design.with_values({"actuators.knee.gear": 6.5}, "somewhere")
    assert changed.origins["actuators.knee.gear"].label == "user"
    assert changed.origins["actuators.knee.gear"].source == "somewhere"
    assert design["actuators.knee.gear"] != 6.5


def test_names_of_a_robot_that_is_described_as_a_whole_have_no_prefix():
    assert prefixed("left", "knee") == "left_knee"
    assert prefixed("", "knee") == "knee"
