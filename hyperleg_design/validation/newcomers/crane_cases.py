"""Cases of the crane: what is wrong, which motions tests and references have, and the truth."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.newcomers import crane
from hyperleg_design.validation.newcomers.crane import BODIES, JOINTS, MOTORS, Run
from hyperleg_design.validation.newcomers.names import ALIKE, EFFECTS, SIZES
from hyperleg_design.validation.newcomers.plant import Wrong, everywhere

USUAL = ("picks", "waves")
"""Motions of tests and references where a case says nothing else."""
OTHER = ("draws", "draws")
"""Motions that no reference has."""


@dataclass(frozen=True)
class CranePlan:
    """One case of the crane."""

    label: str
    wrongs: tuple[Wrong, ...] = ()
    drive: str = "filtered"
    """One of `crane.DRIVES`."""
    tests: tuple[str, ...] = USUAL
    references: tuple[str, ...] = USUAL
    """Motions, one a log."""
    commands: bool = True
    """Whether logs hold what the controllers ask for."""

    @property
    def kind(self) -> str:
        """Which of `benchmark.case.KINDS` the case is, by its faults."""
        return Truth(_faults(self), everywhere=everywhere(self.wrongs)).kind

    @property
    def build(self) -> int:
        """Seed of how the crane was built, and of its motions."""
        return zlib.crc32(self.label.encode()) // 16


def _one(label: str, what: str, place: int, size: float, **more: object) -> CranePlan:
    return CranePlan(label, (Wrong(what, place, size),), **more)  # type: ignore[arg-type]


def _each(label: str, what: str, size: float, **more: object) -> CranePlan:
    wrongs = tuple(Wrong(what, joint, size) for joint in range(len(JOINTS)))
    return CranePlan(label, wrongs, **more)  # type: ignore[arg-type]


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
        "lagging",
        ("picks", "draws"),
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
    return [
        Case(
            f"new-crane-{plan.label}",
            "newcomers",
            "development",
            f"crane with {plan.drive} drives, {plan.label.replace('-', ' ')}",
            plan.kind,
            partial(material, plan=plan),
        )
        for plan in PLANS
    ]


def material(data: Path, plan: CranePlan, duration: float = 12.0) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: of the real logs; none are used.
        plan: of the case.
        duration: of each log [s].
    """

    def logs(
        wrongs: tuple[Wrong, ...], motions: tuple[str, ...], first: int, label: str
    ) -> tuple[Recording, ...]:
        return tuple(
            crane.simulate(
                wrongs,
                Run(
                    motion,
                    plan.drive,
                    plan.build + first + 10 * k,
                    plan.build,
                    f"{label}_{k}",
                    duration,
                ),
            )
            .declared(session=label)
            .without(*(() if plan.commands else ("motor_torque_command",)))
            for k, motion in enumerate(motions)
        )

    truth = Truth(_faults(plan), bool(plan.references), everywhere=everywhere(plan.wrongs))
    tests = logs(plan.wrongs, plan.tests, 0, "test")
    return Material(crane.XML, tests, logs((), plan.references, 100, "healthy")), truth


def _faults(plan: CranePlan) -> tuple[Fault, ...]:
    """What is wrong in the words of the catalogue."""
    model, _ = crane.built(plan.build)
    compared = model if plan.references else mujoco.MjModel.from_xml_string(crane.XML)
    faults = []
    for wrong in plan.wrongs:
        what, j, size = wrong.what, wrong.place, wrong.size
        if what not in EFFECTS:
            faults.append(Fault(what, (), listed=False))
            continue
        places: tuple[str, ...] = (JOINTS[j], MOTORS[j])
        if what == "load":
            body = model.body(BODIES[j]).id
            places, size = (
                (BODIES[j], JOINTS[j]),
                size + model.body_mass[body] - compared.body_mass[body],
            )
        if what == "late":
            places = ("robot",)
        values = {SIZES[what]: float(size)} if what in SIZES else {}
        if what == "rough":
            values = {
                "torque": float(size * model.dof_frictionloss[j] - compared.dof_frictionloss[j])
            }
        if what == "thick":
            values = {"damping": float(size * model.dof_damping[j] - compared.dof_damping[j])}
        alike = tuple((effect, places) for effect in ALIKE.get(what, ()))
        faults.append(Fault(EFFECTS[what], places, values, alike))
    return tuple(faults)
