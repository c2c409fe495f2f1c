"""What evaluated designs of a sweep say, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.text import table as text_table
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED, Sweep
from hyperleg_design.sweep.trial_runs import REJECTED
from hyperleg_design.sweep.trial_table import FEWEST_ARRIVALS, walks

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
        "trained for the design may do better on it. A design is judged by the policy that is best "
        "on it: where several run, odd-numbered trials decide which arrives most often (of equals, "
        "at the lowest cost of transport), and its even-numbered trials are reported. Measures are "
        "over those that did not fall; intervals are over trials."
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
        return "No design that walks has a value for every objective."
    names = [f"{p}.arrived" for p in registry.PROTOCOLS]
    arrivals = designs[[name for name in names if name in designs]]
    lowest = arrivals.min(axis=1, skipna=False)
    if not lowest.notna().any():
        return "No design could be simulated under every protocol."
    nearest = int(np.nanargmax(lowest.to_numpy(float)))
    return (
        f"No design arrives in at least {100 * FEWEST_ARRIVALS:g} % of the trials of the policy "
        f"that is best on it, so that there is no front and no best design. Sample "
        f"{designs['sample'].iloc[nearest]} arrives most often, in "
        f"{100 * lowest.iloc[nearest]:.0f} %. --policies and --seeds choose the policies; hyperleg "
        f"search takes another bound, such as --constraint '{arrivals.columns[0]}>=0.7'."
    )


def endings_table(trials: pd.DataFrame, designs: pd.DataFrame) -> tuple[list[str], list[list[Any]]]:
    """Count the arrivals and falls of each policy over all designs, and the designs that it is the
    best on.

    Args:
        trials: of `run_trials`.
        designs: one row for each design, of `design_table`.

    Returns:
        Heads, and a row for each policy.
    """
    run = trials[trials["trial"] >= 0]
    rows: list[list[Any]] = []
    for (protocol, policy), own in run.groupby(["protocol", "policy"], sort=False):
        shares = [100 * float((own[name] > 0).mean()) for name in ("arrived", "fell")]
        best_on = int((designs[f"{protocol}.policy"] == policy).sum())
        rows.append([protocol, policy, len(own), *shares, best_on])
    return ["protocol", "policy", "trials", "arrivals [%]", "falls [%]", "best on designs"], rows


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
            policy_names(row),
            policy_kind(row),
        ]
        for _, row in firsts.iterrows()
    ]
    heads = ["best by", *design_heads(sweep), *objectives, "policy", "policy is"]
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


def policy_names(row: Any) -> str:
    """Name the policies that a design is judged by.

    Args:
        row: of the table of designs, or as a search stores it.

    Returns:
        The best policy of each protocol.
    """
    return ", ".join(_texts(row, "policy"))


def policy_kind(row: Any) -> str:
    """Say whether the policies that a design is judged by were trained for it.

    Args:
        row: of the table of designs, or as a search stores it.

    Returns:
        The kinds of policies.
    """
    kind = ", ".join(dict.fromkeys(_texts(row, "trained")))
    return f"{kind} (outside the trained range)" if any(_texts(row, "outside")) else kind


def _texts(row: Any, name: str) -> list[str]:
    """Texts of a name that each protocol has a column of; none where it could not be run."""
    return [v for c, v in row.items() if str(c).endswith(f".{name}") and isinstance(v, str)]


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
