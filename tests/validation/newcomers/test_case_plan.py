"""What a plan says of its case: seed, kind, name and files."""

from __future__ import annotations

import dataclasses
import pickle
import zlib
from dataclasses import dataclass
from pathlib import Path

import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.benchmark.case import Material
from hyperleg_design.validation.newcomers.case_plan import CasePlan, development_cases
from hyperleg_design.validation.newcomers.names import fault_of
from hyperleg_design.validation.newcomers.plant import Wrong


@dataclass(frozen=True)
class DoorPlan(CasePlan):
    robot = "door"
    about = "door with two hinges"

    def fault(self, wrong):
        return fault_of(wrong.what, (f"hinge_{wrong.place}",), wrong.size)

    def material(self, data, duration):
        return Material(f"<mujoco/> {duration}", ()), self.truth


PLANS = {
    "nothing": DoorPlan("nothing-same", references=("slow",)),
    "single": DoorPlan("dry-hinge", (Wrong("dry", 1, 0.2),)),
    "everywhere": DoorPlan("dry-all", (Wrong("dry", 0, 0.2), Wrong("dry", 1, 0.2))),
    "several": DoorPlan("dry-late", (Wrong("dry", 0, 0.2), Wrong("late", size=0.01))),
    "outside": DoorPlan("wind", (Wrong("wind", size=1.0),)),
}


@pytest.mark.parametrize("kind", PLANS)
def test_the_kind_follows_from_what_is_wrong(kind):
    (case,) = development_cases([PLANS[kind]], 1.0)
    assert case.kind == PLANS[kind].truth.kind == kind
    assert PLANS[kind].truth.references == (kind == "nothing")


def test_cases_are_named_after_robot_and_label_and_made_in_other_processes():
    cases = development_cases(list(PLANS.values()), 2.5)
    assert [case.name for case in cases] == [f"new-door-{p.label}" for p in PLANS.values()]
    assert cases[1].about == "door with two hinges, dry hinge"
    files, truth = pickle.loads(pickle.dumps(cases[1])).build(Path())
    assert files.robot == "<mujoco/> 2.5"
    assert truth == PLANS["single"].truth
    assert str(truth) == "coulomb_friction at hinge_1"


def test_the_seed_is_the_labels_alone():
    plan = PLANS["single"]
    assert plan.seed == zlib.crc32(b"dry-hinge") // 16
    assert dataclasses.replace(plan, tests=("fast",)).seed == plan.seed


def test_a_label_that_names_no_file_is_refused():
    with pytest.raises(InputError, match="letters, digits"):
        development_cases([DoorPlan("dry/hinge")], 1.0)
