"""Trees of shipped robots: their mass, and which joints move."""

from __future__ import annotations

import pytest

from hyperleg_design import resources
from hyperleg_design.robot.kinematics.dimensions import total_mass
from hyperleg_design.robot.kinematics.kinematic_tree import mass_of
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.load import load_robot


@pytest.mark.parametrize("name", resources.names("descriptions"))
def test_links_add_up_and_form_one_tree(name):
    design = load_robot(name)
    tree = build_tree(design)
    assert tree.mass == pytest.approx(float(total_mass(design)))
    assert mass_of(reversed(tree.links)) == pytest.approx(tree.mass)
    names = [link.name for link in tree.links]
    carried = [joint.child for joint in tree.joints]
    assert sorted([tree.base, *carried]) == sorted(names)
    reached = {tree.base}
    for joint in tree.joints:  # parents before children
        assert joint.parent in reached
        reached.add(joint.child)
    assert [j.name for j in tree.moving] == [j.name for j in tree.joints if not j.fixed]


def test_a_link_that_is_not_there_is_not_found():
    tree = build_tree(load_robot("teaching_leg"))
    assert tree.link("shank").name == "shank"
    with pytest.raises(StopIteration):
        tree.link("tail")
