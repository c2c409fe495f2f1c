"""The page of a sweep whose designs were evaluated: maps, limits, sensitivities, fronts, best
designs.
"""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation.measures import OUTCOMES
from hyperleg_design.report.page import Commands, Details, Explorer, Page, Section, Table, render
from hyperleg_design.report.sweep.explorer import explorer
from hyperleg_design.report.sweep.page import sweep_content
from hyperleg_design.report.sweep.rows import without_variants
from hyperleg_design.report.sweep.trials_text import (
    best_text,
    design_cells,
    design_heads,
    endings_table,
    no_walk_text,
    policies_of,
    policy_kind,
    policy_names,
    policy_text,
    unsimulated_text,
    with_interval,
)
from hyperleg_design.report.text import table as text_table
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.spaces.definition import Map, Sweep
from hyperleg_design.sweep.trial_runs import TRIALS
from hyperleg_design.sweep.trial_table import (
    FEWEST_ARRIVALS,
    SHOWN,
    best,
    build_command,
    design_table,
    front,
    sensitivities,
)
from hyperleg_design.writing import plain, write_bytes, write_json, write_text

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.sweep.run import SweepResult

DESIGNS, SUMMARY = "evaluated.parquet", "evaluated.json"
DEFAULT_OBJECTIVES = ("walk.cost_of_transport", "walk.grf_peak_body_weights", "t_test.time")
"""Where a sweep names none of its own."""
_MOST_FRONT = 30
"""Rows of a front on the page; the table has all."""


def evaluated_report(result: SweepResult) -> dict[str, Any]:
    """Write `evaluated.parquet`, `evaluated.json` and `index.html` into a sweep's folder.

    Args:
        result: a sweep after `run_trials`.

    Returns:
        `designs`, `rejected`, `rejected_because`, `files`, and `text`, the best designs for a
        terminal.
    """
    import pandas as pd

    sweep, folder = result.sweep, result.folder
    trials = pd.read_parquet(folder / TRIALS)
    protocols = [p for p in registry.PROTOCOLS if (trials["protocol"] == p).any()]
    columns = result.columns()
    designs = design_table(sweep, trials, columns)
    objectives = objectives_of(sweep, designs)
    policies = [f"{protocol}.policy" for protocol in protocols]
    followed = _followed(sweep, designs)
    fronts = front(designs, objectives) if objectives else designs.iloc[:0]
    chosen = best(designs, objectives)
    commands = [build_command(sweep, dict(row)) for _, row in chosen.iterrows()]
    stream = io.BytesIO()
    designs.to_parquet(stream, index=False)
    write_bytes(folder / DESIGNS, stream.getvalue())
    write_json(
        folder / SUMMARY,
        {
            "sweep": sweep.name,
            "protocols": protocols,
            "objectives": list(objectives),
            "policies": policies_of(trials),
            "sensitivities": followed,
            "front": _plain(
                fronts, ["sample", "variant", *policies, "on_front", "front_probability"]
            ),
            "best": [
                {**row, "build": command}
                for row, command in zip(
                    _plain(chosen, ["by", "sample", "variant", *policies, *objectives]),
                    commands,
                    strict=True,
                )
            ],
        },
    )
    ran = [policy_text(trials), *_policy_table(sweep, designs, protocols)]
    sections = [
        Section("Policies", [*ran, Table(*endings_table(trials, designs))]),
        Section("Measures over the parameters", [_explorer(sweep, designs, fronts, "evaluated")]),
        Section("Limits that act", [_limits(designs, protocols)]),
        Section("Which parameter each measure follows", [_sensitivity_table(followed)]),
        Section("Pareto front", _front_tables(sweep, designs, fronts, objectives)),
        Section("Best designs", _best_tables(sweep, designs, chosen, commands, objectives)),
        Section("Sizing measures", sweep_content(result)),
    ]
    described = f"{sweep.description.removesuffix('.')}. " if sweep.description else ""
    page = Page(
        title=f"Sweep {sweep.name}",
        lead=f"{described}Every design is evaluated: {', '.join(protocols)}.",
        sections=sections,
        provenance={**result.summary["versions"], "commit": result.summary["commit"]},
    )
    target = write_text(folder / "index.html", render(page))
    return {
        "designs": result.summary["designs"],
        "rejected": result.summary["rejected"],
        "rejected_because": result.summary["rejected_because"],
        "files": [str(folder / name) for name in (TRIALS, DESIGNS, SUMMARY)] + [str(target)],
        "text": unsimulated_text(trials)
        + (
            best_text(sweep, chosen, objectives, commands)
            if len(chosen)
            else f"{no_walk_text(designs)}\n{text_table(*endings_table(trials, designs))}"
        ),
    }


