"""A small blind trial at a frozen seed as cases of the benchmark; fresh seeds are for a final
scoring by `hyperleg gap blind`.
"""

from __future__ import annotations

from functools import cache, partial
from pathlib import Path
from typing import Any

from hyperleg_design.validation.benchmark.case import Case, Fault, Material, Recording, Truth
from hyperleg_design.validation.blind.case import describe
from hyperleg_design.validation.blind.plan import plan_cases
from hyperleg_design.validation.blind.rig_case import rig_case
from hyperleg_design.validation.blind.walking_case import walking_case

SEED, COUNT = 20261201, 24
"""Of the trial; never of one that is scored for itself."""
KINDS = {"null": "nothing", "single": "single", "compound": "several", "outside": "outside"}
"""Of the benchmark by those of a trial."""
VISIBLE = 2.0
"""Multiple of the residual of a clean log from which an effect counts as visible."""


@cache
def _plans() -> tuple[Any, ...]:
    return tuple(plan_cases(COUNT, SEED))


def blind_cases() -> list[Case]:
    """All cases; those with an even number are for development."""
    return [
        Case(
            f"blind-{plan.index:03d}-{plan.plant}-{plan.robot}-{plan.kind}",
            "blind",
            "held out" if plan.index % 2 else "development",
            f"blind plant {plan.plant}, {plan.robot}, {plan.kind}"
            f"{': ' if plan.effects else ''}{', '.join(plan.effects)}",
            KINDS[plan.kind],
            partial(material, index=plan.index),
        )
        for plan in _plans()
    ]


def material(data: Path, index: int) -> tuple[Material, Truth]:
    """The files of one case and its truth.

    Args:
        data: of the real logs; none are used.
        index: of the case in the trial.
    """
    plan = _plans()[index]
    case = walking_case(plan) if plan.plant == "walking" else rig_case(plan)
    description = describe(case)
    faults = tuple(
        Fault(
            wrong["effect"],
            tuple(dict.fromkeys([wrong["location"], *wrong["also"]])),
            {name: float(value) for name, value in wrong["parameters"].items()},
            listed=wrong["listed"],
        )
        for wrong in description["wrongs"]
    )
    visible = all(wrong["multiple"] >= VISIBLE for wrong in description["wrongs"])
    truth = Truth(faults, bool(case.references), visible=visible)

    def recordings(logs: Any) -> tuple[Recording, ...]:
        return tuple(
            Recording(f"{k}", log.time, dict(log.signals), log.metadata.mapping())
            for k, log in enumerate(logs)
        )

    robot = case.robot if case.mjcf is None else case.mjcf
    return Material(robot, recordings(case.logs), recordings(case.references)), truth
