"""Pictures of a sweep: maps over two axes, curves over one, Pareto fronts; all that its definition
asks for.
"""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import figure_style, save, variant_colour
from hyperleg_design.report.sweep.parallel_figure import parallel_figure
from hyperleg_design.report.sweep.rows import (
    axis_of,
    base_level,
    base_value,
    fronts_of,
    thinned,
    variant_title,
)
from hyperleg_design.sweep import measures
from hyperleg_design.sweep.axis import Axis
from hyperleg_design.sweep.evaluate import Columns
from hyperleg_design.sweep.run import SweepResult
from hyperleg_design.sweep.space import Map, Sweep
from hyperleg_design.sweep.summary import base_values

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POINTS = 4000
"""Points drawn of a cloud; more would only thicken it."""

_INK = "#1d2129"


def draw_sweep(result: SweepResult, folder: str | Path) -> dict[str, str]:
    """All figures that a sweep's definition asks for, as PNG files in a folder.

    Returns:
        Caption of each file, by file name.
    """
    folder = Path(folder)
    sweep = result.sweep
    captions: dict[str, str] = {}
    for index, chosen in enumerate(sweep.maps):
        name = f"{sweep.name}-map-{index + 1}.png"
        save(
            map_figure(result, chosen) if chosen.y else curve_figure(result, chosen), folder / name
        )
        captions[name] = (
            f"{measures.measure_of(chosen.measure).doc} {_fixed_text(sweep, chosen)}".strip()
        )
    if len(sweep.objectives) > 1:
        save(pareto_figure(result), folder / f"{sweep.name}-pareto.png")
        captions[f"{sweep.name}-pareto.png"] = (
            "Designs that no other beats in every objective, of each variant; a star marks the "
            "unchanged design."
        )
        save(parallel_figure(result), folder / f"{sweep.name}-parallel.png")
        captions[f"{sweep.name}-parallel.png"] = (
            "Designs of the Pareto fronts over all axes and objectives, before a sample of all "
            "(grey); black is the unchanged design."
        )
    return captions


def map_figure(result: SweepResult, chosen: Map) -> Figure:
    """A measure over two axes, a panel a variant that has it.

    In a grid the other axes stand at the level nearest to the unchanged design; a sampled sweep
    shows medians over samples that lie close together in the two axes.

    Raises:
        InputError: no design has this measure.
    """
    sweep = result.sweep
    x_axis, y_axis = axis_of(sweep, chosen.x), axis_of(sweep, chosen.y)
    shown = _shown(result, chosen)
    with figure_style():
        import matplotlib.pyplot as plt
        from matplotlib.colors import LogNorm, Normalize

        figure, panels = plt.subplots(
            1,
            len(shown),
            figsize=(1.4 + 3.9 * len(shown), 3.7),
            sharey=True,
            squeeze=False,
            layout="constrained",
        )
        drawn = [
            _draw_map(panel, sweep, part, chosen)
            for panel, part in zip(panels[0], shown.values(), strict=True)
        ]
        every = np.concatenate([np.ma.compressed(d.get_array()) for d in drawn])
        low, high = float(every.min()), float(every.max())
        scale = (
            LogNorm(low, high)
            if _wide(every)
            else Normalize(low, high if high > low else low + 1.0)
        )
        for panel, mesh, variant in zip(panels[0], drawn, shown, strict=True):
            mesh.set_norm(scale)
            base = (base_value(x_axis, sweep), base_value(y_axis, sweep))
            panel.plot(
                *base,
                marker="*",
                markersize=13,
                color="white",
                markeredgecolor=_INK,
                linestyle="none",
                zorder=5,
            )
            panel.set(
                xlabel=_axis_label(x_axis, sweep),
                title=variant_title(variant) if len(shown) > 1 else "",
            )
            panel.grid(False)
            if sweep.sampling != "grid":
                _log_ticks(panel, x_axis.log, y_axis.log)
        panels[0][0].set_ylabel(_axis_label(y_axis, sweep))
        bar = figure.colorbar(drawn[0], ax=list(panels[0]), label=measures.label(chosen.measure))
        if _wide(every):
            _plain_log(bar.ax.yaxis)
        return figure


