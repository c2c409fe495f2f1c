"""What evaluated designs of a sweep say, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.text import table as text_table
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.trial_runs import REJECTED

if TYPE_CHECKING:
    import pandas as pd


def policies_of(trials: pd.DataFrame) -> list[dict[str, Any]]:
    """List the policies that ran, whether they were trained for what they ran on, and on how many
    designs.

    Args:
        trials: one row for each trial.

    Returns:
        `protocol`, `variant`, `trained`, `policies`, `designs`.
    """
    run = trials[trials["trial"] >= 0]
    rows = []
    keys = ["protocol", "variant", "trained"]
    for (protocol, variant, trained), own in run.groupby(keys, sort=False):
        rows.append(
            {
                "protocol": str(protocol),
                "variant": str(variant),
                "trained": str(trained),
                "policies": sorted(own["policy"].unique().tolist()),
                "designs": int(own["sample"].nunique()),
            }
        )
    return rows


def policy_text(trials: pd.DataFrame) -> str:
    """Describe which policies ran on how many designs, and what their numbers mean.

    Args:
        trials: one row for each trial.

    Returns:
        The text.
    """
    parts = [
        f"{row['protocol']}, {row['variant']}: {row['designs']} designs {row['trained']} "
        f"({len(row['policies'])} {'policy' if len(row['policies']) == 1 else 'policies'})"
        for row in policies_of(trials)
    ]
    return (
        "; ".join(parts)
        + ". A zero-shot policy was trained on another design than it walks here; one that is "
        "trained for the design may do better on it. Measures are over the trials that did not "
        "fall; intervals over policies and trials."
    )


def unsimulated_text(trials: pd.DataFrame) -> str:
    """Count the designs that no trial could be run on, for a terminal.

    Args:
        trials: of `run_trials`.

    Returns:
        A line for each reason; empty where all designs were simulated.
    """
    refused = trials[trials["outcome"] == REJECTED].drop_duplicates(["sample", "variant"])
    counts = refused["reason"].value_counts()
    return "".join(f"{count} cannot be simulated: {reason}\n" for reason, count in counts.items())


def best_text(
    sweep: Sweep, chosen: pd.DataFrame, objectives: tuple[str, ...], commands: list[str]
) -> str:
    """Describe the best design by each objective, for a terminal.

    Args:
        sweep: the definition.
        chosen: rows of the best designs.
        objectives: names of the measures.
        commands: that build the designs.

    Returns:
        The text.
    """
    if chosen.empty:
        return "no design walks without falling"
    firsts = chosen.drop_duplicates("by")
    rows = [
        [
            row["by"],
            *map(str, design_cells(sweep, row)),
            *(with_interval(row, name) for name in objectives),
            policy_kind(row),
        ]
        for _, row in firsts.iterrows()
    ]
    heads = ["best by", *design_heads(sweep), *objectives, "policy is"]
    build = [f"build this one: {commands[int(i)]}" for i in firsts.index]
    return "\n".join([text_table(heads, rows), *build])


def design_heads(sweep: Sweep) -> list[str]:
    """List the heads of the columns that say which design a row is.

    Args:
        sweep: the definition.

    Returns:
        Sample, variant and the labels of the axes.
    """
    return ["sample", "variant", *(axis.label for axis in sweep.axes)]


def design_cells(sweep: Sweep, row: Any) -> list[Any]:
    """List the cells that say which design a row is.

    Args:
        sweep: the definition.
        row: of the table of designs.

    Returns:
        Sample, variant and the values of the axes.
    """
    values = [row[axis.name] for axis in sweep.axes]
    return [
        int(row["sample"]),
        str(row["variant"]),
        *(float(f"{v:.4g}") if isinstance(v, float) else str(v) for v in values),
    ]


def policy_kind(row: Any) -> str:
    """Say whether the policies that ran on a design were trained for it.

    Args:
        row: of the table of designs.

    Returns:
        The kinds of policies.
    """
    kinds = [row[c] for c in row.index if c.endswith(".policy") and isinstance(row[c], str)]
    outside = [row[c] for c in row.index if c.endswith(".outside") and isinstance(row[c], str)]
    kind = ", ".join(dict.fromkeys(kinds))
    return f"{kind} (outside the trained range)" if any(outside) else kind


def with_interval(row: Any, name: str) -> str:
    """Write a measure with its interval.

    Args:
        row: of the table of designs.
        name: of the measure.

    Returns:
        The text; without an interval where the table has none.
    """
    text = f"{row[name]:.4g}"
    if f"{name}.low" in row and np.isfinite(row[f"{name}.low"]):
        text += f" [{row[f'{name}.low']:.4g}, {row[f'{name}.high']:.4g}]"
    return text
