"""Figures of evaluated walks: power over the gait cycle (the paper's Fig. 6), impacts over contact
stiffness, motors in their envelopes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation.motion.power import GROUPS
from hyperleg_design.evaluation.statistics import estimate
from hyperleg_design.report.style import VARIANT_COLOUR, figure_style
from hyperleg_design.robot.transmission import motor_names
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.evaluation.rollout import Trial

GROUP_COLOUR = {"hip": "#4c72b0", "knee": "#3b8f57", "ankle": "#8172b3", "toe": "#c8602a"}
_PARTS = {"total": "#1d2129", "Joule heat": "#b3372f", "mechanical": "#2f6db3"}
_GREY = "#6b7280"
_DOTS = 4000
"""Operating points drawn of each motor."""


def cycle_power_figure(walks: Mapping[str, Sequence[Evaluation]]) -> Figure:
    """Draw the power of the right leg over the normalised gait cycle: mechanical power of each
    joint group above, Joule heat and total below.

    Lines are means over policies of their mean strides. Bands span the policies' mean strides, or
    one standard deviation over the strides where there is one policy.

    Args:
        walks: evaluations by design; those without a steady stride are passed over.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    with figure_style():
        figure, grid = plt.subplots(
            2,
            len(walks),
            figsize=(4.9 * len(walks), 6.4),
            sharex=True,
            sharey="row",
            squeeze=False,
            layout="constrained",
        )
        for column, (name, evaluations) in enumerate(walks.items()):
            cycles = [
                [c for c in evaluation.cycles if c is not None and len(c.mechanical)]
                for evaluation in evaluations
            ]
            cycles = [some for some in cycles if some]
            upper, lower = grid[:, column]
            upper.set_title(name.replace("_", " "), loc="left")
            lower.set_xlabel("gait cycle of the right leg, touchdown to touchdown [%]")
            for axes in (upper, lower):
                axes.axhline(0, color=_GREY, lw=0.8, zorder=1)
                axes.margins(x=0)
            if not cycles:
                upper.text(
                    0.5,
                    0.5,
                    "no steady stride",
                    transform=upper.transAxes,
                    ha="center",
                    color=_GREY,
                )
                continue
            for group, colour in GROUP_COLOUR.items():
                if any(joint in GROUPS[group] for joint in cycles[0][0].joints):
                    _band(
                        upper,
                        [np.concatenate([c.of_group(group) for c in some]) for some in cycles],
                        colour,
                        group,
                    )
            heat = [np.concatenate([c.joule.sum(-1) for c in some]) for some in cycles]
            work = [np.concatenate([c.mechanical.sum(-1) for c in some]) for some in cycles]
            for (part, colour), values in zip(
                _PARTS.items(),
                ([h + w for h, w in zip(heat, work, strict=True)], heat, work),
                strict=True,
            ):
                _band(lower, values, colour, part)
        grid[0, 0].set_ylabel("mechanical power of joints [W]")
        grid[1, 0].set_ylabel("power of the leg [W]")
        for axes in grid.flat:
            if axes.get_legend_handles_labels()[0]:
                axes.legend(loc="upper right", fontsize=9)
    return figure


def _band(axes: Axes, policies: Sequence[np.ndarray], colour: str, label: str) -> None:
    """Mean and spread of strides `(strides, points)` of each policy."""
    means = np.array([strides.mean(0) for strides in policies])
    share = np.linspace(0, 100, means.shape[1])
    mean = means.mean(0)
    deviation = policies[0].std(0)
    low, high = (
        (means.min(0), means.max(0)) if len(means) > 1 else (mean - deviation, mean + deviation)
    )
    axes.fill_between(share, low, high, color=colour, alpha=0.18, lw=0)
    axes.plot(share, mean, color=colour, lw=1.8, label=label)


