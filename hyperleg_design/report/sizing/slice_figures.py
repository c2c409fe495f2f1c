"""Cuts of the torques that the joints below the hip can have together, in two and three
dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.sizing.envelope_figures import check_single
from hyperleg_design.report.style import GREY, INK, VARIANT_COLOUR, figure_style
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import ablate
from hyperleg_design.sizing import slices, zonotope
from hyperleg_design.sizing.analysis import BELOW_HIP
from hyperleg_design.sizing.envelope import motor_envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.robot.design import Design

KNEE, ANKLE_PITCH, ANKLE_ROLL, TOE = range(4)
"""Rows of the joints below the hip."""
_SPEED_SHADES = ("#6aaed6", "#2b7bba", "#08306b")
_LABEL = {KNEE: "knee", ANKLE_PITCH: "ankle pitch", ANKLE_ROLL: "ankle roll", TOE: "toe"}
PAIRS = ((KNEE, ANKLE_PITCH), (TOE, ANKLE_PITCH), (ANKLE_ROLL, ANKLE_PITCH))
"""Joints of the 2-D cuts, horizontal and vertical."""


def _motion(pitch_speed: float) -> str:
    return f"ankle pitching at {pitch_speed:g} rad/s" if pitch_speed else "at rest"


def _below_hip(
    design: Design, posture: str | None, pitch_speed: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Matrix and limits of the motors below the hip, with the ankle pitching at a speed and all
    else at rest.
    """
    matrix = transmission.joint_from_motor(design, posture)[BELOW_HIP, BELOW_HIP]
    velocity = np.zeros(len(matrix))
    velocity[ANKLE_PITCH] = pitch_speed
    return matrix, *zonotope.speed_dependent(
        motor_envelope(design).select(BELOW_HIP), matrix, velocity
    )


def slice_figure(
    design: Design,
    variants: Sequence[str] = ("toe", "toe_removed"),
    pitch_speeds: Sequence[float] = (0.0, 7.0, 10.0),
    posture: str | None = None,
) -> Figure:
    """Draw what two joints below the hip can have together against the box of their maxima, with
    one row for each variant.

    Filled areas: the other joints below the hip have zero torque, at each ankle-pitch speed. Dotted
    lines: the others are free. Dashed lines: the box of single-joint maxima. Dotted and dashed
    lines are at zero speed.

    Args:
        design: one robot; its ablations are drawn where it has an active toe, else itself alone.
        variants: ablations, of `VARIANTS`.
        pitch_speeds: up to three speeds of plantar flexion [rad/s], everything else at rest.
        posture: printed reductions; the design's own by default.

    Returns:
        The figure.

    Raises:
        InputError: a batch of designs, an unknown variant, more than three speeds.
    """
    check_single(design)
    if not 1 <= len(pitch_speeds) <= len(_SPEED_SHADES):
        raise InputError(
            "slice_figure",
            "pitch_speeds",
            list(pitch_speeds),
            f"expects one to {len(_SPEED_SHADES)} speeds [rad/s]",
        )
    robots = (
        {v: ablate(design, v) for v in variants}
        if design.variant == "toe"
        else {design.variant: design}
    )
    with figure_style():
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(
            len(robots),
            len(PAIRS),
            figsize=(11.5, 3.5 * len(robots) + 0.5),
            constrained_layout=True,
            squeeze=False,
            sharex="col",
            sharey=True,
        )
        for row, (name, robot) in zip(axes, robots.items(), strict=True):
            for axis, pair in zip(row, PAIRS, strict=True):
                _slice_panel(axis, robot, pair, pitch_speeds, posture)
            row[0].set_ylabel(f"{_LABEL[ANKLE_PITCH]} torque [Nm]")
            row[0].set_title(
                name.replace("_", " "), loc="left", color=VARIANT_COLOUR[name], fontweight="bold"
            )
        for axis, pair in zip(axes[-1], PAIRS, strict=True):
            axis.set_xlabel(f"{_LABEL[pair[0]]} torque [Nm]")
        _slice_legend(figure, pitch_speeds)
        return figure


def _slice_panel(
    axis: Axes, design: Design, pair: tuple[int, int], speeds: Sequence[float], posture: str | None
) -> None:
    from matplotlib.patches import Polygon, Rectangle

    matrix, lower, upper = _below_hip(design, posture, 0.0)
    if max(pair) >= len(matrix):
        axis.text(
            0.5,
            0.5,
            "no toe joint",
            transform=axis.transAxes,
            ha="center",
            va="center",
            color=GREY,
        )
        axis.grid(False)
        return
    low, high = zonotope.box(matrix, lower, upper)
    corner, size = low[list(pair)], (high - low)[list(pair)]
    axis.add_patch(
        Rectangle(
            (corner[0], corner[1]),
            size[0],
            size[1],
            fill=False,
            edgecolor=GREY,
            linestyle=(0, (5, 3)),
            linewidth=1.1,
        )
    )
    shadow = slices.projection_polygon(matrix, lower, upper, pair)
    axis.add_patch(Polygon(shadow, fill=False, edgecolor=INK, linestyle=":", linewidth=1.2))
    area = np.nan
    for speed, shade in zip(speeds, _SPEED_SHADES, strict=False):
        cut = slices.slice_polygon(*_below_hip(design, posture, speed), pair)
        if len(cut) > 2:
            axis.add_patch(Polygon(cut, facecolor=shade, alpha=0.28, linewidth=0))
            axis.add_patch(Polygon(cut, fill=False, edgecolor=shade, linewidth=1.5))
        if speed == 0:
            x, y = cut.T
            area = 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / float(size.prod())
    if np.isfinite(area):
        axis.set_title(f"at rest {100 * area:.0f} % of the box", loc="right", fontsize=8, color=INK)
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.axvline(0, color=GREY, linewidth=0.6)
    axis.autoscale_view()
    axis.margins(0.08)


