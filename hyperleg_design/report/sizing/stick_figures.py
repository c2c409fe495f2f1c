"""Stick figures of a motion, with the force of the floor on each foot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import GREY, INK, LEG_COLOUR, VARIANT_LABEL, figure_style
from hyperleg_design.robot.names import SIDES
from hyperleg_design.sizing.contacts import contact_kinematics, sole_pads

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.sizing.demand import Demand
    from hyperleg_design.sizing.motions.motion import Motion

_NEWTONS_PER_METRE = 1100.0
"""Scale of drawn forces."""


def stick_figure_strip(demand: Demand, frames: int = 9, spacing: float | None = None) -> Figure:
    """Draw snapshots of a motion from its right side, with the floor's force on each foot.

    Args:
        demand: of any motion.
        frames: how many, evenly spaced over the motion.
        spacing: between snapshots beyond what the robot travels [m]; chosen so that they do not
            overlap by default.

    Returns:
        The figure.

    Raises:
        InputError: fewer than two frames.
    """
    import matplotlib.pyplot as plt

    motion = demand.motion
    if frames < 2:
        raise InputError("strip", "frames", frames, "expects at least 2")
    last = len(motion.time) if motion.periodic else len(motion.time) - 1
    picked = np.round(np.linspace(0, last, frames, endpoint=not motion.periodic)).astype(int)
    gap = 0.66 - motion.distance / frames if spacing is None else spacing
    with figure_style():
        figure, axes = plt.subplots(figsize=(11.0, 2.7), layout="constrained")
        axes.grid(False)
        for place, n in enumerate(picked):
            _stick_figure(axes, demand, int(n), place * max(gap, 0.0))
        _floor(axes, motion, picked, max(gap, 0.0))
        for place, n in enumerate(picked):
            share = f"{100 * n / last:.0f} %"
            axes.text(
                motion.q[n, 0] + place * max(gap, 0.0),
                -0.10,
                share,
                ha="center",
                va="top",
                fontsize=9,
                color=GREY,
            )
        for side in SIDES:
            axes.plot([], [], color=LEG_COLOUR[side], lw=3, label=f"{side} leg")
        axes.plot([], [], color=INK, lw=1.2, label="force of the floor")
        figure.legend(loc="outside lower center", ncols=3)
        axes.set_aspect("equal")
        axes.set_axis_off()
        name = VARIANT_LABEL.get(demand.design.variant, demand.design.variant)
        pace = (
            f", {motion.distance / motion.duration:.2f} m/s"
            if motion.distance > 0 and motion.periodic
            else ""
        )
        axes.set_title(
            f"{motion.name.capitalize()} ({name}{pace}): a planned motion, not a measured one",
            loc="left",
        )
    return figure


def _stick_figure(axes: Axes, demand: Demand, sample: int, shift: float) -> None:
    motion, design = demand.motion, demand.design
    model, q = motion.model, motion.q[sample]
    place = np.array([shift, 0.0])

    def at(link: str) -> np.ndarray:
        return model.frame_position(q, link)[[0, 2]] + place

    points, _ = contact_kinematics(model, q)
    pads = sole_pads(model.tree)
    for side in ("left", "right"):  # the right leg is nearer
        colour, front = LEG_COLOUR[side], 3 if side == "right" else 2
        joints = np.array([at(f"{side}_{link}") for link in ("thigh", "shank", "foot")])
        rows = {
            row: np.mean(
                [points[i, [0, 2]] for i, p in enumerate(pads) if p.side == side and p.row == row],
                0,
            )
            + place
            for row in ("heel", "ball", "tip")
        }
        style: dict[str, Any] = {
            "color": colour,
            "solid_capstyle": "round",
            "solid_joinstyle": "round",
            "zorder": front,
        }
        axes.plot(*joints.T, lw=4, **style)
        axes.plot(*np.array([joints[2], rows["heel"], rows["ball"], joints[2]]).T, lw=2.2, **style)
        axes.plot(*np.array([rows["ball"], rows["tip"]]).T, lw=2.6, **style)
        axes.plot(*joints.T, "o", color="white", ms=2.5, zorder=front + 0.5)
        mine = np.array([p.side == side for p in pads])
        force = demand.allocation.contact_force[sample][mine]
        if force[:, 2].sum() > 5.0:
            center = (points[mine] * force[:, 2:]).sum(0)[[0, 2]] / force[:, 2].sum() + place
            tip = center + force.sum(0)[[0, 2]] / _NEWTONS_PER_METRE
            arrow = {
                "arrowstyle": "-|>",
                "color": INK,
                "lw": 1.2,
                "shrinkA": 0,
                "shrinkB": 0,
                "mutation_scale": 8,
            }
            axes.annotate("", tip, center, arrowprops=arrow, zorder=5)
    pelvis = design.pelvis
    box = np.array([[-1, 0], [1, 0], [1, 2], [-1, 2], [-1, 0]]) * [
        pelvis.depth / 2,
        pelvis.height / 2,
    ]
    pitch = 2 * np.arctan2(q[4], q[6])
    turned = box @ np.array([[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]])
    axes.fill(*(turned + q[[0, 2]] + place).T, facecolor="#e5e7eb", edgecolor=GREY, lw=1, zorder=1)


def _floor(axes: Axes, motion: Motion, picked: np.ndarray, gap: float) -> None:
    heights = sorted({round(float(f.position[0, n, 2]), 6) for f in motion.feet for n in (0, -1)})
    if motion.name == "stair" and len(heights) > 1:
        for place, n in enumerate(picked):
            edge = motion.feet[0].position[0, -1, 0] - 0.09 + place * gap
            middle = motion.q[n, 0] + place * gap
            axes.plot(
                [middle - 0.3, edge, edge, edge + 0.3],
                [0, 0, heights[-1] - heights[0], heights[-1] - heights[0]],
                color=GREY,
                lw=1,
                zorder=0,
            )
        return
    low, high = (
        motion.q[picked[0], 0] - 0.35,
        motion.q[picked[-1], 0] + gap * (len(picked) - 1) + 0.35,
    )
    axes.plot([low, high], [0, 0], color=GREY, lw=1, zorder=0)
