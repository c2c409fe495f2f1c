"""Evaluations as rows of estimates, for a terminal and for programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation.measures import OUTCOMES, measure_of
from hyperleg_design.evaluation.result import by_checkpoint, counted
from hyperleg_design.evaluation.result_tables import trial_table
from hyperleg_design.evaluation.statistics import Estimate, estimate, share
from hyperleg_design.report.text import table

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation


def evaluation_rows(evaluations: Sequence[Evaluation]) -> list[dict[str, Any]]:
    """Summarise evaluations: the mean of every measure, with its interval over seeds and trials.

    Means are over the trials that did not fall, but for how trials ended; see `counted`.

    Args:
        evaluations: trials of one or more policies, with the same measures.

    Returns:
        One row for each protocol, variant, design and measure, with `variant`, `design`,
        `trained` (see `TrainingFit`), `protocol`, `measure`, `unit` (empty for a number without
        unit), `mean`, `low` and `high` (None where there is no interval), `seeds`, `trials`, and
        `missing`, the number of trials without a value, those that fell among them.
    """
    trials = trial_table(evaluations)
    rows = []
    keys = ["protocol", "variant", "design", "trained"]
    for (protocol, variant, design, trained), part in trials.groupby(keys, sort=False):
        for measure in evaluations[0].measures[0]:
            if measure not in part:
                continue
            interval = (share if measure in OUTCOMES else estimate)(
                list(
                    by_checkpoint(
                        part.assign(**{measure: counted(part, measure)}), measure
                    ).values()
                )
            )
            rows.append(
                {
                    "variant": str(variant),
                    "design": str(design),
                    "trained": str(trained),
                    "protocol": str(protocol),
                    "measure": measure,
                    "unit": measure_of(measure).unit,
                    **_plain(interval),
                }
            )
    return rows


def _plain(value: Estimate) -> dict[str, Any]:
    numbers = {k: getattr(value, k) for k in ("mean", "low", "high")}
    return {
        **{k: v if math.isfinite(v) else None for k, v in numbers.items()},
        "seeds": value.seeds,
        "trials": value.trials,
        "missing": value.missing,
    }


def evaluation_text(rows: Sequence[dict[str, Any]]) -> str:
    """Write the rows of `evaluation_rows` as a table for a terminal, with units.

    Measures that no trial has, such as those of a knee that a robot lacks, are only named below it.

    Args:
        rows: one for each policy and measure.

    Returns:
        The text.
    """
    cells = []
    lacking = list(dict.fromkeys(row["measure"] for row in rows if row["mean"] is None))
    for row in rows:
        if row["mean"] is None:
            continue
        numbers = ["" if row[k] is None else row[k] for k in ("mean", "low", "high")]
        cells.append(
            [
                row["variant"],
                row["trained"],
                row["measure"],
                row["unit"] or "-",
                *numbers,
                row["seeds"],
                row["trials"],
                row["missing"],
            ]
        )
    text = table(
        [
            "variant",
            "policy is",
            *("measure", "unit", "mean", "low", "high"),
            *("seeds", "trials", "missing"),
        ],
        cells,
    )
    return f"{text}\nwithout a value in any trial: {', '.join(lacking)}" if lacking else text
