"""What is refused of a design of any family, and which value an error shows."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.checks.refusal import NAME, refuse
from hyperleg_design.robot.load import load_robot
from tests.robot.tree_files import leg


@pytest.mark.parametrize(
    ("good", "value", "shown"),
    [
        (False, 3.0, 3.0),
        (np.array([True, False, False]), np.array([1.0, 2.0, 3.0]), 2.0),
        (np.array([True, False]), np.array([[1.0, 2.0], [3.0, 4.0]]), [3.0, 4.0]),
        (np.array([True, False]), 7.0, 7.0),
        (False, np.array([1.0, 2.0]), [1.0, 2.0]),
    ],
)
def test_the_first_bad_robots_value_is_shown(good, value, shown):
    with pytest.raises(InputError) as caught:
        refuse("a.yaml", "toe.mass", good, value, "expects more")
    assert (caught.value.where, caught.value.field, caught.value.value) == (
        "a.yaml",
        "toe.mass",
        shown,
    )
    refuse("a.yaml", "toe.mass", np.ones_like(good), value, "expects more")


@pytest.mark.parametrize("name", ["a", "Toe_2.1-b", "9", "x" * 100])
def test_names_that_files_can_have_are_taken(name):
    assert NAME.fullmatch(name)


@pytest.mark.parametrize("name", ["", "_a", "a b", "a/b", "x" * 101, ".hidden"])
def test_other_names_are_refused_in_every_family(name):
    with pytest.raises(InputError, match=r"name.*expects a letter or digit.*100 at most"):
        leg(name=name)


def test_batches_of_different_lengths_name_both_values():
    for design, paths in (
        (load_robot("hyperleg"), ("toe.mass", "foot.mass")),
        (leg(), ("links.shank.mass", "links.thigh.mass")),
    ):
        values = {paths[0]: np.array([0.3, 0.4]), paths[1]: np.array([0.7, 0.8, 0.9])}
        with pytest.raises(InputError, match=rf"{paths[1]}.*that of {paths[0]} is 2"):
            design.with_values(values)
