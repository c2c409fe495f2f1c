from __future__ import annotations

import pytest

from hyperleg_design.robot.checks.check_housing import check_housing
from hyperleg_design.robot.load import load_robot
from tests.robot.tree_files import SHIPPED, leg


def test_a_link_lighter_than_its_motors_is_named_with_both_masses():
    assert check_housing(leg()) == []
    (finding,) = check_housing(leg().with_values({"links.thigh.mass": 0.15}))
    assert (finding.severity, finding.place) == ("warning", "links.thigh")
    assert "weighs 0.15 kg, less than the motors in it (RI60: 0.1559 kg)" in finding.message


def test_motors_of_all_limbs_weigh_on_the_trunk():
    light = load_robot("mini_cheetah").with_values({"links.trunk.mass": 0.99})
    (finding,) = check_housing(light)  # four motors of 0.25 kg
    assert finding.place == "links.trunk"


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_robots_carry_their_motors(name):
    assert check_housing(load_robot(name)) == []