def evaluated_content(
    result: SweepResult, trials: pd.DataFrame, name: str
) -> tuple[list[Any], pd.DataFrame]:
    """What a page of several sweeps says of one whose designs were evaluated.

    Args:
        result: the sweep.
        trials: of its designs.
        name: of the explorer, unique in the page.

    Returns:
        Content of a section, and the table of the designs.
    """
    sweep = result.sweep
    designs = design_table(sweep, trials, result.columns())
    objectives = objectives_of(sweep, designs)
    fronts = front(designs, objectives)
    chosen = best(designs, objectives, count=1)
    commands = [build_command(sweep, dict(row)) for _, row in chosen.iterrows()]
    content = [
        policy_text(trials),
        _explorer(sweep, designs, fronts, name),
        Details(
            "Best designs, endings of each policy, limits that act, and which parameter each "
            "measure follows",
            [
                *_best_tables(sweep, designs, chosen, commands, objectives),
                Table(*endings_table(trials, designs)),
                _limits(designs, [p for p in registry.PROTOCOLS if f"{p}.trials" in designs]),
                _sensitivity_table(_followed(sweep, designs)),
            ],
        ),
    ]
    return content, designs


def _shown(designs: pd.DataFrame) -> list[str]:
    """Measures with intervals that the designs have."""
    return [f"{p}.{m}" for p in registry.PROTOCOLS for m in SHOWN[p] if f"{p}.{m}" in designs]


def _followed(sweep: Sweep, designs: pd.DataFrame) -> list[dict[str, Any]]:
    """Sensitivities of the measures with intervals, arrivals and falls left out."""
    names = [name for name in _shown(designs) if name.rpartition(".")[2] not in OUTCOMES]
    return sensitivities(sweep, designs, names)


def objectives_of(sweep: Sweep, designs: pd.DataFrame) -> tuple[str, ...]:
    """Choose the objectives of the front: those of the sweep that were measured, or the usual ones.

    Args:
        sweep: the definition.
        designs: one row for each design.

    Returns:
        Names of the measures.
    """
    own = tuple(n for n in (*sweep.objectives, *sweep.trial_objectives) if n in designs)
    return own or tuple(n for n in DEFAULT_OBJECTIVES if n in designs)


def _policy_table(sweep: Sweep, designs: pd.DataFrame, protocols: list[str]) -> list[Any]:
    rows = []
    for protocol in protocols:
        own = designs[designs[f"{protocol}.trials"] > 0]
        lost = designs[designs[f"{protocol}.trials"] == 0]
        rows += [
            [
                protocol,
                str(v),
                len(part),
                int((part[f"{protocol}.arrived"] >= FEWEST_ARRIVALS).sum()),
                int((part[f"{protocol}.fell"] > 0.5).sum()),
            ]
            for v, part in own.groupby("variant", sort=False)
        ]
        rows += [
            [protocol, str(row["variant"]), f"sample {row['sample']}: {row[f'{protocol}.reason']}"]
            for _, row in lost.iterrows()
        ]
    arrive = f"of these arrive in at least {100 * FEWEST_ARRIVALS:g} %"
    heads = ["protocol", "variant", "designs evaluated", arrive, "of these fall in most trials"]
    padded = [[*row, *[""] * (len(heads) - len(row))] for row in rows]
    return [Table(*without_variants(heads, padded))]


