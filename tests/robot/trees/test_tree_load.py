"""Bad input of a written-out tree: one clear error each."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.load import load_robot
from tests.robot.tree_files import leg, leg_file


def test_the_three_ways_to_give_the_transmission_are_the_same():
    plain = leg(transmission={"hip": 1.0, "knee": {"knee": 1.5}})
    whole = leg(transmission={"joint_from_motor": [[7, 0], [0, 13.5]]})
    assert np.array_equal(
        transmission.joint_from_motor(plain), transmission.joint_from_motor(whole)
    )
    shared = leg(transmission={"joint_from_motor": [[7, -9], [0, 9]]})
    assert np.allclose(transmission.joint_from_motor(shared), [[7, -9], [0, 9]])
    swapped = {
        "joint_from_motor": [[9, 0], [-9, 7]],
        "joints": ["knee", "hip"],
        "motors": ["knee", "hip"],
    }
    assert np.allclose(transmission.joint_from_motor(leg(transmission=swapped)), [[7, -9], [0, 9]])


def test_joints_come_parents_first_whatever_the_file_says():
    joints = leg_file()["joints"]
    turned = leg(joints={"knee": joints["knee"], "hip": joints["hip"]})
    assert transmission.joint_names(turned) == ("hip", "knee")


def test_values_are_replaced_checked_and_remembered():
    design = leg().with_values({"joints.knee.coulomb": 0.4})
    assert design["joints.knee.coulomb"] == 0.4
    assert design.origins["joints.knee.coulomb"].label == "user"
    with pytest.raises(InputError, match=r"leg\.yaml with override.*joints\.knee\.default_deg"):
        design.with_values({"joints.knee.upper_deg": -170.0})
    with pytest.raises(InputError, match=r"did you mean joints\.knee\.coulomb"):
        design.with_values({"joints.knee.coulom": 1.0})


def test_a_replaced_mass_lets_the_published_total_lapse():
    design = load_robot("mini_cheetah", overrides=["links.shank.mass=0.1"])
    assert design["masses.expected_total"] == 0


def test_a_motor_on_a_fixed_joint_is_refused_by_that():
    fixed = leg_file()["joints"]
    fixed["knee"]["type"] = "fixed"
    ratios = {"hip": {"hip": 1.0}, "knee": {"knee": 1.5}}
    with pytest.raises(InputError, match=r"transmission\.knee\.knee: is fixed or locked"):
        leg(joints=fixed, transmission=ratios)
