"""The crane's cases: kinds, places and sizes."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import crane
from hyperleg_design.validation.newcomers.crane_cases import PLANS, crane_cases


def truth(label):
    plan = next(plan for plan in PLANS if plan.label == label)
    return plan, plan.material(Path(), 0.2)


def test_cases_of_every_kind_are_there_and_all_are_for_development():
    cases = crane_cases()
    assert {case.kind for case in cases} == {
        "nothing",
        "single",
        "everywhere",
        "several",
        "outside",
    }
    assert len({case.name for case in cases}) == len(cases)
    assert {case.split for case in cases} == {"development"}
    assert {plan.drive for plan in PLANS} == set(crane.DRIVES)


def test_every_place_is_a_name_of_the_crane():
    names = {*crane.JOINTS, *crane.MOTORS, *crane.BODIES, "robot"}
    for plan in {plan.wrongs[0].what: plan for plan in PLANS if plan.wrongs}.values():
        _, told = plan.material(Path(), 0.05)
        assert told.kind == plan.truth.kind
        for fault in told.faults:
            assert set(fault.places) <= names
            assert fault.listed == (plan.truth.kind != "outside")


def test_sizes_are_over_what_references_or_the_file_say():
    file = mujoco.MjModel.from_xml_string(crane.XML)
    plan, (_, told) = truth("rough-luff")
    own, _ = crane.built(plan.seed)
    assert told.faults[0].parameters["torque"] == pytest.approx(1.5 * own.dof_frictionloss[1])
    plan, (_, told) = truth("load-tool-alone")
    own, _ = crane.built(plan.seed)
    more = own.body("tool").mass[0] - file.body("tool").mass[0]
    assert told.faults[0].parameters["mass"] == pytest.approx(0.5 + more)


def test_references_and_channels_are_those_of_the_plan():
    _, (made, told) = truth("nothing-measured-other")
    assert told.references
    assert (len(made.logs), len(made.references)) == (2, 2)
    assert not any("command" in column for log in made.logs for column in log.signals)
    assert "motor_torque/drive_luff" in made.logs[0].signals
    _, (made, told) = truth("nothing-alone")
    assert not told.references
    assert not made.references


def test_tests_and_references_are_of_one_crane():
    plan, (made, _) = truth("nothing-same")
    again = plan.material(Path(), 0.2)[0]
    for one, other in zip(made.logs, again.logs, strict=True):
        np.testing.assert_array_equal(one.signals["position/luff"], other.signals["position/luff"])
    first = [log.signals["position/luff"][0] for log in (*made.logs, *made.references)]
    assert np.ptp(first) < 1e-3  # all begin in the middle, at the same zero
