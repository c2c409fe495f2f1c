"""The servo arm's cases: kinds, places and sizes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.validation.newcomers import servo_arm
from hyperleg_design.validation.newcomers.servo_cases import PLANS, servo_cases


def test_cases_of_every_kind_are_there_and_all_are_for_development():
    cases = servo_cases()
    kinds = {"nothing", "single", "everywhere", "several", "outside"}
    assert {case.kind for case in cases} == kinds
    assert len({case.name for case in cases}) == len(cases)
    assert {case.split for case in cases} == {"development"}


def test_every_place_is_a_name_of_the_arm():
    names = {*servo_arm.JOINTS, *servo_arm.BODIES, "robot"}
    for plan in PLANS:
        for fault in plan.truth.faults:
            assert set(fault.places) <= names
            assert fault.listed == (plan.truth.kind != "outside")


def test_friction_is_over_that_of_the_references():
    plan = next(plan for plan in PLANS if plan.label == "rough-elbow")
    _, servos = servo_arm.built(plan.seed)
    assert plan.truth.faults[0].parameters["torque"] == pytest.approx(2 * servos.dry[2])


def test_logs_tell_no_torque_and_are_all_of_one_arm():
    plan = next(plan for plan in PLANS if plan.label == "load-gain")
    made, truth = plan.material(Path(), 0.3)
    assert truth.references
    assert len(truth.faults) == 2
    logs = (*made.logs, *made.references)
    assert {column.split("/")[0] for log in logs for column in log.signals} == {
        "position_target", "position", "velocity",
    }  # fmt: skip
    first = [log.signals["position/roll"][0] for log in logs]
    assert np.ptp(first) < 2 * servo_arm.COUNT