def _slice_legend(figure: Figure, speeds: Sequence[float]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(
            facecolor=shade,
            alpha=0.5,
            edgecolor=shade,
            label=f"others at zero, ankle pitching at {speed:g} rad/s"
            if speed
            else "others at zero, at rest",
        )
        for speed, shade in zip(speeds, _SPEED_SHADES, strict=False)
    ]
    handles.append(Line2D([], [], color=INK, linestyle=":", label="others free, at rest"))
    handles.append(
        Line2D(
            [], [], color=GREY, linestyle=(0, (5, 3)), label="box of single-joint maxima, at rest"
        )
    )
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=9)


def polyhedron_figure(
    design: Design, pitch_speeds: Sequence[float] = (0.0, 10.0), posture: str | None = None
) -> Figure:
    """Draw what knee, ankle pitch and toe can have together with ankle roll at zero, in 3-D inside
    the box of their maxima.

    Ankle roll takes the toe's place where the toe does not move.

    Args:
        design: one robot.
        pitch_speeds: speeds of plantar flexion [rad/s], a panel each, everything else at rest.
        posture: printed reductions; the design's own by default.

    Returns:
        The figure.

    Raises:
        InputError: a batch of designs.
        InfeasibleError: at some speed no torque with zero roll is within reach.
    """
    check_single(design)
    joints = (
        (KNEE, TOE, ANKLE_PITCH)
        if design.toe.joint == "active"
        else (KNEE, ANKLE_ROLL, ANKLE_PITCH)
    )
    matrix, lower, upper = _below_hip(design, posture, 0.0)
    low, high = (limit[list(joints)] for limit in zonotope.box(matrix, lower, upper))
    bodies = [
        slices.slice_polyhedron(*_below_hip(design, posture, speed), joints)
        for speed in pitch_speeds
    ]
    with figure_style():
        import matplotlib.pyplot as plt
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

        figure = plt.figure(figsize=(5.2 * len(bodies), 4.5), constrained_layout=True)
        corners = np.array([[(low, high)[(i >> a) & 1][a] for a in range(3)] for i in range(8)])
        edges = [(i, i | 1 << a) for i in range(8) for a in range(3) if not i >> a & 1]
        for index, (speed, body) in enumerate(zip(pitch_speeds, bodies, strict=True)):
            axis: Any = figure.add_subplot(1, len(bodies), index + 1, projection="3d")
            axis.add_collection3d(
                Line3DCollection(
                    [corners[list(e)] for e in edges], colors=GREY, linewidths=0.9, linestyles="--"
                )
            )
            faces = [body.vertices[face] for face in body.faces]
            axis.add_collection3d(
                Poly3DCollection(
                    faces, facecolors=_shaded(faces), edgecolors=INK, linewidths=1.0, alpha=0.85
                )
            )
            axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
            for label, joint in zip(
                (axis.set_xlabel, axis.set_ylabel, axis.set_zlabel), joints, strict=True
            ):
                label(f"{_LABEL[joint]} [Nm]", labelpad=6)
            axis.view_init(elev=20, azim=-62)
            axis.set_box_aspect((1, 1, 0.9), zoom=0.92)
            axis.set_title(
                f"{_motion(speed)}: {100 * body.volume / float((high - low).prod()):.1f} % of the "
                f"box",
                y=0.97,
            )
        return figure


def _shaded(faces: list[np.ndarray]) -> list[Any]:
    """A blue for each face by how it stands to the light, so that edges are seen."""
    from matplotlib.colors import to_rgb

    light = np.array([-0.5, -0.7, 0.5]) / np.linalg.norm([-0.5, -0.7, 0.5])
    size = np.concatenate(faces)
    scale = np.ptp(size, axis=0)
    shades = []
    for face in faces:
        normal = np.cross((face[1] - face[0]) / scale, (face[2] - face[1]) / scale)
        bright = 0.5 + 0.5 * float(normal @ light) / max(float(np.linalg.norm(normal)), 1e-12)
        shades.append(
            tuple(np.array(to_rgb(_SPEED_SHADES[0])) * (0.45 + 0.55 * bright) + 0.12 * bright)
        )
    return [tuple(np.clip(s, 0, 1)) for s in shades]
