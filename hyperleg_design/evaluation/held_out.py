"""Check of a policy for many designs on designs that it was never trained on, beside other policies
on the same designs: another one for all of them, or a specialist for each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate, evaluate_designs
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.rollout import ARRIVED, FELL
from hyperleg_design.simulation.design_spread import load_design_spread

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.design_spread import DesignSpread

EACH = "{}"
"""Stands for the number of a design in the path of policies that have one training each."""
COST, TIME = "cost_of_transport", "time"
WALKED, RUN = (COST, "steady_speed"), (TIME, COST, "mean_deviation")
"""Measures of walks and of T-tests that are reported; policies are ranked by the first one."""


@dataclass(frozen=True)
class HeldOutDesigns:
    """Designs of a spread that no training draws."""

    batch: RobotDesign
    """All of them, one behind the other."""
    robots: tuple[RobotDesign, ...]
    """Each of them."""
    leaves: tuple[str, ...]
    """Dotted paths of the values in which they differ."""


@dataclass(frozen=True)
class HeldOutCheck:
    """What policies do on held-out designs."""

    rows: pd.DataFrame
    """A row for each policy and design: `policy`, `design` (its number), `trained`, `arrived`,
    `fell`, `trials`, means of the trials that arrived (of walks `cost_of_transport` and
    `steady_speed` [m/s]; of T-tests `time` [s], `cost_of_transport` and `mean_deviation` [m]), and
    the drawn leaves by path."""
    comparisons: pd.DataFrame
    """A row for each policy that the first is compared with: `policy` (the first), `against` (the
    other), `cost_ratio` (of `policy` over `against`, median over the designs on which both
    arrive), of T-tests `time_ratio` as well, `rank_correlation` (Spearman's over these designs, of
    their costs in walks and of their times in T-tests), `designs` (how many those are),
    `more_falls` (share of trials in which `policy` falls, less that of `against`)."""


def held_out_designs(
    policies: Sequence[str | Path], designs: str | Path | DesignSpread
) -> HeldOutDesigns:
    """Draw the held-out designs of a spread.

    Args:
        policies: as in `check_held_out`; the leaves of the first one's design are replaced.
        designs: a shipped name, a file, or a `DesignSpread`.

    Returns:
        The designs.

    Raises:
        InputError: no such policy or spread.
    """
    spread = load_design_spread(designs) if isinstance(designs, str | Path) else designs
    batch = spread.held_out_designs(load_policy(judged(policies)).design)
    robots = tuple(batch.take(i) for i in range(spread.held_out))
    return HeldOutDesigns(batch, robots, tuple(spread.ranges.ranges))


def check_held_out(
    policies: Sequence[str | Path],
    designs: HeldOutDesigns,
    protocol: str | Path | Any = "walk",
    *,
    threads: int | None = None,
) -> HeldOutCheck:
    """Evaluate policies on the held-out designs of a spread.

    Args:
        policies: ONNX files or shipped names; the first is judged, the others are what it is
            compared with. A path with `{}` names one policy for each design, by its number.
        designs: of `held_out_designs`.
        protocol: as `evaluate` takes it.
        threads: of the simulation; the result does not depend on it.

    Returns:
        The walks of each policy on each held-out design, and their comparisons with the first
        policy.

    Raises:
        InputError: no policy, or as in `evaluate_designs`.
    """
    first_name = judged(policies)
    rows: list[dict[str, Any]] = []
    for policy in policies:
        if EACH in str(policy):
            done = [
                evaluate(str(policy).replace(EACH, str(i)), protocol, design=robot, threads=threads)
                for i, robot in enumerate(designs.robots)
            ]
        else:
            done = evaluate_designs(policy, designs.batch, protocol, threads=threads)
        for i, (robot, result) in enumerate(zip(designs.robots, done, strict=True)):
            leaves = {path: float(robot[path]) for path in designs.leaves}
            rows.append({"policy": str(policy), "design": i, **_row(result), **leaves})
    table = pd.DataFrame(rows)
    first = table[table["policy"] == str(first_name)]
    others = [
        {
            "policy": str(first_name),
            "against": str(name),
            **compared(first, table[table["policy"] == str(name)]),
        }
        for name in policies[1:]
    ]
    return HeldOutCheck(table, pd.DataFrame(others))


def judged(policies: Sequence[str | Path]) -> str | Path:
    """Tell which of the policies of a check is judged.

    Args:
        policies: as in `check_held_out`.

    Returns:
        The first one.

    Raises:
        InputError: there is none, or it names one policy for each design.
    """
    if not policies or EACH in str(policies[0]):
        raise InputError("held-out check", "policies", None, "expects one policy for all designs")
    return policies[0]


def compared(first: pd.DataFrame, other: pd.DataFrame) -> dict[str, float]:
    """Compare two policies' rows of the same designs in the same order.

    Args:
        first: rows of the policy that is judged, one for each design.
        other: rows of the policy that it is compared with.

    Returns:
        As the columns of `HeldOutCheck.comparisons`; NaN where fewer than two designs count.
    """
    ranked = TIME if TIME in first else COST
    own, theirs = first[ranked].to_numpy(float), other[ranked].to_numpy(float)
    both = np.isfinite(own) & np.isfinite(theirs)
    enough = int(both.sum()) > 1
    ratios = {
        f"{name}_ratio": float(
            np.median(first[column].to_numpy(float)[both] / other[column].to_numpy(float)[both])
        )
        if enough
        else float("nan")
        for name, column in (("cost", COST), ("time", TIME))
        if column in first
    }
    ranks = (pd.Series(values[both]) for values in (own, theirs))
    return {
        **ratios,
        "rank_correlation": float(next(ranks).corr(next(ranks), method="spearman"))
        if enough
        else float("nan"),
        "designs": int(both.sum()),
        "more_falls": float(
            first["fell"].sum() / first["trials"].sum()
            - other["fell"].sum() / other["trials"].sum()
        ),
    }


def _row(result: Evaluation) -> dict[str, Any]:
    """Outcomes and means of one policy on one design."""
    arrived = np.array([outcome == ARRIVED for outcome in result.outcomes])
    row: dict[str, Any] = {
        "trained": result.trained.kind,
        "arrived": int(arrived.sum()),
        "fell": result.outcomes.count(FELL),
        "trials": len(arrived),
    }
    for name in RUN if isinstance(result.protocol, TTestProtocol) else WALKED:
        values = result.values(name)[arrived]
        values = values[np.isfinite(values)]
        row[name] = float(values.mean()) if len(values) else float("nan")
    return row
