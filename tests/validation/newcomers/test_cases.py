"""The newcomers' cases: kinds, places and sizes."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest

from hyperleg_design.gap.effects import EFFECTS as CATALOGUE
from hyperleg_design.validation.newcomers import plant
from hyperleg_design.validation.newcomers.cases import EFFECTS, PLANS, material, newcomer_cases
from hyperleg_design.validation.newcomers.plant import built
from hyperleg_design.validation.newcomers.robots import ROBOTS


def plan(name):
    return next(p for p in PLANS if p.name == name)


def test_effects_are_of_the_catalogue_and_cases_of_every_kind_and_robot_are_there():
    assert set(EFFECTS.values()) <= set(CATALOGUE)
    cases = newcomer_cases()
    assert {p.robot for p in PLANS} == set(ROBOTS)
    kinds = {case.kind for case in cases}
    assert kinds == {"nothing", "single", "everywhere", "several", "outside"}
    assert len({case.name for case in cases}) == len(cases)


@pytest.mark.slow
def test_every_place_is_a_name_of_the_robot(monkeypatch):
    monkeypatch.setattr(plant, "DURATION", 0.2)
    for one in {(p.robot, w.what): p for p in PLANS for w in p.wrongs}.values():
        _, truth = material(Path(), one)
        assert truth.kind == one.kind
        model = mujoco.MjModel.from_xml_string(ROBOTS[one.robot].xml)
        names = {model.joint(i).name for i in range(model.njnt)}
        names |= {model.actuator(i).name for i in range(model.nu)}
        names |= {model.body(i).name for i in range(model.nbody)} | {"robot"}
        for fault in truth.faults:
            assert set(fault.places) <= names
            assert fault.listed == (one.kind != "outside")


def test_friction_three_times_as_large_is_over_what_references_or_the_file_say(monkeypatch):
    monkeypatch.setattr(plant, "DURATION", 0.2)
    _, truth = material(Path(), plan("new-two_link-rough_everywhere-all-referenced"))
    model = mujoco.MjModel.from_xml_string(ROBOTS["two_link"].xml)
    assert [f.places[0] for f in truth.faults] == ["shoulder", "elbow"]
    for k, fault in enumerate(truth.faults):
        assert fault.parameters["torque"] == pytest.approx(2 * model.dof_frictionloss[k], rel=0.4)
    alone = plan("new-two_link-thick_everywhere-all-alone")
    _, truth = material(Path(), alone)
    for k, fault in enumerate(truth.faults):
        damping = fault.parameters["damping"] + model.dof_damping[k]
        assert damping == pytest.approx(3 * model.dof_damping[k], rel=0.4)
    assert built(ROBOTS["two_link"], 1)[0].nv == 2


def test_friction_of_both_kinds_at_both_joints_is_one_fault_a_joint(monkeypatch):
    monkeypatch.setattr(plant, "DURATION", 0.2)
    _, truth = material(Path(), plan("new-two_link-rough_thick_everywhere-all-referenced-1"))
    assert truth.kind == "everywhere"
    assert [f.places[0] for f in truth.faults] == ["shoulder", "elbow"]
    for fault in truth.faults:
        assert "viscous_friction" in {effect for effect, _ in fault.equivalents}
