"""Where the time of T-tests goes, as a table of a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hyperleg_design.evaluation import paper
from hyperleg_design.evaluation.motion.stretches import NEAR, Stretch, stretches
from hyperleg_design.evaluation.result import Evaluation
from hyperleg_design.evaluation.rollout import ARRIVED
from hyperleg_design.report.page import Table


def stretch_means(
    runs: Sequence[Evaluation], step: float
) -> dict[str, tuple[float, float, float, float]]:
    """Means over all runs that arrived.

    Args:
        runs: evaluations under one T-test protocol.
        step: between two points of their paths [s].

    Returns:
        Of each straight and turn, in order: time [s], mean speed, least and largest speed [m/s].
        Empty where no run arrived.
    """
    by_name: dict[str, list[Stretch]] = {}
    for evaluation in runs:
        for path, outcome in zip(evaluation.paths, evaluation.outcomes, strict=True):
            if outcome == ARRIVED:
                for stretch in stretches(path, evaluation.protocol, step):
                    by_name.setdefault(stretch.name, []).append(stretch)
    keys = ("time", "mean_speed", "slowest", "fastest")
    return {
        name: tuple(float(np.mean([getattr(s, key) for s in some])) for key in keys)  # type: ignore[misc]
        for name, some in by_name.items()
    }


def time_table(runs: Mapping[str, Sequence[Evaluation]], group: str, step: float) -> Any:
    """Tabulate time and speeds of each design on every straight and turn, with the paper's mean
    speed below.

    Args:
        runs: evaluations by design.
        group: of trainings, for the caption.
        step: between two points of their paths [s].

    Returns:
        The table; a sentence where no trial arrived.
    """
    means = {design.replace("_", " "): stretch_means(some, step) for design, some in runs.items()}
    means = {design: some for design, some in means.items() if some}
    if not means:
        return f"No T-test of {group.replace('_', ' ')} arrived, so its time is not broken down."
    names = list(next(iter(means.values())))
    head, rows = ["stretch"], [[name] for name in names]
    for design, some in means.items():
        head += [f"{design}: time [s]", "speed [m/s]"]
        for row in rows:
            time, mean, slowest, fastest = some[row[0]]
            row += [f"{time:.2f}", f"{mean:.2f} ({slowest:.2f} to {fastest:.2f})"]
    turning = [
        f"{design}: {sum(v[0] for n, v in some.items() if n.startswith('turn')):.1f} s of "
        f"{sum(v[0] for v in some.values()):.1f} s"
        for design, some in means.items()
    ]
    printed = {item.measure: item.toe for item in paper.TABLE_FOUR}
    return Table(
        head,
        rows,
        f"Where the time goes, {group.replace('_', ' ')}: means over runs that arrived; a turn is "
        f"the time within {NEAR:g} m of its waypoint. Of the speed, the mean, and the least and "
        f"largest mean over 0.2 s. Turning takes, {'; '.join(turning)}. The paper prints no times "
        f"of legs: its runs took {printed['time']:g} s with the toe at {printed['mean_speed']:g} "
        "m/s on average.",
    )
