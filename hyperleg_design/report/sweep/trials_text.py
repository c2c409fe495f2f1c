"""What evaluated designs of a sweep say, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.text import table as text_table
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED, Sweep
from hyperleg_design.sweep.trial_runs import REJECTED
from hyperleg_design.sweep.trial_table import MOST_FALLS, walks

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
        f"{_named(row)}: {row['designs']} designs {row['trained']} "
        f"({len(row['policies'])} {'policy' if len(row['policies']) == 1 else 'policies'})"
        for row in policies_of(trials)
    ]
    return (
        "; ".join(parts)
        + ". A zero-shot policy was trained on another design than it walks here; one that is "
        "trained for the design may do better on it. Measures are over the trials that did not "
        "fall; intervals over policies and trials."
    )


def _named(row: dict[str, Any]) -> str:
    if row["variant"] == AS_DESCRIBED:
        return str(row["protocol"])
    return f"{row['protocol']}, {row['variant']}"


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


def no_walk_text(designs: pd.DataFrame) -> str:
    """Say why no design of a sweep is on a front or among the best, and what to change.

    Args:
        designs: one row for each design, of `design_table`.

    Returns:
        The rule, the design that is nearest to it, and the options that change what counts.
    """
    if walks(designs).any():
        return "No design that seldom falls has a value for every objective."
    falls = designs[[f"{p}.fell" for p in registry.PROTOCOLS if f"{p}.fell" in designs]]
    worst = falls.max(axis=1, skipna=False)
    if not worst.notna().any():
        return "No design could be simulated under every protocol."
    least = int(np.nanargmin(worst.to_numpy(float)))
    return (
        f"No design falls in at most {100 * MOST_FALLS:g} % of its trials, those of all its "
        f"policies counted together, so that there is no front and no best design. Sample "
        f"{designs['sample'].iloc[least]} falls least often, in {100 * worst.iloc[least]:.0f} %. "
        f"--policies and --seeds choose the policies; hyperleg search takes another bound, such "
        f"as --constraint '{falls.columns[0]}<=0.3'."
    )


def falls_table(trials: pd.DataFrame) -> tuple[list[str], list[list[Any]]]:
    """Count the falls of each policy, over all designs.

    Args:
        trials: of `run_trials`.

    Returns:
        Heads, and a row for each policy.
    """
    run = trials[trials["trial"] >= 0]
    rows: list[list[Any]] = []
    for (protocol, policy), own in run.groupby(["protocol", "policy"], sort=False):
        fell = int((own["fell"] > 0).sum())
        rows.append([protocol, policy, len(own), fell, 100 * fell / len(own)])
    return ["protocol", "policy", "trials", "falls", "falls [%]"], rows


def best_text(
    sweep: Sweep, chosen: pd.DataFrame, objectives: tuple[str, ...], commands: list[str]
) -> str:
    """Describe the best design by each objective, for a terminal.

    Args:
        sweep: the definition.
        chosen: rows of the best designs, at least one.
        objectives: names of the measures.
        commands: that build the designs.

    Returns:
        The text.
    """
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
    build = dict.fromkeys(f"build this one: {commands[int(i)]}" for i in firsts.index)
    return "\n".join([text_table(heads, rows), *build])


def design_heads(sweep: Sweep) -> list[str]:
    """List the heads of the columns that say which design a row is.

    Args:
        sweep: the definition.

    Returns:
        Sample, variant where there are any, and the labels of the axes.
    """
    variant = ["variant"] if sweep.has_variants else []
    return ["sample", *variant, *(axis.label for axis in sweep.axes)]


def design_cells(sweep: Sweep, row: Any) -> list[Any]:
    """List the cells that say which design a row is.

    Args:
        sweep: the definition.
        row: of the table of designs.

    Returns:
        As `design_heads`: sample, variant where there are any, and the values of the axes.
    """
    values = [row[axis.name] for axis in sweep.axes]
    return [
        int(row["sample"]),
        *([str(row["variant"])] if sweep.has_variants else []),
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
