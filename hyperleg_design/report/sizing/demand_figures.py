"""Pictures of what a motion demands: stick figures, angles and torques over the cycle, operating
points, margins.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import GREY, INK, VARIANT_COLOUR, VARIANT_LABEL, figure_style
from hyperleg_design.robot.names import SIDES
from hyperleg_design.robot.transmission import joint_names, motor_names
from hyperleg_design.sizing.contacts import sole_pads
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.sizing.demand import Demand

_STANCE = "#f1f3f5"


def cycle_figure(demands: Mapping[str, Demand], side: str = "left") -> Figure:
    """Draw angles and torques of one leg's joints over a motion, with one curve for each robot; the
    stance of the first is shaded.

    Args:
        demands: of the same motion, by label or variant.
        side: `left` or `right`.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    first = _first(demands)
    leg = SIDES.index(side)
    joints = max((joint_names(d.design) for d in demands.values()), key=len)
    shown = [j for j in joints if j != "hip_yaw"]
    with figure_style():
        figure, grid = plt.subplots(
            2,
            len(shown),
            figsize=(2.3 * len(shown), 5.0),
            sharex=True,
            squeeze=False,
            layout="constrained",
        )
        for key, demand in demands.items():
            names = joint_names(demand.design)
            share = 100 * np.arange(len(demand.motion.time)) / len(demand.motion.time)
            for column, joint in enumerate(shown):
                if joint not in names:
                    continue
                index = names.index(joint)
                style = _curve(key, demand)
                grid[0, column].plot(
                    share, np.rad2deg(demand.motion.joint_position[:, leg, index]), **style
                )
                grid[1, column].plot(share, demand.joint_torque[:, leg, index], **style)
        loaded = first.motion.contact[
            :, np.array([p.side == side for p in sole_pads(first.motion.model.tree)])
        ].any(1)
        for column, joint in enumerate(shown):
            grid[0, column].set_title(joint.replace("_", " "))
            grid[1, column].set_xlabel("cycle [%]" if first.motion.periodic else "time [%]")
            for axes in grid[:, column]:
                axes.margins(x=0)
                axes.axhline(0, color=GREY, lw=0.8, zorder=1)
                _shade(axes, np.asarray(loaded))
        grid[0, 0].set_ylabel("angle [deg]")
        grid[1, 0].set_ylabel("torque of the motors [Nm]")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
        title = (
            f"{first.motion.name.capitalize()}: {side} leg; shaded while that foot bears "
            f"load. "
            f"Flexion and plantar flexion are positive"
        )
        figure.suptitle(title, x=0.01, ha="left", fontsize=11)
    return figure


