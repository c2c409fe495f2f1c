"""How reductions change with posture in the linkage model, and where the printed ones lie."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.report.style import figure_style
from hyperleg_design.robot import transmission
from hyperleg_design.robot.linkage import LinkageModel

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hyperleg_design.robot.design import Design


def linkage_figure(design: Design) -> Figure:
    """Draw ankle-pitch and toe reductions over ankle pitch and toe angle, with both printed
    postures marked.

    Args:
        design: one robot.

    Returns:
        The figure.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        model = LinkageModel.of(design)
        walking = model.walking_posture(design)
        figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.5), constrained_layout=True)
        pitch = np.linspace(
            design.joints.ankle_pitch.lower_deg, design.joints.ankle_pitch.upper_deg, 121
        )
        q = np.zeros((pitch.size, 7))
        q[:, 4] = np.deg2rad(pitch)
        axes[0].plot(
            pitch,
            model.joint_from_motor(q)[:, transmission.ANKLE_PITCH, transmission.M_ANKLE_LEFT],
            color="#8172b3",
        )
        axes[0].set(
            xlabel="ankle pitch [deg]",
            ylabel="ankle pitch over ankle motor [-]",
            title="ankle motors",
        )
        toe = np.linspace(design.joints.toe.lower_deg, design.joints.toe.upper_deg, 121)
        for row, axis, title in (
            (transmission.ANKLE_PITCH, axes[1], "toe motor on ankle pitch"),
            (transmission.TOE, axes[2], "toe motor on toe"),
        ):
            for angle, shade in ((-20, 0.35), (-10, 0.55), (0, 0.75), (20, 1.0)):
                q = np.zeros((toe.size, 7))
                q[:, 4], q[:, 6] = np.deg2rad(angle), np.deg2rad(toe)
                axis.plot(
                    toe,
                    model.joint_from_motor(q)[:, row, transmission.M_TOE],
                    color="#c8602a",
                    alpha=shade,
                    label=f"ankle {angle}°",
                )
            axis.set(xlabel="toe [deg]", ylabel="reduction [-]", title=title)
        axes[2].legend(fontsize=8)
        for axis, row, column, angle in (
            (axes[0], 4, 4, 4),
            (axes[1], 4, 6, 6),
            (axes[2], 6, 6, 6),
        ):
            for posture, place, mark in (("standing", np.zeros(7), "s"), ("walking", walking, "o")):
                value = transmission.joint_from_motor(design, posture)[row, column]
                axis.plot(np.rad2deg(place[angle]), value, mark, color="#1d2129", zorder=5)
                axis.annotate(
                    f" {posture} {value:.2f}",
                    (np.rad2deg(place[angle]), value),
                    xytext=(4, 6),
                    textcoords="offset points",
                    fontsize=8,
                )
        return figure