def _explorer(sweep: Sweep, designs: pd.DataFrame, fronts: pd.DataFrame, name: str) -> Explorer:
    """Every evaluated design; bars are intervals over trials of its best policy."""
    names = dict.fromkeys([*_shown(designs), *(chosen.measure for chosen in sweep.trial_maps)])
    labels = {measure: registry.label(measure) for measure in names if measure in designs}
    keys = ["sample", "variant"]
    best_rows = fronts[fronts["on_front"]] if len(fronts) else fronts
    front = designs.set_index(keys).index.isin(best_rows.set_index(keys).index)
    numeric = [axis.name for axis in sweep.axes if axis.numeric]
    maps = [chosen for chosen in sweep.trial_maps if chosen.measure in labels]
    if not maps and numeric:
        maps = [Map(numeric[0], "", measure) for measure in differing_first(designs, labels)]
    table = {str(column): designs[column].to_numpy() for column in designs}
    return explorer(sweep, table, labels, maps, front, name)


def differing_first(designs: pd.DataFrame, names: Iterable[str]) -> list[str]:
    """Put measures that are the same for every design, such as arrivals where all trials arrive,
    behind those that differ.

    Args:
        designs: one row for each design.
        names: columns of measures; missing numbers are left out.

    Returns:
        The names; within each of the two groups in the order in which they are given.
    """
    return sorted(names, key=lambda name: designs[name].nunique() < 2)


def _limits(designs: pd.DataFrame, protocols: list[str]) -> Table:
    rows = []
    for protocol in protocols:
        own = designs[designs[f"{protocol}.trials"] > 0]
        for (variant, limits), part in own.groupby(["variant", f"{protocol}.limits"], sort=False):
            rows.append([protocol, str(variant), str(limits), len(part)])
    caption = (
        "Envelope: motors are on its edge for more than 1 % of the time. Heat: the moving average "
        "of squared torque passes the rated torque's. Speed: a motor passes 95 % of its no-load "
        "speed."
    )
    heads = ["protocol", "variant", "limits that act", "designs"]
    return Table(*without_variants(heads, rows), caption)


def _sensitivity_table(followed: list[dict[str, Any]]) -> Table:
    rows = [
        [
            row["variant"],
            registry.label(row["measure"]),
            row["parameter"],
            row["elasticity"],
            row["low"],
            row["high"],
            100 * row["effect"],
        ]
        for row in followed
    ]
    headers = ["variant", "measure", "parameter", "elasticity", "low", "high", "effect [%]"]
    caption = (
        "Elasticity: change of the measure in per cent where the parameter grows by one per cent, "
        "over all designs. Effect: change of the measure over the parameter's whole range. The "
        "parameters of each measure are listed in the order of their effects, the largest first."
    )
    return Table(*without_variants(headers, rows), caption)


def _front_tables(
    sweep: Sweep, designs: pd.DataFrame, fronts: pd.DataFrame, objectives: tuple[str, ...]
) -> list[Any]:
    if fronts.empty:
        return [no_walk_text(designs)]
    rows = [
        [
            *design_cells(sweep, row),
            *(with_interval(row, name) for name in objectives),
            policy_names(row),
            bool(row["on_front"]),
            row["front_probability"],
        ]
        for _, row in fronts.head(_MOST_FRONT).iterrows()
    ]
    heads = [*design_heads(sweep), *map(registry.label, objectives)]
    return [
        Table(
            [*heads, "policy", "on the front of the means", "probability of the front"],
            rows,
            "Designs that no other beats in every objective, or may be: the probability counts the "
            "intervals of what was measured.",
        )
    ]


def _best_tables(
    sweep: Sweep,
    designs: pd.DataFrame,
    chosen: pd.DataFrame,
    commands: list[str],
    objectives: tuple[str, ...],
) -> list[Any]:
    if chosen.empty:
        return [no_walk_text(designs)]
    rows = [
        [
            registry.label(row["by"]),
            *design_cells(sweep, row),
            *(with_interval(row, name) for name in objectives),
            policy_names(row),
            policy_kind(row),
        ]
        for _, row in chosen.iterrows()
    ]
    measured = map(registry.label, objectives)
    heads = ["best by", *design_heads(sweep), *measured, "policy", "policy is"]
    builds = {  # a design that is among the best by several objectives, once
        f"{command}  # sample {int(row['sample'])}": None
        for (_, row), command in zip(chosen.iterrows(), commands, strict=True)
    }
    return [Table(heads, rows), "Commands that build these designs:", Commands(list(builds))]


def _plain(designs: pd.DataFrame, columns: list[str]) -> list[dict[str, Any]]:
    return [
        {name: plain(row[name]) for name in columns if name in designs}
        for _, row in designs.iterrows()
    ]
