"""Plotly charts of the page: motor envelopes with operating points, and slices of the torques that
two joints can have together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.parameters.described import prefixed
from hyperleg_design.sizing import slices
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits

if TYPE_CHECKING:
    import plotly.graph_objects as go

    from hyperleg_design.report.viewer.walk import RecordedWalk
    from hyperleg_design.robot.parameters.described import RobotDesign

COLOURS = ("#c8602a", "#2f6db3")
"""Colours of the first and the second design, which colour-blind readers can tell apart, too."""
BUTTONS = (
    "toimage",
    "senddatatocloud",
    "zoom",
    "pan",
    "zoomin",
    "zoomout",
    "autoscale",
    "resetscale",
)
"""Plotly's buttons, which would cover a chart of this size; a drag zooms in, two clicks out."""
_MOST_POINTS = 600
"""Operating points drawn of each motor; more would only thicken the cloud."""
_SIDE_MARKS = ("circle", "diamond", "square", "cross")


def joint_pairs(design: RobotDesign) -> list[tuple[str, str]]:
    """List the pairs of joints of one limb that share motors, or all pairs where none do.

    Args:
        design: one robot.

    Returns:
        Names of the joints.
    """
    joints = transmission.joint_names(design)
    driven = np.abs(transmission.joint_from_motor(design)) > 1e-9
    shared = [
        (joints[i], joints[j])
        for i, j in combinations(range(len(joints)), 2)
        if (driven[i] & driven[j]).any()
    ]
    return shared or list(combinations(joints, 2))


def motor_chart(
    designs: Mapping[str, RobotDesign],
    motor: str,
    walk: RecordedWalk | None = None,
    row: int | None = None,
    *,
    dark: bool = False,
) -> go.Figure:
    """Draw torque over speed of one motor: each design's envelope, and where a recorded walk used
    it.

    Args:
        designs: by label.
        motor: name in one limb, such as knee.
        walk: whose operating points are drawn.
        row: tick of the walk to mark.
        dark: for a dark page.

    Returns:
        The chart.
    """
    import plotly.graph_objects as go

    figure = go.Figure(layout=_layout(dark, "motor speed [rad/s]", "motor torque [Nm]"))
    for colour, (label, design) in zip(COLOURS, designs.items(), strict=False):
        names = transmission.motor_names(design)
        if motor not in names:
            continue
        own = motor_envelope(design).select([names.index(motor)])
        end = min(1.25 * float(own.no_load_speed[0]), float(own.top_speed[0]))
        speed = np.linspace(-end, end, 121)
        lower, upper = (limit[:, 0] for limit in torque_limits(own, speed[:, None]))
        figure.add_scatter(
            x=np.concatenate([speed, speed[::-1], speed[:1]]).round(3),
            y=np.concatenate([upper, lower[::-1], upper[:1]]).round(3),
            mode="lines",
            fill="toself",
            opacity=0.8,
            line={"color": colour, "width": 2},
            name=f"envelope, {label}",
            hoverinfo="skip",
        )
    if walk is not None:
        for mark, copy in zip(_SIDE_MARKS, walk.design.copies, strict=False):
            _points(figure, walk, prefixed(copy, motor), row, mark, dark)
    return figure


def _points(
    figure: go.Figure, walk: RecordedWalk, motor: str, row: int | None, mark: str, dark: bool
) -> None:
    speed, torque = walk.motor_points(motor)
    known = np.flatnonzero(np.isfinite(speed) & np.isfinite(torque))
    if not known.size:
        return
    shown = known[:: -(-known.size // _MOST_POINTS)]
    figure.add_scatter(
        x=speed[shown].round(3),
        y=torque[shown].round(3),
        mode="markers",
        marker={"size": 4, "symbol": mark, "opacity": 0.55},
        name=motor.replace("_", " "),
    )
    if row is not None and row in known:
        figure.add_scatter(
            x=[float(speed[row])],
            y=[float(torque[row])],
            mode="markers",
            marker={
                "size": 13,
                "symbol": mark,
                "color": "#ffffff" if dark else "#1d2129",
                "line": {"width": 2, "color": "#c23b22"},
            },
            name=f"{motor.replace('_', ' ')} now",
            showlegend=False,
        )


def slice_chart(
    designs: Mapping[str, RobotDesign], pair: tuple[str, str], *, dark: bool = False
) -> go.Figure:
    """Draw the torques that two joints can have together at standstill: with the other joints at
    zero (filled), and with any torque at the others (dotted).

    Args:
        designs: by label.
        pair: names of two joints of one limb.
        dark: for a dark page.

    Returns:
        The chart.
    """
    import plotly.graph_objects as go

    figure = go.Figure(
        layout=_layout(dark, *(f"{name.replace('_', ' ')} torque [Nm]" for name in pair))
    )
    for colour, (label, design) in zip(COLOURS, designs.items(), strict=False):
        joints = transmission.joint_names(design)
        if not set(pair) <= set(joints):
            continue
        rows = joints.index(pair[0]), joints.index(pair[1])
        matrix = transmission.joint_from_motor(design)
        limit = motor_envelope(design).standstill_torque
        for name, corners, look in (
            ("others at zero", slices.slice_polygon(matrix, -limit, limit, rows), "solid"),
            ("others free", slices.projection_polygon(matrix, -limit, limit, rows), "dot"),
        ):
            closed = np.concatenate([corners, corners[:1]]).round(3)
            figure.add_scatter(
                x=closed[:, 0],
                y=closed[:, 1],
                mode="lines",
                line={"color": colour, "width": 2, "dash": look},
                fill="toself" if look == "solid" else None,
                name=f"{label}, {name}",
            )
    return figure


def _layout(dark: bool, x: str, y: str) -> dict[str, Any]:
    return {
        "template": "plotly_dark" if dark else "plotly_white",
        "xaxis": {"title": {"text": x}},
        "yaxis": {"title": {"text": y}},
        "margin": {"l": 55, "r": 8, "t": 8, "b": 40},
        "modebar": {"remove": BUTTONS},
        "legend": {"orientation": "h", "y": -0.28, "font": {"size": 10}},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "font": {"size": 11},
    }


def motors_of(designs: Sequence[RobotDesign]) -> tuple[str, ...]:
    """List the motors of one limb that any of the designs has.

    Args:
        designs: robots.

    Returns:
        Their names.
    """
    return tuple(dict.fromkeys(n for d in designs for n in transmission.motor_names(d)))