def _shown(result: SweepResult, chosen: Map) -> dict[str, Columns]:
    """Rows that a map draws, by variant."""
    sweep = result.sweep
    drawn = [name for name in (chosen.x, chosen.y) if name]
    others = [a.name for a in sweep.axes if a.name not in drawn] if sweep.sampling == "grid" else []
    table = result.columns(["variant", *drawn, *others, chosen.measure])
    keep = ~np.isnan(table[chosen.measure])
    for name in others:
        keep &= table[name] == base_level(axis_of(sweep, name), sweep)
    shown = {
        v: {k: c[keep & (table["variant"] == v)] for k, c in table.items()} for v in sweep.variants
    }
    shown = {v: t for v, t in shown.items() if t[chosen.measure].size}
    if not shown:
        raise InputError(
            sweep.source, "maps.measure", chosen.measure, "has no value in any design of this sweep"
        )
    return shown


def _draw_map(panel: Any, sweep: Sweep, part: Columns, chosen: Map) -> Any:
    x, y, z = part[chosen.x], part[chosen.y], part[chosen.measure]
    if sweep.sampling != "grid":
        log = {
            f"{k}scale": "log"
            for k, name in (("x", chosen.x), ("y", chosen.y))
            if axis_of(sweep, name).log
        }
        return panel.hexbin(
            x,
            y,
            C=z,
            reduce_C_function=np.median,
            gridsize=16,
            cmap="viridis",
            linewidths=0.2,
            **log,
        )
    columns, rows = np.unique(x), np.unique(y)
    grid = np.full((rows.size, columns.size), np.nan)
    grid[np.searchsorted(rows, y), np.searchsorted(columns, x)] = z
    drawn = panel.pcolormesh(
        columns,
        rows,
        np.ma.masked_invalid(grid),
        shading="nearest",
        rasterized=True,
        cmap="viridis",
    )
    if (
        np.isfinite(grid).all()
        and min(grid.shape) > 2
        and float(np.ptp(grid)) > 1e-3 * float(np.abs(grid).max())
    ):
        from matplotlib.patheffects import withStroke

        lines = panel.contour(columns, rows, grid, levels=6, colors="white", linewidths=0.9)
        dark = [withStroke(linewidth=2.0, foreground="#1d212999")]
        for text in panel.clabel(lines, fontsize=8.5, fmt="%.4g"):
            text.set_path_effects(dark)
    return drawn


def curve_figure(result: SweepResult, chosen: Map) -> Figure:
    """A measure over one axis, a line a variant (dots in a sampled sweep); others as in
    `map_figure`.

    Raises:
        InputError: no design has this measure.
    """
    sweep = result.sweep
    axis = axis_of(sweep, chosen.x)
    shown = _shown(result, chosen)
    grid = sweep.sampling == "grid"
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(5.6, 3.6), layout="constrained")
        widths = (
            np.linspace(4.5, 1.6, len(shown)) if len(shown) > 1 else [2.0]
        )  # lines that coincide stay visible
        for (variant, part), width in zip(shown.items(), widths, strict=True):
            order = np.argsort(part[chosen.x], kind="stable")
            look = (
                {"linewidth": width}
                if grid
                else {"linestyle": "none", "marker": ".", "markersize": 3, "alpha": 0.4}
            )
            panel.plot(
                part[chosen.x][order],
                part[chosen.measure][order],
                color=variant_colour(variant),
                label=variant_title(variant),
                **look,
            )
            base = base_values(sweep, variant)
            if chosen.measure in base:
                star = {
                    "marker": "*",
                    "markersize": 12,
                    "markeredgecolor": _INK,
                    "linestyle": "none",
                    "zorder": 5,
                }
                panel.plot(
                    base_value(axis, sweep),
                    base[chosen.measure],
                    color=variant_colour(variant),
                    **star,
                )
        panel.set(xlabel=_axis_label(axis, sweep), ylabel=measures.label(chosen.measure))
        if len(shown) > 1:
            panel.legend()
        return figure


