"""The quadruped's cases: kinds, places and sizes."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS as CATALOGUE
from hyperleg_design.validation.newcomers import quadruped
from hyperleg_design.validation.newcomers.quadruped_cases import PLANS, quadruped_cases
from hyperleg_design.validation.newcomers.quadruped_log import FEET, JOINTS


def plan(label):
    return next(plan for plan in PLANS if plan.label == label)


def test_cases_of_every_kind_are_there_and_all_are_for_development():
    cases = quadruped_cases()
    kinds = {case.kind for case in cases}
    assert kinds == {"nothing", "single", "everywhere", "several", "outside"}
    assert len({case.name for case in cases}) == len(cases)
    assert {case.split for case in cases} == {"development"}


def test_every_place_is_a_name_of_the_robot_and_every_effect_is_of_the_catalogue():
    model = mujoco.MjModel.from_xml_string(quadruped.careful_file())
    names = {
        *JOINTS,
        *FEET,
        "robot",
        "base",
        "imu",
        *(model.body(i).name for i in range(model.nbody)),
    }
    for one in PLANS:
        for fault in one.truth.faults:
            assert fault.listed == (one.truth.kind != "outside")
            if fault.listed:
                assert fault.effect in CATALOGUE
                assert fault.places[0] in names
                told = {parameter.name for parameter in CATALOGUE[fault.effect].parameters}
                assert set(fault.parameters) <= told


def test_values_are_over_what_the_references_had():
    (fault,) = plan("load-trunk").truth.faults
    assert fault.parameters == {"mass": 0.6}
    slippery = plan("slippery-foot")
    (fault,) = slippery.truth.faults
    assert (fault.effect, fault.places) == ("ground_friction", ("FR_foot",))
    now, then = (quadruped.session(seed) for seed in (slippery.seed, slippery.build))
    assert fault.parameters["scale"] == pytest.approx(0.3 * now.floor / then.floor)
    everywhere = plan("rough-everywhere")
    now, then = (quadruped.session(seed) for seed in (everywhere.seed, everywhere.build))
    told = [fault.parameters["torque"] for fault in everywhere.truth.faults]
    assert told == pytest.approx(0.25 * (2.5 * now.rubbing - then.rubbing))
    assert told == pytest.approx([1.5 * quadruped.RUBBING] * 12, abs=0.12)


def test_logs_hold_what_the_page_of_the_format_asks_for_and_references_are_shared():
    made, truth = plan("nothing-same").material(Path(), 0.2)
    assert truth.references
    kinds = {column.split("/")[0] for column in made.logs[0].signals}
    assert {"gyro", "accelerometer", "base_orientation", "contact_force", "velocity"} <= kinds
    assert made.logs[0].metadata["base"] == "floating"
    again = plan("nothing-same").material(Path(), 0.2)[0]
    for one, other in zip(made.logs, again.logs, strict=True):
        np.testing.assert_array_equal(
            one.signals["position/FR_hip_joint"], other.signals["position/FR_hip_joint"]
        )
    assert made.references[0] is again.references[0]


def test_a_plain_case_has_the_description_as_it_comes():
    made, _ = plan("nothing-plain").material(Path(), 0.05)
    assert "<robot" in made.robot
    assert not plan("nothing-alone").material(Path(), 0.05)[0].references
