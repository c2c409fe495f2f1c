"""The page of a sweep whose designs were evaluated: maps, limits, sensitivities, fronts, best
designs.
"""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.page import Page, Picture, Section, Table, render
from hyperleg_design.report.style import VARIANT_COLOUR, figure_style, save
from hyperleg_design.report.sweep.page import sweep_content
from hyperleg_design.report.sweep.rows import axis_of, base_value
from hyperleg_design.report.text import table as text_table
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.space import Map, Sweep
from hyperleg_design.sweep.trial_runs import TRIALS
from hyperleg_design.sweep.trial_table import (
    SHOWN,
    best,
    build_command,
    design_table,
    front,
    sensitivities,
)
from hyperleg_design.writing import write_bytes, write_json, write_text

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from hyperleg_design.sweep.run import SweepResult

DESIGNS, SUMMARY = "evaluated.parquet", "evaluated.json"
DEFAULT_OBJECTIVES = ("walk.cost_of_transport", "walk.grf_peak_body_weights", "t_test.time")
"""Where a sweep names none of its own."""
_MOST_FRONT = 30
"""Rows of a front on the page; the table has all."""


def evaluated_report(result: SweepResult) -> dict[str, Any]:
    """Write `evaluated.parquet`, `evaluated.json` and `index.html` into a sweep's folder.

    Returns:
        `designs`, `rejected`, `files`, and `text`, the best designs for a terminal.
    """
    import pandas as pd

    sweep, folder = result.sweep, result.folder
    trials = pd.read_parquet(folder / TRIALS)
    protocols = [p for p in registry.PROTOCOLS if (trials["protocol"] == p).any()]
    columns = result.columns()
    designs = design_table(sweep, trials, columns)
    objectives = objectives_of(sweep, designs)
    shown = [f"{p}.{m}" for p in protocols for m in SHOWN[p] if f"{p}.{m}" in designs]
    followed = sensitivities(sweep, designs, [n for n in shown if not n.endswith(".fell")])
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
            "front": _plain(fronts, ["sample", "variant", "on_front", "front_probability"]),
            "best": [
                {**row, "build": command}
                for row, command in zip(
                    _plain(chosen, ["by", "sample", "variant", *objectives]), commands, strict=True
                )
            ],
        },
    )
    sections = [
        Section("Policies", [_policy_text(trials), *_policy_table(sweep, designs, protocols)]),
        Section("Measures over the parameters", _pictures(result, designs, protocols, shown)),
        Section("Limits that act", [_limits(designs, protocols)]),
        Section("Which parameter each measure follows", [_sensitivity_table(followed)]),
        Section("Pareto front", _front_tables(sweep, fronts, objectives)),
        Section("Best designs", _best_tables(sweep, chosen, commands, objectives)),
        Section("Sizing measures", sweep_content(result, folder, "figures")),
    ]
    page = Page(
        title=f"Sweep {sweep.name}",
        lead=f"{sweep.description} Every design is evaluated: {', '.join(protocols)}.",
        sections=sections,
        provenance={**result.summary["versions"], "commit": result.summary["commit"]},
    )
    target = write_text(folder / "index.html", render(page))
    return {
        "designs": result.summary["designs"],
        "rejected": result.summary["rejected"],
        "files": [str(folder / name) for name in (TRIALS, DESIGNS, SUMMARY)] + [str(target)],
        "text": best_text(sweep, chosen, objectives, commands),
    }


def objectives_of(sweep: Sweep, designs: pd.DataFrame) -> tuple[str, ...]:
    """What the front is spanned by: the sweep's objectives that were measured, or the usual."""
    own = tuple(n for n in (*sweep.objectives, *sweep.trial_objectives) if n in designs)
    return own or tuple(n for n in DEFAULT_OBJECTIVES if n in designs)


