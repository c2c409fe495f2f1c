"""Figures and texts of single effects: the catalogue, and one effect's trace on the standard
motion.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.gap.model.joint_units import joint_unit
from hyperleg_design.gap.playback.show import Shown
from hyperleg_design.report.gap.choices import chosen
from hyperleg_design.report.style import figure_style, save

TRACE, RESIDUAL, BEFORE, TARGET = "#c8602a", "#9ca3af", "#2f6db3", "#6b7280"
ZOOM = 2.0
"""Length of the stretch of the closed loop that is drawn large [s]."""
PLACES = {
    "motion": "residual of motion",
    "drive": "residual of the drive",
    "base": "residual of the base",
    "ground": "residual of the ground",
}


def effects_text(table: Sequence[Mapping[str, Any]]) -> str:
    """Write the catalogue as lines: identifier, kind of place and summary, then a line for each
    parameter.

    Args:
        table: the catalogue, one mapping for each effect.

    Returns:
        The text.
    """
    lines = []
    for entry in table:
        lines.append(f"{entry['effect']}  ({entry['where']})  {entry['summary']}")
        for p in entry["parameters"]:
            if p["choices"]:
                lines.append(
                    f"    {p['name']}: "
                    f"{', '.join(f'{i} {words}' for i, words in enumerate(p['choices']))}"
                )
                continue
            unit = f" {p['unit']}" if p["unit"] else ""
            shape = ", shapes the trace only" if p["shape"] else ""
            of = " of its place's strength" if p["of_strength"] else unit
            lines.append(
                f"    {p['name']}: {p['null']:g}{unit} without, usually {p['typical']:g}{of} off, "
                f"{p['low']:g} .. {p['high']:g}{unit}{shape}"
            )
            lines += textwrap.wrap(
                p["source"], 110, initial_indent="        ", subsequent_indent="        "
            )
    return "\n".join(lines)


def show_summary(shown: Shown) -> dict[str, Any]:
    """Summarise what was shown and how large it is, as JSON takes it.

    Args:
        shown: one effect on the standard motion.

    Returns:
        The summary.
    """
    known = np.isfinite(shown.trace) & np.isfinite(shown.residual)
    return {
        "effect": shown.effect.identifier,
        "robot": shown.robot,
        "location": shown.location,
        "parameters": {
            p.name: {"value": float(v), "unit": unit}
            for p, unit, v in zip(shown.effect.parameters, shown.units, shown.values, strict=True)
        },
        "residual": shown.residual_name,
        "row": shown.row,
        "trace_rms": _rms(shown.trace[known]),
        "residual_rms": _rms(shown.residual[known]),
        "unit": shown.unit,
        "closed_loop_rms": _rms(shown.after - shown.before),
        "closed_loop_unit": joint_unit("rad", shown.slides),
    }


def show_text(summary: Mapping[str, Any]) -> str:
    """Write what `show_summary` returns as text for a terminal.

    Args:
        summary: the summary.

    Returns:
        The text.
    """
    values = ", ".join(
        words or f"{name} {v['value']:.4g} {v['unit']}".rstrip()
        for name, v, words in chosen(summary["effect"], summary["parameters"])
    )
    lines = [f"{summary['effect']} at {summary['location']} of {summary['robot']}: {values}"]
    if summary["residual"]:
        place = PLACES[summary["residual"]]
        unit = summary["unit"]
        lines.append(
            f"trace {summary['trace_rms']:.3g} {unit} RMS in the {place}, row {summary['row']}; "
            f"simulated {summary['residual_rms']:.3g} {unit}"
        )
    else:
        lines.append("leaves no trace on this motion")
    lines.append(
        f"moves the closed loop by {1e3 * summary['closed_loop_rms']:.3g} "
        f"m{summary['closed_loop_unit']} RMS"
    )
    return "\n".join([*lines, str(summary["figure"])] if "figure" in summary else lines)


def show_figure(shown: Shown, path: str | Path) -> Path:
    """Draw a shown effect: trace and residual in time, the trace against velocity, position and
    torque, and the closed loop.

    Args:
        shown: one effect on the standard motion.
        path: of the picture.

    Returns:
        The path.
    """
    import matplotlib.pyplot as plt

    with figure_style():
        figure = plt.figure(figsize=(11, 9.6))
        grid = figure.add_gridspec(3, 3, height_ratios=[1.1, 1.0, 1.1], hspace=0.42, wspace=0.3)
        figure.suptitle(
            f"{shown.effect.identifier}: {shown.effect.summary}",
            fontsize=13,
            x=0.08,
            ha="left",
            y=0.985,
        )
        figure.text(0.08, 0.955, _caption(shown), fontsize=9.5, color="#374151", va="top")
        _draw_time(figure.add_subplot(grid[0, :]), shown)
        others = (
            ("velocity", shown.velocity, "rad/s"),
            ("position", shown.position, "rad"),
            ("torque", shown.torque, "Nm"),
        )
        first = None
        for column, (name, values, turning) in enumerate(others):
            axes = figure.add_subplot(grid[1, column], sharey=first)
            first = first or axes
            axes.plot(
                values, shown.trace, ".", markersize=2, color=TRACE, alpha=0.5, rasterized=True
            )
            axes.set_xlabel(f"{name} of {shown.joint} [{joint_unit(turning, shown.slides)}]")
            if column == 0:
                axes.set_ylabel(f"trace [{shown.unit}]")
        _draw_loop(figure.add_subplot(grid[2, :2]), shown)
        axes = figure.add_subplot(grid[2, 2])
        axes.plot(shown.time, 1e3 * (shown.after - shown.before), color=TRACE, linewidth=0.9)
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"moved by the effect [m{joint_unit('rad', shown.slides)}]")
        axes.set_title("all of it", loc="left")
        return save(figure, path, 110)


def _caption(shown: Shown) -> str:
    values = ", ".join(
        f"{p.name} {v:.4g} {unit}".rstrip()
        for p, unit, v in zip(shown.effect.parameters, shown.units, shown.values, strict=True)
    )
    return "\n".join(textwrap.wrap(f"at {shown.location} of {shown.robot}, {values}", 125))


def _draw_time(axes: Any, shown: Shown) -> None:
    axes.set_xlabel("time [s]")
    if not shown.residual_name:
        axes.set_axis_off()
        axes.text(0.5, 0.5, "leaves no trace on this motion", ha="center", transform=axes.transAxes)
        return
    axes.plot(
        shown.time,
        shown.residual,
        color=RESIDUAL,
        linewidth=0.8,
        label="residual of a simulated log with the effect",
    )
    axes.plot(shown.time, shown.trace, color=TRACE, linewidth=1.1, label="trace")
    known = np.abs(np.concatenate([shown.trace, shown.residual]))
    size = float(np.nanpercentile(known, 99.7)) if np.isfinite(known).any() else 1.0
    low = min(
        0.0,
        float(np.nanmin(shown.trace, initial=0.0)),
        float(np.nanpercentile(shown.residual, 0.3)),
    )
    high = max(
        0.0,
        float(np.nanmax(shown.trace, initial=0.0)),
        float(np.nanpercentile(shown.residual, 99.7)),
    )
    room = 0.08 * max(high - low, 1e-3 * size, 1e-12)
    axes.set_ylim(low - room, high + 4.0 * room)
    axes.set_ylabel(f"{shown.row} [{shown.unit}]")
    axes.set_title(PLACES[shown.residual_name], loc="left")
    axes.legend(loc="upper right", ncols=2, fontsize=9)


def _draw_loop(axes: Any, shown: Shown) -> None:
    """The stretch of the closed loop in which the effect moves it most."""
    length = round(ZOOM / float(shown.time[1] - shown.time[0]))
    moved = np.convolve((shown.after - shown.before) ** 2, np.ones(length), "valid")
    start = int(np.argmax(moved))
    part = slice(start, start + length)
    axes.plot(
        shown.time[part],
        shown.target[part],
        color=TARGET,
        linestyle=":",
        linewidth=1.2,
        label="target",
    )
    axes.plot(shown.time[part], shown.before[part], color=BEFORE, linewidth=1.2, label="without")
    axes.plot(
        shown.time[part], shown.after[part], color=TRACE, linewidth=1.2, label="with the effect"
    )
    values = np.concatenate([shown.target[part], shown.before[part], shown.after[part]])
    room = 0.08 * max(float(np.ptp(values)), 1e-6)
    axes.set_ylim(values.min() - room, values.max() + 3.5 * room)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"{shown.joint} [{joint_unit('rad', shown.slides)}]")
    axes.set_title("closed loop, where the effect moves it most", loc="left")
    axes.legend(loc="upper right", ncols=3, fontsize=9)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0
