"""Cases of the servo arm: what is wrong, which motions tests and references have, and the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from typing_extensions import override

from hyperleg_design.validation.benchmark.case import Case, Fault, Recording
from hyperleg_design.validation.newcomers import servo_arm
from hyperleg_design.validation.newcomers.case_plan import (
    MotionPlan,
    at_all_joints,
    development_cases,
    single,
)
from hyperleg_design.validation.newcomers.names import fault_of
from hyperleg_design.validation.newcomers.plant import Wrong
from hyperleg_design.validation.newcomers.servo_arm import BODIES, JOINTS, Run

DURATION = 30.0
"""Of each log [s]."""
USUAL = ("steps", "triangles")
"""Motions of tests and references where a case says nothing else."""
OTHER = ("chirp", "waves")
"""Motions of references that no test has."""


@dataclass(frozen=True)
class ServoPlan(MotionPlan):
    """One case of the servo arm."""

    tests: tuple[str, ...] = USUAL
    references: tuple[str, ...] = USUAL
    robot = "servos"
    file = servo_arm.XML

    @property
    @override
    def about(self) -> str:
        return "arm of hobby servos, targets and positions only"

    @property
    @override
    def identified(self) -> bool:
        return False

    @override
    def fault(self, wrong: Wrong) -> Fault:
        _, servos = servo_arm.built(self.seed)
        what, j, size = wrong.what, wrong.place, wrong.size
        values = None
        if what == "rough":
            values = {"torque": float((size - (1 if self.references else 0)) * servos.dry[j])}
        return fault_of(what, (JOINTS[j], BODIES[j]), size, values)

    @override
    def log(
        self, wrongs: Sequence[Wrong], motion: str, seed: int, label: str, duration: float
    ) -> Recording:
        return servo_arm.simulate(wrongs, Run(motion, seed, self.seed, label, duration))


_one, _each = partial(single, ServoPlan), partial(at_all_joints, ServoPlan, len(JOINTS))

PLANS: tuple[ServoPlan, ...] = (
    ServoPlan("nothing-same"),
    ServoPlan("nothing-other", references=OTHER),
    ServoPlan("nothing-other-arm", references=OTHER, tests=("waves", "steps")),
    ServoPlan("nothing-alone", references=()),
    _one("gain-lift-other", "gain", 1, 0.5, references=OTHER),
    _one("gain-elbow", "gain", 2, 1.8),
    _one("weak-elbow-other", "weak", 2, 0.7, references=OTHER),
    _one("weak-lift", "weak", 1, 0.75),
    _each("weak-everywhere", "weak", 0.75, references=OTHER),
    _one("load-hand", "load", 4, 0.15),
    _one("load-hand-other", "load", 4, 0.2, references=OTHER),
    _one("load-forearm-alone", "load", 2, 0.2, references=()),
    _one("zero-bend-other", "zero", 3, 0.08, references=OTHER),
    _one("zero-lift", "zero", 1, 0.06),
    _one("rough-elbow", "rough", 2, 3.0),
    _one("rough-pan-other", "rough", 0, 3.0, references=OTHER),
    _one("late-60ms-other", "late", 0, 0.06, references=OTHER),
    _one("spring-lift", "spring", 1, 0.4),
    _one("drag-pan", "drag", 0, 0.15, references=OTHER),
    ServoPlan("load-gain", (Wrong("load", 4, 0.15), Wrong("gain", 0, 0.5))),
)
"""In this order; all for development."""


def servo_cases() -> list[Case]:
    """List all cases of the servo arm."""
    return development_cases(PLANS, DURATION)