def impact_band_figure(
    band: Mapping[str, Mapping[float, Sequence[Evaluation]]], stiffness: Mapping[float, float]
) -> Figure:
    """Draw impact measures over the stiffness of the pad, by design, with 95 % intervals where
    there are several seeds.

    Args:
        band: evaluations by design and time constant of the contact [s].
        stiffness: of the pad under one heel that each time constant stands for [N/m].

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    shown = (
        ("grf_peak_body_weights", "peak, filtered [body weights]"),
        ("grf_loading_rate", "loading rate [kN/s]"),
        ("grf_impulse", "impulse [Ns]"),
    )
    with figure_style():
        figure, row = plt.subplots(
            1, len(shown), figsize=(4.0 * len(shown), 3.5), layout="constrained"
        )
        for axes, (measure, title) in zip(row, shown, strict=True):
            scale = 1e-3 if measure == "grf_loading_rate" else 1.0
            for i, (design, walks) in enumerate(band.items()):
                constants = sorted(walks)
                estimates = [
                    estimate(
                        [evaluation.values(measure) * scale for evaluation in walks[c]],
                        resamples=1000,
                    )
                    for c in constants
                ]
                x = np.array([stiffness[c] for c in constants]) * 1e-3 * (1 + 0.03 * i)
                mean = np.array([f.mean for f in estimates])
                colour = VARIANT_COLOUR.get(design, _GREY)
                axes.plot(x, mean, "o-", color=colour, ms=5, label=design.replace("_", " "))
                over_seeds = np.array([f.speaks_of_seeds for f in estimates])
                axes.vlines(
                    x[over_seeds],
                    *(
                        np.array([getattr(f, end) for f in estimates])[over_seeds]
                        for end in ("low", "high")
                    ),
                    color=colour,
                    lw=1.4,
                )
            axes.set(xscale="log", xlabel="stiffness of the pad under a heel [kN/m]", title=title)
            means = [line.get_ydata() for line in axes.get_lines()]
            axes.set_ylim(
                0, 1.6 * float(np.nanmax([*np.concatenate(means), 1e-9]))
            )  # wider intervals are cut
            ticks = [stiffness[c] * 1e-3 for c in next(iter(band.values()))]
            axes.set_xticks(ticks, [f"{t:.3g}" for t in ticks])
            axes.minorticks_off()
        figure.legend(
            *row[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(band)
        )
    return figure


def operating_points_figure(trials: Mapping[str, Trial]) -> Figure:
    """Draw torque against speed of every motor of both legs, with its envelope and one colour for
    each design.

    Args:
        trials: one by design; the toe's motor is drawn where one has it.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    motors = max((motor_names(t.design) for t in trials.values()), key=len)
    columns = 4
    rows = -(-len(motors) // columns)
    with figure_style():
        figure, grid = plt.subplots(
            rows, columns, figsize=(3.0 * columns, 2.7 * rows), squeeze=False, layout="constrained"
        )
        for axes in grid.flat[len(motors) :]:
            axes.set_axis_off()
        for axes, motor in zip(grid.flat, motors, strict=False):
            first = True
            for key, trial in trials.items():
                names = motor_names(trial.design)
                if motor not in names:
                    continue
                index = names.index(motor)
                if first:
                    _envelope(axes, trial, index)
                    first = False
                speed, torque = (
                    values.reshape(-1, 2, len(names))[..., index].ravel()
                    for values in (trial.motor_velocity, trial.motor_torque)
                )
                every = max(1, len(speed) // _DOTS)
                axes.scatter(
                    speed[::every],
                    torque[::every],
                    s=3,
                    color=VARIANT_COLOUR.get(key, _GREY),
                    alpha=0.35,
                    lw=0,
                    zorder=3,
                    rasterized=True,
                )
            axes.set_title(motor.replace("_", " "))
        for axes in grid[:, 0]:
            axes.set_ylabel("motor torque [Nm]")
        for column in range(columns):
            grid[
                max(r for r in range(rows) if r * columns + column < len(motors)), column
            ].set_xlabel("motor speed [rad/s]")
        handles: list[Any] = [
            plt.Line2D(
                [],
                [],
                ls="",
                marker="o",
                color=VARIANT_COLOUR.get(k, _GREY),
                label=k.replace("_", " "),
            )
            for k in trials
        ]
        handles.append(plt.Line2D([], [], color="#1d2129", label="envelope"))
        if len(motors) < rows * columns:
            grid[-1, -1].legend(handles=handles, loc="center")
        else:
            figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def _envelope(axes: Axes, trial: Trial, index: int) -> None:
    envelope = motor_envelope(trial.design).select([index])
    free = float(envelope.no_load_speed[0])
    speed = np.linspace(-1.1 * free, 1.1 * free, 401)
    lower, upper = (limit[:, 0] for limit in torque_limits(envelope, speed[:, None]))
    axes.plot(speed, lower, color="#1d2129", lw=1.1)
    axes.plot(speed, upper, color="#1d2129", lw=1.1)
    peak = float(envelope.peak_torque[0])
    axes.set(xlim=(-1.1 * free, 1.1 * free), ylim=(-1.2 * peak, 1.2 * peak))
    axes.axhline(0, color=_GREY, lw=0.6)
    axes.axvline(0, color=_GREY, lw=0.6)
