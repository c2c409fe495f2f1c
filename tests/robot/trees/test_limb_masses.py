"""Masses of a limb follow the motors that its links house."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.masses import actuator_mass
from hyperleg_design.robot.trees import limb_masses
from tests.robot.tree_files import bolted_file, leg


def test_another_motor_changes_the_mass_of_the_link_that_houses_it():
    design = leg()
    other = design.with_values({"actuators.knee.motor": "RI80"})
    per_torque = design.masses.gear_mass_per_torque
    change = actuator_mass("RI80", 9, per_torque) - actuator_mass("RI60", 9, per_torque)
    before, after = limb_masses.limb_masses(design), limb_masses.limb_masses(other)
    assert after.total - before.total == pytest.approx(change)
    assert after.links["thigh"].mass == pytest.approx(1.0 + change)
    fixed = other.with_values({"masses.law": "fixed"})
    assert limb_masses.limb_masses(fixed).total == before.total


def test_a_motor_in_the_trunk_counts_once_a_limb():
    design = load_robot("mini_cheetah")
    other = design.with_values({"actuators.abduction.gear": 9.0})
    change = limb_masses.limb_masses(other).trunk - limb_masses.limb_masses(design).trunk
    peak = 2.83
    assert change == pytest.approx(4 * 0.010 * 3 * peak)
    com = limb_masses.limb_masses(other).links["trunk"].com
    assert np.allclose(com[1:], 0, atol=1e-15)


def test_the_trunk_is_the_root_with_all_that_is_fixed_to_it():
    whole = limb_masses.limb_masses(leg(**bolted_file()))
    assert whole.trunk == pytest.approx(5.100001, abs=1e-12)
    assert whole.limb == pytest.approx(2.0, abs=1e-12)
    assert whole.total == pytest.approx(7.100001, abs=1e-12)
    pair = {"left": {}, "right": {"mirror": True}}
    both = limb_masses.limb_masses(leg(**bolted_file(), limbs=pair))
    assert both.limb == whole.limb
    assert both.trunk == pytest.approx(1e-6 + 2 * 5.1, abs=1e-12)
    assert both.total == pytest.approx(both.trunk + 2 * both.limb, abs=1e-12)
