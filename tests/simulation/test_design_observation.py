import re

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.design_observation import DesignRanges, Range, design_ranges

RANGES = DesignRanges(
    {
        "toe.mass": Range(0.05, 1.0),
        "transmission.scale.knee": Range(0.5, 2.0, log=True),
        "thigh.length": Range(0.3, 0.45),
    }
)


def test_ends_and_middle_of_each_range():
    design = load_design().with_values(
        {
            "toe.mass": np.array([0.05, 0.525, 1.0]),
            "transmission.scale.knee": np.array([0.5, 1.0, 2.0]),
            "thigh.length": 0.45,
        }
    )
    numbers = RANGES.numbers(design)
    np.testing.assert_allclose(numbers[:, 0], [-1, 0, 1], atol=1e-12)
    np.testing.assert_allclose(numbers[:, 1], [-1, 0, 1], atol=1e-12)
    np.testing.assert_allclose(numbers[:, 2], 1, atol=1e-12)
    assert RANGES.columns == [f"design.{path}" for path in RANGES.ranges]
    for i in range(3):
        np.testing.assert_array_equal(RANGES.numbers(design.take(i)), numbers[i])
        assert RANGES.outside(design.take(i)) == []


def test_what_lies_outside_is_named():
    design = load_design().with_values({"toe.mass": 1.1, "transmission.scale.knee": 0.4})
    assert RANGES.outside(design) == ["toe.mass", "transmission.scale.knee"]


def test_draws_lie_inside_and_make_designs():
    drawn = RANGES.draw(200, np.random.default_rng(0))
    numbers = RANGES.numbers(load_design().with_values(drawn))
    assert numbers.shape == (200, 3)
    assert np.abs(numbers).max() <= 1
    assert np.all(np.abs(numbers.mean(0)) < 0.15)


def test_ranges_survive_as_plain_values():
    assert design_ranges(RANGES.to_mapping(), "file") == RANGES


@pytest.mark.parametrize(
    "data",
    [
        None,
        {},
        {3: {"low": 0, "high": 1}},
        {"toe.mass": [0, 1]},
        {"toe.mass": {"low": 0}},
        {"toe.mass": {"low": 0, "high": 1, "steps": 3}},
        {"toe.mass": {"low": 1, "high": 0}},
        {"toe.mass": {"low": "x", "high": 1}},
        {"toe.mass": {"low": 0.0, "high": 1, "log": True}},
        {"toe.mass": {"low": float("nan"), "high": 1}},
    ],
)
def test_bad_ranges_are_one_clear_error(data):
    with pytest.raises(InputError):
        design_ranges(data, "file")


@pytest.mark.parametrize(
    ("robot", "path", "words"),
    [
        ("toe", "toe.masss", "of toe: no such field; did you mean toe.mass?"),
        ("toe", "toe.com", "single number"),
        ("toe", "electrical.constants", "single number"),
        ("toe", "links.trunk.mass", "of toe: no such field"),
        ("mini_cheetah", "links.trunk.mas", "did you mean links.trunk.mass?"),
        ("mini_cheetah", "toe.mass", "of mini_cheetah: no such field"),
    ],
)
def test_a_range_is_one_of_a_single_number_of_the_robot(robot, path, words):
    ranges = design_ranges({path: {"low": 0, "high": 1}, "no.such": {"low": 0, "high": 1}}, "file")
    with pytest.raises(InputError, match=re.escape(words)) as error:
        DesignRanges({path: ranges.ranges[path]}).check_leaves(load_robot(robot), "file")
    assert error.value.field == path
    if "no such" in words:
        with pytest.raises(InputError, match=rf"nor has {robot} no\.such"):
            ranges.check_leaves(load_robot(robot), "file")


def test_a_robot_that_writes_its_tree_out_is_drawn_over_its_own_leaves():
    robot = load_robot("mini_cheetah")
    ranges = DesignRanges(
        {"links.trunk.mass": Range(3.0, 3.6), "actuators.knee.gear": Range(4, 9, log=True)}
    )
    ranges.check_leaves(robot, "file")
    drawn = ranges.draw(50, np.random.default_rng(0))
    batch = robot.with_values(drawn)
    assert np.abs(ranges.numbers(batch)).max() <= 1
    np.testing.assert_array_equal(batch["links.trunk.mass"], drawn["links.trunk.mass"])
