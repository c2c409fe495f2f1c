"""Sliders change what their label says, of robots of both families."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.report.viewer.sliders import changed, parameters_of
from hyperleg_design.robot import transmission
from hyperleg_design.robot.kinematics.dimensions import limb_mass, total_mass, zero_height
from hyperleg_design.robot.load import load_robot


@pytest.mark.parametrize("name", ["toe", "toe_removed", "mini_cheetah", "teaching_leg"])
def test_every_slider_makes_a_robot_and_at_one_changes_nothing(name):
    design = load_robot(name)
    parameters = parameters_of(design)
    assert {p.group for p in parameters} == {"Reductions", "Masses", "Lengths"}
    for parameter in parameters:
        assert changed(design, parameters, {parameter.label: 1.0}) is design
        other = changed(design, parameters, {parameter.label: 1.1})
        for path in parameter.paths:
            before, after = np.asarray(design[path]), np.asarray(other[path])
            grown = np.isclose(after, 1.1 * before)
            assert grown.all() or path.endswith(".size")


def test_a_mass_slider_adds_to_both_legs():
    design = load_robot("toe")
    heavier = changed(design, parameters_of(design), {"toe.mass": 2.0})
    added = total_mass(heavier) - total_mass(design)
    assert added == pytest.approx(2 * design.toe.mass)
    assert limb_mass(heavier) - limb_mass(design) == pytest.approx(design.toe.mass)


def test_the_length_of_a_link_of_a_written_out_tree_lifts_the_robot():
    design = load_robot("mini_cheetah")
    taller = changed(design, parameters_of(design), {"length of shank": 1.5})
    assert zero_height(taller) - zero_height(design) == pytest.approx(0.5 * 0.195, abs=1e-9)


def test_a_reduction_slider_scales_the_torque_map():
    design = load_robot("mini_cheetah")
    other = changed(design, parameters_of(design), {"transmission.knee.knee": 0.5})
    before, after = (transmission.joint_from_motor(d) for d in (design, other))
    assert after[2, 2] == pytest.approx(before[2, 2] / 2)
    np.testing.assert_array_equal(after[:2], before[:2])


def test_values_without_a_robot_are_refused():
    design = load_robot("toe")
    with pytest.raises(InputError, match="must exceed"):
        changed(design, parameters_of(design), {"thigh.mass": 0.1})
