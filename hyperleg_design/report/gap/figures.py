"""Figures of a diagnosis: what the model lacks, what the causes predict of it, and what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.playback.evidence import Evidence
from hyperleg_design.report.style import figure_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MEASURED, _EXPLAINED, _LEFT = "#2f6db3", "#c8602a", "#6b7280"
QUANTITY = {"N": "force", "Nm": "torque", "m/s": "speed", "rad/s": "speed"}
"""What a residual is, by its unit."""
SIZE = (5.8, 3.4)
"""Size of a figure [in]; it stays legible where a phone scales it down."""
_SPAN = 6.0
"""Longest stretch of a log drawn [s]."""
_MOST_DOTS = 3000


def axis_label(unit: str) -> str:
    """Name what is drawn along an axis: `torque [Nm]`.

    Args:
        unit: of a residual or a speed.

    Returns:
        The label.
    """
    return f"{QUANTITY[unit]} [{unit}]"


def time_figure(shown: Evidence) -> Figure:
    """Draw the residual over time as measured, as explained, and what is left of it, for the row
    where the causes explain most.

    Args:
        shown: evidence of one log.

    Returns:
        The figure.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        row = shown.worst
        window = _window(shown, row)
        time = shown.time[window]
        figure, panel = plt.subplots(figsize=SIZE, layout="constrained")
        panel.plot(time, shown.before[window, row], color=_MEASURED, label="measured")
        if np.nan_to_num(shown.explained[:, row]).any():
            panel.plot(time, shown.explained[window, row], color=_EXPLAINED, label="predicted")
            panel.plot(time, shown.after[window, row], color=_LEFT, linewidth=1, label="left")
        panel.set_xlabel("time [s]")
        panel.set_ylabel(axis_label(shown.units[row]))
        panel.set_title(f"{shown.rows[row]}, {shown.log}")
        panel.legend(ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.16))
        return figure


def speed_figure(shown: Evidence) -> Figure:
    """Draw the residual over speed as measured and as explained, for the same row as in
    `time_figure`.

    Args:
        shown: evidence of one log; the row must have a speed.

    Returns:
        The figure.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        row = shown.worst
        speed = shown.speed[:, row]
        dots = np.flatnonzero(np.isfinite(speed) & np.isfinite(shown.before[:, row]))
        dots = dots[:: max(1, len(dots) // _MOST_DOTS)]
        figure, panel = plt.subplots(figsize=SIZE, layout="constrained")
        panel.plot(speed[dots], shown.before[dots, row], ".", color=_MEASURED, markersize=2)
        if np.nan_to_num(shown.explained[:, row]).any():
            panel.plot(speed[dots], shown.explained[dots, row], ".", color=_EXPLAINED, markersize=2)
        panel.set_xlabel(axis_label(shown.speed_units[row]))
        panel.set_ylabel(axis_label(shown.units[row]))
        panel.set_title(f"{shown.rows[row]}, {shown.log}")
        return figure


def _window(shown: Evidence, row: int) -> slice:
    """The stretch of a log in which the row's residual is largest."""
    length = min(
        len(shown.time), max(2, round(_SPAN / max(float(np.median(np.diff(shown.time))), 1e-9)))
    )
    power = np.concatenate([[0.0], np.cumsum(np.nan_to_num(shown.before[:, row]) ** 2)])
    start = int(np.argmax(power[length:] - power[:-length]))
    return slice(start, start + length)
