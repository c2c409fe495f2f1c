"""Torques against the controller that asks for them, and currents against torques."""

import numpy as np
from rig import rig_log, spoiled

from hyperleg_design.gap.checks.plausibility import implausible
from hyperleg_design.gap.results.finding import ERROR, WARNING
from tests.gap.checks.implausible import Robot, errors, only


def test_gains_in_degrees():
    log = rig_log(gains={"hip": (20 * np.pi / 180, np.pi / 180), "knee": (20.0, 1.0)})
    only(errors(log, Robot()), "motor_torque_command/hip", "gains look like Nm/deg")
    unknown = [f for f in implausible(log) if "Nm/deg" in f.what]
    assert [f.severity for f in unknown] == [WARNING]
    assert "gear" in unknown[0].remedy


def test_a_gear_of_57_is_no_wrong_unit_and_a_motor_that_is_mounted_the_other_way_is_no_wrong_sign():
    class Geared(Robot):
        motor_from_joint = np.diag([1 / 57.3, -1.0])

    turned = {
        f"{kind}__hip": lambda v: v / 57.3 for kind in ("motor_torque", "motor_torque_command")
    }
    turned |= {f"{kind}__knee": np.negative for kind in ("motor_torque", "motor_torque_command")}
    log = spoiled(
        rig_log(),
        **{key: change for key, change in turned.items() if rig_log().has(*key.split("__"))},
    )
    assert not [f for f in implausible(log, Geared()) if "gains ask for" in f.what]
    assert {f.severity for f in implausible(log, Robot()) if "gains ask for" in f.what} == {
        ERROR,
        WARNING,
    }


def test_milliamps():
    found = errors(spoiled(rig_log(), motor_current__knee=lambda c: c * 1000))
    assert {s for s, _ in found} == {"motor_current/knee"}
    alone = spoiled(rig_log(torque_constant={}), motor_current__knee=lambda c: c * 1000)
    assert {s for s, _ in errors(alone)} == {"motor_current/knee"}


def test_torques_in_millinewtonmetres_are_told_by_the_gains_far_below_the_drives_limits():
    log = spoiled(rig_log(), motor_torque_command__hip=lambda v: v * 1000)
    only(errors(log, Robot()), "motor_torque_command/hip", "it is in mNm")