def operating_points_figure(demands: Mapping[str, Demand]) -> Figure:
    """Draw torque against speed at every motor of both legs over a motion, with the envelope of the
    first robot's motors.

    Args:
        demands: of the same motion, by label or variant; the toe's motor is drawn where one has it.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    first = _first(demands)
    motors = max((motor_names(d.design) for d in demands.values()), key=len)
    columns = min(4, len(motors))
    rows = -(-len(motors) // columns)
    with figure_style():
        figure, grid = plt.subplots(
            rows, columns, figsize=(2.9 * columns, 2.5 * rows), squeeze=False, layout="constrained"
        )
        for axes in grid.flat[len(motors) :]:
            axes.set_axis_off()
        for axes, motor in zip(grid.flat, motors, strict=False):
            owners = [d for d in demands.values() if motor in motor_names(d.design)]
            reach = max(
                float(np.abs(d.motor_velocity[..., motor_names(d.design).index(motor)]).max())
                for d in owners
            )
            _envelope(axes, owners[0], motor, reach)
            for key, demand in demands.items():
                names = motor_names(demand.design)
                if motor not in names:
                    continue
                m = names.index(motor)
                style = {
                    "s": 7,
                    "color": _curve(key, demand)["color"],
                    "alpha": 0.75,
                    "lw": 0,
                    "zorder": 3,
                }
                axes.scatter(
                    demand.motor_velocity[..., m].ravel(),
                    demand.motor_torque[..., m].ravel(),
                    **style,
                )
            axes.set_title(motor.replace("_", " "))
        for axes in grid[:, 0]:
            axes.set_ylabel("motor torque [Nm]")
        bottom = [
            grid[max(r for r in range(rows) if r * columns + c < len(motors)), c]
            for c in range(columns)
        ]
        for axes in bottom:
            axes.set_xlabel("motor speed [rad/s]")
        handles = [
            plt.Line2D(
                [], [], ls="", marker="o", color=_curve(k, d)["color"], label=_curve(k, d)["label"]
            )
            for k, d in demands.items()
        ]
        handles.append(plt.Line2D([], [], color=GREY, label="envelope"))
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
        figure.suptitle(
            f"{first.motion.name.capitalize()}: operating points of the motors of both legs",
            x=0.01,
            ha="left",
            fontsize=11,
        )
    return figure


def _envelope(axes: Axes, demand: Demand, motor: str, reach: float) -> None:
    envelope = motor_envelope(demand.design).select([motor_names(demand.design).index(motor)])
    edge = max(1.1 * reach, float(envelope.no_load_speed[0]) * 1.02)
    speed = np.linspace(-edge, edge, 401)
    lower, upper = torque_limits(envelope, speed[:, None])
    axes.fill_between(speed, lower[:, 0], upper[:, 0], color=_STANCE, zorder=0)
    axes.plot(speed, upper[:, 0], color=GREY, lw=1.2, zorder=2)
    axes.plot(speed, lower[:, 0], color=GREY, lw=1.2, zorder=2)
    axes.axhline(0, color=GREY, lw=0.6, zorder=1)
    axes.axvline(0, color=GREY, lw=0.6, zorder=1)


def margin_figure(demands: Mapping[str, Demand]) -> Figure:
    """Draw the smallest margin to the envelope, the thermal use and the Joule heat of every motor,
    with one bar for each robot.

    Args:
        demands: of the same motion, by label or variant.

    Returns:
        The figure.
    """
    import matplotlib.pyplot as plt

    first = _first(demands)
    motors = max((motor_names(d.design) for d in demands.values()), key=len)
    panels = (
        ("margin_over_peak", "smallest margin / peak torque [-]"),
        ("rms_over_rated", "rms / rated torque [-]"),
        ("joule", "Joule heat, both legs [W]"),
    )
    width = 0.8 / len(demands)
    with figure_style():
        figure, grid = plt.subplots(1, 3, figsize=(11.0, 3.4), layout="constrained")
        for axes, (field, label) in zip(grid, panels, strict=True):
            for number, (key, demand) in enumerate(demands.items()):
                rows = {row["motor"]: row[field] for row in demand.table()}
                at = [
                    i - 0.4 + width * (number + 0.5)
                    for i, motor in enumerate(motors)
                    if motor in rows
                ]
                style = _curve(key, demand)
                axes.bar(
                    at,
                    [rows[m] for m in motors if m in rows],
                    0.92 * width,
                    color=style["color"],
                    label=style["label"],
                )
            axes.set_xticks(range(len(motors)), [m.replace("_", "\n") for m in motors], fontsize=8)
            axes.set_title(label)
            axes.grid(False, axis="x")
        grid[0].axhline(0, color=INK, lw=1)
        grid[1].axhline(1, color=INK, lw=1, ls="--")
        handles, labels = grid[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
        figure.suptitle(
            f"{first.motion.name.capitalize()}: what is left at every motor",
            x=0.01,
            ha="left",
            fontsize=11,
        )
    return figure


def capability_figure(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Draw the largest contact force of one leg by posture.

    Args:
        rows: of `capability.capability_table`.

    Returns:
        The figure.

    Raises:
        InputError: no rows.
    """
    import matplotlib.pyplot as plt

    if not rows:
        raise InputError("capability figure", "rows", 0, "expects at least one")
    designs = list(dict.fromkeys(r["design"] for r in rows))
    postures = list(dict.fromkeys(r["posture"] for r in rows))
    directions = list(dict.fromkeys(r["direction"] for r in rows))
    width = 0.8 / len(designs)
    with figure_style():
        figure, grid = plt.subplots(
            1,
            len(directions),
            figsize=(4.6 * len(directions), 3.4),
            squeeze=False,
            layout="constrained",
        )
        for axes, direction in zip(grid[0], directions, strict=True):
            for number, design in enumerate(designs):
                by_posture = {
                    r["posture"]: r.get("body_weights")
                    for r in rows
                    if r["design"] == design and r["direction"] == direction
                }
                at = [
                    i - 0.4 + width * (number + 0.5)
                    for i, p in enumerate(postures)
                    if by_posture.get(p) is not None
                ]
                tall = [by_posture[p] for p in postures if by_posture.get(p) is not None]
                label = VARIANT_LABEL.get(design, design)
                bars = axes.bar(
                    at, tall, 0.92 * width, color=VARIANT_COLOUR.get(design), label=label
                )
                axes.bar_label(bars, fmt="%.3g", fontsize=7, padding=1)
            axes.set_xticks(range(len(postures)), [p.replace("_", " ") for p in postures])
            axes.set_title(f"largest {direction} force of one leg")
            axes.set_ylabel("body weights [-]")
            axes.grid(False, axis="x")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _first(demands: Mapping[str, Demand]) -> Demand:
    if not demands:
        raise InputError("demand figure", "demands", 0, "expects at least one")
    first_demands = list(demands.values())
    if len({d.motion.name for d in first_demands}) > 1:
        raise InputError(
            "demand figure",
            "demands",
            [d.motion.name for d in first_demands],
            "must be of one motion",
        )
    return first_demands[0]


def _curve(key: str, demand: Demand) -> dict[str, Any]:
    variant = key if key in VARIANT_COLOUR else demand.design.variant
    return {
        "color": VARIANT_COLOUR.get(variant, INK),
        "lw": 1.6,
        "label": VARIANT_LABEL.get(key, key),
    }


def _shade(axes: Axes, loaded: np.ndarray) -> None:
    count = len(loaded)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], loaded, [False]]).astype(int)))
    for begin, end in edges.reshape(-1, 2):
        axes.axvspan(
            100 * begin / count, 100 * min(end, count) / count, color=_STANCE, zorder=0, lw=0
        )