def policies_of(trials: pd.DataFrame) -> list[dict[str, Any]]:
    """Policies that ran, whether they were trained for what they ran on, and on how many designs.

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


def _policy_text(trials: pd.DataFrame) -> str:
    parts = [
        f"{row['protocol']}, {row['variant']}: {row['designs']} designs {row['trained']} "
        f"({len(row['policies'])} policies)"
        for row in policies_of(trials)
    ]
    return (
        "; ".join(parts)
        + ". A zero-shot policy was trained on another design than it walks here: its numbers are "
        "a lower bound of what a policy trained for the design reaches. Intervals are over "
        "policies and trials."
    )


def _policy_table(sweep: Sweep, designs: pd.DataFrame, protocols: list[str]) -> list[Any]:
    rows = []
    for protocol in protocols:
        own = designs[designs[f"{protocol}.trials"] > 0]
        lost = designs[designs[f"{protocol}.trials"] == 0]
        rows += [
            [protocol, str(v), len(part), int((part[f"{protocol}.fell"] > 0.5).sum())]
            for v, part in own.groupby("variant", sort=False)
        ]
        rows += [
            [protocol, str(row["variant"]), f"sample {row['sample']}: {row[f'{protocol}.reason']}"]
            for _, row in lost.iterrows()
        ]
    return [
        Table(
            ["protocol", "variant", "designs evaluated", "of these fall in most trials"],
            [[*row, *[""] * (4 - len(row))] for row in rows],
        )
    ]


def _pictures(
    result: SweepResult, designs: pd.DataFrame, protocols: list[str], shown: list[str]
) -> list[Any]:
    sweep, folder = result.sweep, result.folder / "figures"
    folder.mkdir(exist_ok=True)
    numeric = [axis.name for axis in sweep.axes if axis.numeric]
    maps = list(sweep.trial_maps)
    if not maps and numeric:
        second = numeric[1] if len(numeric) > 1 and len(numeric) == 2 else ""
        maps = [Map(numeric[0], second, name) for name in shown]
    content: list[Any] = []
    for i, chosen in enumerate(maps):
        if chosen.measure not in designs or not np.isfinite(designs[chosen.measure]).any():
            continue
        name = f"{sweep.name}-trials-{i + 1}.png"
        save(trial_figure(sweep, designs, chosen), folder / name)
        entry = registry.entries()[chosen.measure]
        caption = f"{entry.protocol}: {entry.doc}. Bars are intervals over policies and trials."
        content.append(Picture(f"figures/{name}", caption, wide=False))
    return content or ["No axis holds numbers; see the tables."]


def trial_figure(sweep: Sweep, designs: pd.DataFrame, chosen: Map) -> Figure:
    """A measure of trials over one axis, with intervals, or over two, as dots of its colour."""
    axis = axis_of(sweep, chosen.x)
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(5.6, 3.6), layout="constrained")
        if chosen.y:
            real = designs[np.isfinite(designs[chosen.measure])]
            drawn = panel.scatter(
                real[chosen.x], real[chosen.y], c=real[chosen.measure], s=60, cmap="viridis"
            )
            figure.colorbar(drawn, ax=panel, label=registry.label(chosen.measure))
            panel.set(xlabel=axis.label, ylabel=axis_of(sweep, chosen.y).label)
            return figure
        for variant, own in designs.groupby("variant", sort=False):
            part = own[np.isfinite(own[chosen.measure])].sort_values(chosen.x)
            mean = part[chosen.measure].to_numpy(float)
            bars = None
            if f"{chosen.measure}.low" in part:
                bars = np.nan_to_num(
                    np.stack(
                        [
                            mean - part[f"{chosen.measure}.low"].to_numpy(float),
                            part[f"{chosen.measure}.high"].to_numpy(float) - mean,
                        ]
                    ).clip(0)
                )
            panel.errorbar(
                part[chosen.x],
                mean,
                bars,
                marker="o",
                markersize=3.5,
                capsize=2,
                linestyle="-" if len(sweep.axes) == 1 else "none",
                color=VARIANT_COLOUR[str(variant)],
                label=str(variant).replace("_", " "),
            )
        panel.axvline(base_value(axis, sweep), color="#8a8f99", linewidth=0.8, linestyle=":")
        panel.set(xlabel=axis.label, ylabel=registry.label(chosen.measure))
        if axis.log:
            panel.set_xscale("log")
        if designs["variant"].nunique() > 1:
            panel.legend()
        return figure


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
    return Table(["protocol", "variant", "limits that act", "designs"], rows, caption)


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
        "over all designs. Effect: change over the parameter's whole range; the first parameter of "
        "a measure limits it most."
    )
    return Table(headers, rows, caption)


def _front_tables(sweep: Sweep, fronts: pd.DataFrame, objectives: tuple[str, ...]) -> list[Any]:
    if fronts.empty:
        return ["No design walks without falling more often than in one of 20 trials."]
    rows = [
        [
            *_identity(sweep, row),
            *(_with_interval(row, name) for name in objectives),
            bool(row["on_front"]),
            row["front_probability"],
        ]
        for _, row in fronts.head(_MOST_FRONT).iterrows()
    ]
    heads = [*_identity_heads(sweep), *map(registry.label, objectives)]
    return [
        Table(
            [*heads, "on the front of the means", "probability of the front"],
            rows,
            "Designs that no other beats in every objective, or may be: the probability counts the "
            "intervals of what was measured.",
        )
    ]


def _best_tables(
    sweep: Sweep, chosen: pd.DataFrame, commands: list[str], objectives: tuple[str, ...]
) -> list[Any]:
    if chosen.empty:
        return ["No design walks."]
    rows = [
        [
            registry.label(row["by"]),
            *_identity(sweep, row),
            *(_with_interval(row, name) for name in objectives),
            _trained(row),
            command,
        ]
        for (_, row), command in zip(chosen.iterrows(), commands, strict=True)
    ]
    heads = ["best by", *_identity_heads(sweep), *map(registry.label, objectives)]
    return [Table([*heads, "policy is", "build this one"], rows)]


def best_text(
    sweep: Sweep, chosen: pd.DataFrame, objectives: tuple[str, ...], commands: list[str]
) -> str:
    """The best design by each objective, for a terminal."""
    if chosen.empty:
        return "no design walks without falling"
    firsts = chosen.drop_duplicates("by")
    rows = [
        [
            row["by"],
            *map(str, _identity(sweep, row)),
            *(_with_interval(row, name) for name in objectives),
            _trained(row),
        ]
        for _, row in firsts.iterrows()
    ]
    heads = ["best by", *_identity_heads(sweep), *objectives, "policy is"]
    build = [f"build this one: {commands[int(i)]}" for i in firsts.index]
    return "\n".join([text_table(heads, rows), *build])


def _identity_heads(sweep: Sweep) -> list[str]:
    return ["sample", "variant", *(axis.label for axis in sweep.axes)]


def _identity(sweep: Sweep, row: Any) -> list[Any]:
    values = [row[axis.name] for axis in sweep.axes]
    return [
        int(row["sample"]),
        str(row["variant"]),
        *(float(f"{v:.4g}") if isinstance(v, float) else str(v) for v in values),
    ]


def _trained(row: Any) -> str:
    kinds = [row[c] for c in row.index if c.endswith(".policy") and isinstance(row[c], str)]
    outside = [row[c] for c in row.index if c.endswith(".outside") and isinstance(row[c], str)]
    kind = ", ".join(dict.fromkeys(kinds))
    return f"{kind} (outside the trained range)" if any(outside) else kind


def _with_interval(row: Any, name: str) -> str:
    text = f"{row[name]:.4g}"
    if f"{name}.low" in row and np.isfinite(row[f"{name}.low"]):
        text += f" [{row[f'{name}.low']:.4g}, {row[f'{name}.high']:.4g}]"
    return text


def _plain(designs: pd.DataFrame, columns: list[str]) -> list[dict[str, Any]]:
    return [
        {name: _value(row[name]) for name in columns if name in designs}
        for _, row in designs.iterrows()
    ]


def _value(value: Any) -> Any:
    plain = value.item() if hasattr(value, "item") else value
    return None if isinstance(plain, float) and not np.isfinite(plain) else plain
