"""One case of a trial: logs, truth and how it is described."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.wrong import SIZES, Wrong


@dataclass(frozen=True, eq=False)
class Case:
    """A case ready to be written."""

    plan: Plan
    robot: str
    """Name or file for the diagnosis."""
    mjcf: str | None
    """Content of that file."""
    logs: tuple[Log, ...]
    references: tuple[Log, ...]
    wrongs: tuple[Wrong, ...]
    multiples: tuple[float, ...]
    """Reached, an effect each, on the case's own logs."""
    parameters: tuple[dict[str, float], ...]
    """In physical units, an effect each; see `truth.parameters`."""
    also: tuple[tuple[str, ...], ...]
    """Names that count as the place, an effect each."""


def describe(case: Case) -> dict[str, Any]:
    """Truth of a case for the key.

    Args:
        case: the case.

    Returns:
        The truth, as JSON holds it.
    """
    plan = case.plan
    return {
        "case": f"{plan.index:03d}",
        "kind": plan.kind,
        "plant": plan.plant,
        "robot": plan.robot,
        "references": bool(case.references),
        "torque": plan.recorder.torque,
        "wrongs": [
            {
                "effect": w.effect,
                "listed": w.listed,
                "location": w.location,
                "also": list(also),
                "size": w.size,
                "unit": SIZES[w.effect].unit if w.effect in SIZES else "",
                "shape": dict(w.shape),
                "parameters": values,
                "wanted": wanted,
                "multiple": reached,
            }
            for w, also, values, wanted, reached in zip(
                case.wrongs, case.also, case.parameters, plan.multiples, case.multiples, strict=True
            )
        ],
    }
