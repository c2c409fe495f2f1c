"""Designs that write their tree out: sections by name, reductions, and their paths."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot import transmission
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.trees.tree_design import named_class, ratios_class
from hyperleg_design.robot.trees.tree_sections import LinkSection


@pytest.fixture(scope="module")
def cheetah():
    return load_robot("mini_cheetah")


@pytest.fixture(scope="module")
def leg():
    return load_robot("teaching_leg")


def test_sections_are_found_by_path_and_by_name(cheetah):
    for name, section in cheetah.link_sections.items():
        assert cheetah[f"links.{name}.mass"] == section.mass
    assert cheetah.root_link == f"links.{next(iter(cheetah.link_sections))}"
    assert list(cheetah.copies) == list(cheetah.copy_sections)
    assert len(cheetah.copies) == 4


def test_a_robot_without_copies_is_one_limb_without_a_name(leg):
    assert leg.copies == ("",)
    (only,) = leg.copy_sections.values()
    assert not only.mirror


def test_fixed_joints_do_not_move(write):
    text = """
family: tree
trunk: {link: base, motion: fixed, height: 0.5}
links:
  base: {mass: 2.0, gyration: [0.1, 0.1, 0.1]}
  thigh: {mass: 1.0, gyration: [0.1, 0.1, 0.05]}
  sensor: {mass: 0.1, gyration: [0.01, 0.01, 0.01]}
joints:
  hip: {parent: base, child: thigh, lower_deg: -90, upper_deg: 90}
  mount: {parent: thigh, child: sensor, type: fixed}
actuators:
  hip: {motor: RI70, gear: 7, housed_in: base}
"""
    design = load_robot(write("arm.yaml", text))
    assert list(design.all_joints) == ["hip", "mount"]
    assert list(design.joint_sections) == ["hip"]
    assert transmission.joint_from_motor(design).tolist() == [[7.0]]


def test_the_matrix_is_gear_times_ratio_where_no_rod_drives(cheetah):
    matrix = transmission.joint_from_motor(cheetah)
    for j, joint in enumerate(cheetah.joint_sections):
        for m, (motor, section) in enumerate(cheetah.actuator_sections.items()):
            assert matrix[j, m] == pytest.approx(section.gear * cheetah.ratio(motor, joint))
    assert cheetah.ratio("knee", "abduction") == 0.0
    assert cheetah.ratio("no_such_motor", "knee") == 0.0


def test_a_replaced_reduction_reaches_the_matrix(cheetah):
    twice = cheetah.with_values({"transmission.knee.knee": 2 * cheetah.ratio("knee", "knee")})
    change = transmission.joint_from_motor(twice) - transmission.joint_from_motor(cheetah)
    assert np.count_nonzero(change) == 1
    assert change[-1, -1] == pytest.approx(transmission.joint_from_motor(cheetah)[-1, -1])


def test_the_same_names_make_the_same_class():
    assert named_class("Links", {"a": LinkSection}) is named_class("Links", {"a": LinkSection})
    assert named_class("Links", {"b": LinkSection}) is not named_class("Links", {"a": LinkSection})
    assert ratios_class(("hip", "knee")) is ratios_class(("hip", "knee"))
    assert ratios_class(("hip",))(hip=3.0).hip == 3.0
