"""How much of the difference between toe and no toe is the toe, how much the lost torque, how much
the mass.

Taking the toe's motor away also weakens knee and ankle, and lightens the leg. The ablations lie on
a ladder whose steps change one thing each, and add up to the whole: active toe, toe locked with its
motor kept, toe and motor gone at equal mass, toe and motor gone with their mass.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import statistics

if TYPE_CHECKING:
    from hyperleg_design.evaluation.resampling import Groups
    from hyperleg_design.evaluation.statistics import Difference

LADDER = ("toe", "toe_locked", "toe_removed_matched", "toe_removed")
CAUSES = ("toe joint", "torque of the toe's motor at knee and ankle", "mass of toe and motor")
"""What each step of the ladder takes away."""
WHOLE = "all together"


@dataclass(frozen=True)
class Share:
    """What one step of the ladder changes."""

    cause: str
    """One of `CAUSES`, or `WHOLE`."""
    removed: str
    """Variant without it."""
    kept: str
    """Variant with it."""
    change: Difference
    """Without less with."""


def attribute(
    groups: Mapping[str, Groups], *, level: float = statistics.LEVEL, seed: int = 0
) -> list[Share]:
    """Differences along the ladder, and from its first to its last variant.

    Args:
        groups: values of one measure by variant, one array a training seed; variants of the ladder
            that are there.
        level: of intervals.
        seed: of the bootstrap.

    Returns:
        One share a step between neighbours that are both there, then the whole; the steps' means
        add up to the whole's where none is missing.

    Raises:
        InputError: fewer than two variants of the ladder.
    """
    there = [name for name in LADDER if name in groups]
    if len(there) < 2:
        raise InputError(
            "attribution", "variants", list(groups), f"expects at least two of {', '.join(LADDER)}"
        )
    shares = []
    for cause, before, removed in zip(CAUSES, LADDER[:-1], LADDER[1:], strict=True):
        if before in groups and removed in groups:
            shares.append(_share(cause, groups, before, removed, level, seed))
    return [*shares, _share(WHOLE, groups, there[0], there[-1], level, seed)]


def _share(
    cause: str, groups: Mapping[str, Groups], before: str, removed: str, level: float, seed: int
) -> Share:
    return Share(
        cause,
        removed,
        before,
        statistics.difference(groups[removed], groups[before], level=level, seed=seed),
    )
