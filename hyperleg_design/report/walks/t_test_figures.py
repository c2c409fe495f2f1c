"""Figures of evaluated T-tests: ways over the course, and the speed along them (the paper's Fig.
7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation.rollout import ARRIVED
from hyperleg_design.report.style import VARIANT_COLOUR, figure_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.evaluation.protocol import TTestProtocol
    from hyperleg_design.evaluation.result import Evaluation

FASTEST = 4.0
"""Upper end of the colours [m/s]."""
SMOOTHING = 0.3
"""Moving mean of the speed that is drawn [s]."""
_GREY, _COURSE = "#6b7280", "#1d2129"


def t_test_figure(runs: Mapping[str, Sequence[Evaluation]], step: float) -> Figure:
    """Draw the course, the ways of all trials coloured by speed with a panel for each design, and
    the speed over the way below.

    Args:
        runs: evaluations under one T-test protocol by design.
        step: between places of a path [s].

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection

    protocol = next(iter(runs.values()))[0].protocol
    count = 1 + len(runs)
    with figure_style():
        figure = plt.figure(figsize=(3.7 * count, 7.0), layout="constrained")
        grid = figure.add_gridspec(2, count, height_ratios=[1.55, 1.0])
        layout = figure.add_subplot(grid[0, 0])
        _course(layout, protocol)
        layout.set_title("layout", loc="left")
        _order(layout, protocol)
        panels, lines = [layout], None
        for column, (name, evaluations) in enumerate(runs.items(), 1):
            axes = figure.add_subplot(grid[0, column], sharex=layout, sharey=layout)
            panels.append(axes)
            _course(axes, protocol)
            for evaluation in evaluations:
                for path, outcome in zip(evaluation.paths, evaluation.outcomes, strict=True):
                    if len(path) < 3:
                        continue
                    seen = path[:, ::-1] * [-1.0, 1.0]  # ahead is up, left is left
                    parts = list(np.stack([seen[:-1], seen[1:]], 1))
                    lines = LineCollection(
                        parts, cmap="viridis", norm=plt.Normalize(0, FASTEST), lw=0.9, alpha=0.7
                    )
                    lines.set_array(speeds(path, step)[1:])
                    axes.add_collection(lines)
                    if outcome != ARRIVED:
                        axes.plot(*seen[-1], "x", color="#b3372f", ms=7, mew=2, zorder=5)
            trials = sum(len(evaluation.outcomes) for evaluation in evaluations)
            ended = sum(
                outcome != ARRIVED for evaluation in evaluations for outcome in evaluation.outcomes
            )
            axes.set_title(
                f"{name.replace('_', ' ')}\n{trials} trials, {ended} without arrival"
                + (" (crosses)" if ended else ""),
                loc="left",
            )
        for axes in panels:
            axes.set_aspect("equal")
            axes.set_xlabel("right [m]")
            axes.grid(False)
        layout.set_ylabel("ahead [m]")
        if lines is not None:
            figure.colorbar(lines, ax=panels, shrink=0.7, label="speed [m/s]", pad=0.01)
        below = figure.add_subplot(grid[1, :])
        for name, evaluations in runs.items():
            _speed(
                below, evaluations, step, VARIANT_COLOUR.get(name, _GREY), name.replace("_", " ")
            )
        below.set(xlabel="way of the pelvis [m]", ylabel="speed [m/s]")
        below.set_ylim(0, 1.18 * below.get_ylim()[1])  # room for the legend
        if below.get_legend_handles_labels()[0]:
            below.legend(loc="upper right", ncols=len(runs))
    return figure


def speeds(path: np.ndarray, step: float) -> np.ndarray:
    """Compute the speed at each place of a path, as a moving mean over `SMOOTHING`.

    Args:
        path: places at even times, `(t, 2)` [m].
        step: between them [s].

    Returns:
        The speeds [m/s], `(t,)`.
    """
    raw = np.linalg.norm(np.gradient(path, step, axis=0), axis=-1)
    width = min(len(raw), max(1, round(SMOOTHING / step)))
    window = np.ones(width)
    return np.asarray(
        np.convolve(raw, window, "same") / np.convolve(np.ones(len(raw)), window, "same")
    )


def _course(axes: Axes, protocol: TTestProtocol) -> None:
    place = protocol.course
    axes.plot(-place[:, 1], place[:, 0], color=_COURSE, lw=1.0, ls=(0, (4, 3)), zorder=1)
    start = protocol.points[protocol.order[0]]
    for name, (x, y) in protocol.points.items():
        axes.add_patch(_circle((-(y - start[1]), x - start[0]), protocol.arrival))
        axes.annotate(
            name,
            (-(y - start[1]), x - start[0]),
            xytext=(7, 9),
            textcoords="offset points",
            fontsize=11,
            fontweight="bold",
        )
    low, high = place.min(0) - 1.6, place.max(0) + 1.6
    axes.set(xlim=(-high[1], -low[1]), ylim=(low[0], high[0]))


def _circle(centre: tuple[float, float], radius: float) -> Any:
    from matplotlib.patches import Circle

    return Circle(centre, radius, fill=False, color=_GREY, lw=0.9)


def _order(axes: Axes, protocol: TTestProtocol) -> None:
    """Arrows along the legs with their numbers, a leg that is run twice beside itself."""
    place = protocol.course[:, ::-1] * [-1.0, 1.0]
    for i, (a, b) in enumerate(pairwise(place)):
        along = (b - a) / np.linalg.norm(b - a)
        aside = 0.22 * np.array([along[1], -along[0]])
        begin, end = a + 0.18 * (b - a) + aside, a + 0.82 * (b - a) + aside
        axes.annotate(
            "", end, begin, arrowprops={"arrowstyle": "-|>", "color": "#c8602a", "lw": 1.4}
        )
        axes.annotate(
            str(i + 1),
            begin + 0.3 * (end - begin) + aside,
            color="#c8602a",
            ha="center",
            va="center",
            fontsize=10,
        )


def _speed(
    axes: Axes, evaluations: Sequence[Evaluation], step: float, colour: str, label: str
) -> None:
    """Median and middle half of the trials' speed over their way."""
    curves = []
    for evaluation in evaluations:
        for path, outcome in zip(evaluation.paths, evaluation.outcomes, strict=True):
            if outcome == ARRIVED and len(path) > 2:
                way = np.concatenate(
                    [[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=-1))]
                )
                curves.append((way, speeds(path, step)))
    if not curves:
        return
    end = float(np.median([way[-1] for way, _ in curves]))
    at = np.linspace(0, end, 300)
    values = np.array([np.interp(at, way, speed) for way, speed in curves])
    low, middle, high = np.quantile(values, [0.25, 0.5, 0.75], axis=0)
    axes.fill_between(at, low, high, color=colour, alpha=0.2, lw=0)
    axes.plot(
        at, middle, color=colour, lw=1.6, label=f"{label}: median and middle half of arrived trials"
    )
    axes.margins(x=0.01)
