"""Cases of the crane: what is wrong, which motions tests and references have, and the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
from typing_extensions import override

from hyperleg_design.validation.benchmark.case import Case, Fault, Recording
from hyperleg_design.validation.newcomers import crane
from hyperleg_design.validation.newcomers.case_plan import (
    MotionPlan,
    at_all_joints,
    development_cases,
    single,
)
from hyperleg_design.validation.newcomers.crane import BODIES, JOINTS, MOTORS, Run
from hyperleg_design.validation.newcomers.names import fault_of
from hyperleg_design.validation.newcomers.plant import Wrong

DURATION = 12.0
"""Of each log [s]."""
USUAL = ("picks", "waves")
"""Motions of tests and references where a case says nothing else."""
OTHER = ("draws", "draws")
"""Motions that no reference has."""


@dataclass(frozen=True)
class CranePlan(MotionPlan):
    """One case of the crane."""

    tests: tuple[str, ...] = USUAL
    references: tuple[str, ...] = USUAL
    drive: str = "filtered"
    """One of `crane.DRIVES`."""
    commands: bool = True
    """Whether logs hold what the controllers ask for."""
    robot = "crane"
    file = crane.XML

    @property
    @override
    def about(self) -> str:
        return f"crane with {self.drive} drives"

    @override
    def fault(self, wrong: Wrong) -> Fault:
        model, _ = crane.built(self.seed)
        compared = model if self.references else mujoco.MjModel.from_xml_string(crane.XML)
        what, j, size = wrong.what, wrong.place, wrong.size
        if what == "load":
            body = model.body(BODIES[j]).id
            excess = size + model.body_mass[body] - compared.body_mass[body]
            return fault_of(what, (BODIES[j], JOINTS[j]), excess)
        values = None
        if what == "rough":
            excess = size * model.dof_frictionloss[j] - compared.dof_frictionloss[j]
            values = {"torque": float(excess)}
        if what == "thick":
            values = {"damping": float(size * model.dof_damping[j] - compared.dof_damping[j])}
        return fault_of(what, (JOINTS[j], MOTORS[j]), size, values)

    @override
    def log(
        self, wrongs: Sequence[Wrong], motion: str, seed: int, label: str, duration: float
    ) -> Recording:
        hidden = () if self.commands else ("motor_torque_command",)
        run = Run(motion, self.drive, seed, self.seed, label, duration)
        return crane.simulate(wrongs, run).without(*hidden)


_one, _each = partial(single, CranePlan), partial(at_all_joints, CranePlan, len(JOINTS))

PLANS: tuple[CranePlan, ...] = (
    CranePlan("nothing-same"),
    CranePlan("nothing-other", tests=OTHER),
    CranePlan("nothing-alone", references=()),
    CranePlan("nothing-lagging-same", drive="lagging"),
    CranePlan("nothing-lagging-other", drive="lagging", tests=OTHER),
    CranePlan("nothing-lagging-alone", drive="lagging", references=()),
    CranePlan("nothing-measured-other", drive="lagging", tests=OTHER, commands=False),
    _one("rough-luff", "rough", 1, 2.5),
    _one("rough-luff-other", "rough", 1, 2.5, tests=OTHER),
    _one("load-tool", "load", 3, 0.5, tests=("picks", "draws")),
    _one("load-tool-alone", "load", 3, 0.5, drive="lagging", references=()),
    _one("weak-fold", "weak", 2, 0.8, drive="lagging", tests=("draws", "waves")),
    _one("late-12ms", "late", 0, 0.012),
    _one("late-12ms-lagging", "late", 0, 0.012, drive="lagging", tests=("draws", "picks")),
    _one("zero-luff", "zero", 1, 0.05, drive="lagging"),
    _one("zero-fold-other", "zero", 2, 0.05, tests=OTHER),
    _one("rotor-fold", "rotor", 2, 0.06, tests=("picks", "draws")),
    _one("rotor-slew-alone", "rotor", 0, 0.1, references=()),
    _one("gain-twist", "gain", 3, 0.6, drive="lagging"),
    _one("lag-luff", "lag", 1, 0.012, drive="lagging"),
    _each("thick-everywhere", "thick", 3.0),
    _each("weak-everywhere", "weak", 0.85, drive="lagging"),
    CranePlan(
        "load-rough",
        (Wrong("load", 3, 0.4), Wrong("rough", 0, 2.5)),
        ("picks", "draws"),
        drive="lagging",
    ),
    CranePlan("late-weak", (Wrong("late", 0, 0.012), Wrong("weak", 1, 0.8))),
    _one("stop-luff", "stop", 1, 0.45),
    _one("eccentric-fold", "eccentric", 2, 0.03, drive="lagging"),
    _one("oneway-luff", "oneway", 1, 1.2),
    _one("dropout-luff", "dropout", 1, 0.06),
    _one("warming-fold", "warming", 2, 0.8, drive="lagging"),
    _one("crosstalk-fold", "crosstalk", 2, 0.4),
    _one("gust-slew", "gust", 0, 1.0),
)
"""In this order; all for development."""


def crane_cases() -> list[Case]:
    """List all cases of the crane."""
    return development_cases(PLANS, DURATION)