def pareto_figure(result: SweepResult) -> Figure:
    """Every pair of objectives: all designs as clouds, the fronts over all objectives on top, in
    their variant's colour.

    Raises:
        InputError: the sweep has fewer than two objectives.
    """
    sweep = result.sweep
    if len(sweep.objectives) < 2:
        raise InputError(
            sweep.source, "objectives", list(sweep.objectives), "expects at least two measures"
        )
    table, fronts = fronts_of(result)
    pairs = list(combinations(sweep.objectives, 2))
    with figure_style():
        import matplotlib.pyplot as plt

        across = min(3, len(pairs))
        down = -(-len(pairs) // across)
        figure, panels = plt.subplots(
            down,
            across,
            figsize=(4.1 * across + 0.3, 3.5 * down + 0.5),
            squeeze=False,
            layout="constrained",
        )
        for panel in panels.ravel()[len(pairs) :]:
            panel.set_visible(False)
        for panel, (first, second) in zip(panels.ravel(), pairs, strict=False):
            for variant, front in fronts.items():
                colour = variant_colour(variant)
                rows = np.flatnonzero(table["variant"] == variant)
                cloud = rows[thinned(rows.size, _POINTS)]
                panel.scatter(
                    table[first][cloud],
                    table[second][cloud],
                    s=4,
                    color=colour,
                    alpha=0.22,
                    linewidths=0,
                    rasterized=True,
                )
                _draw_front(
                    panel,
                    table,
                    front,
                    first,
                    second,
                    colour,
                    variant_title(variant),
                    joined=len(sweep.objectives) == 2,
                )
                base = base_values(sweep, variant)
                if first in base and second in base:
                    panel.plot(
                        base[first],
                        base[second],
                        marker="*",
                        markersize=13,
                        color=colour,
                        markeredgecolor=_INK,
                        linestyle="none",
                        zorder=6,
                    )
            panel.set(xlabel=_objective_label(first))
            panel.set_ylabel(_objective_label(second), fontsize=9)
            _log_where_wide(panel, table, (first, second), fronts)
        handles, labels = panels[0, 0].get_legend_handles_labels()
        if len(fronts) > 1:
            figure.legend(
                handles, labels, loc="outside upper center", ncols=len(fronts), markerscale=1.5
            )
        return figure


def _draw_front(
    panel: Any,
    table: Columns,
    front: np.ndarray,
    first: str,
    second: str,
    colour: str,
    label: str,
    *,
    joined: bool,
) -> None:
    x, y = table[first][front], table[second][front]
    if joined and front.size > 1:
        order = np.lexsort((y, x))
        # between two designs of the front lies nothing better: a staircase, not a line
        where = "post" if measures.measure_of(first).better == "low" else "pre"
        panel.step(x[order], y[order], where=where, color=colour, linewidth=1.2, zorder=3)
    panel.scatter(
        x, y, s=16, color=colour, edgecolors="white", linewidths=0.4, label=label, zorder=4
    )


def _log_where_wide(
    panel: Any, table: Columns, pair: tuple[str, str], fronts: dict[str, np.ndarray]
) -> None:
    """A logarithmic axis where positive values span more than a factor of 20."""
    shown = np.isin(table["variant"], list(fronts))
    wide = [_wide(table[name][shown & ~np.isnan(table[name])]) for name in pair]
    _log_ticks(panel, *wide)


def _wide(values: np.ndarray) -> bool:
    return bool(values.size and values.min() > 0 and values.max() > 20 * values.min())


def _log_ticks(panel: Any, x: bool, y: bool) -> None:
    if x:
        panel.set_xscale("log")
        _plain_log(panel.xaxis)
    if y:
        panel.set_yscale("log")
        _plain_log(panel.yaxis)


def _plain_log(axis: Any) -> None:
    """Ticks at 1, 2, 5 of each decade, written as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def _fixed_text(sweep: Sweep, chosen: Map) -> str:
    """What a map's other axes stand at, for its caption."""
    if sweep.sampling != "grid":
        what = "Medians over neighbouring samples" if chosen.y else "All samples"
        return f"{what}, whatever their other axes; a star marks the unchanged design."
    fixed = []
    for axis in sweep.axes:
        if axis.name not in (chosen.x, chosen.y):
            level = base_level(axis, sweep)
            fixed.append(
                f"{axis.label} at {level:g}" if axis.numeric else f"{axis.label} at {level}"
            )
    return (
        f"{'With ' + ', '.join(fixed) + '; a' if fixed else 'A'} star marks the unchanged design."
    )


def _axis_label(axis: Axis, sweep: Sweep) -> str:
    if (
        axis.scaled
        and len(axis.paths) == 1
        and np.ndim(sweep.base[axis.paths[0]]) == 0
        and sweep.base[axis.paths[0]] != 1.0
    ):
        return f"{axis.name} [x {sweep.base[axis.paths[0]]:g}]"
    return axis.label


def _objective_label(column: str) -> str:
    better = "lower" if measures.measure_of(column).better == "low" else "higher"
    return f"{measures.label(column)}, {better} is better"
