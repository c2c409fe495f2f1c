"""Torque-speed envelopes of the shared ankle motors in the style of the paper's Fig. 4."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import GREY, INK, figure_style
from hyperleg_design.robot import transmission
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope, torque_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hyperleg_design.robot.design import Design

MOTORING, REGENERATIVE = "#c23b22", "#1f6fb4"
"""Red and blue of the paper's Fig. 4, told apart by colour-blind readers too."""


def check_single(design: Design) -> None:
    """Check that a figure of a design shows one robot.

    Args:
        design: what is drawn.

    Raises:
        InputError: it is a batch of designs.
    """
    if design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; take one of them")


def torque_speed_figure(
    design: Design,
    torque: np.ndarray | None = None,
    velocity: np.ndarray | None = None,
    posture: str | None = None,
) -> Figure:
    """Draw the envelopes of both ankle motors, and of what the two give to ankle pitch (L+R) and
    roll (L-R), as in the paper's Fig. 4.

    In the lower panels torque and speed are those of the pair's sum and difference: pitch torque M
    (t_L + t_R) against (w_L + w_R) / 2M, which is the speed of ankle pitch with the knee at rest,
    and likewise for roll. Their product is the power that the pair gives in that way, so the
    colours mean the same in all panels.

    Args:
        design: one robot.
        torque: operating points of one leg, `(t, joints)` [Nm].
        velocity: of the same points, `(t, joints)` [rad/s].
        posture: printed reductions to project with; the design's own by default.

    Returns:
        The figure.

    Raises:
        InputError: a batch of designs, or points whose shapes do not fit.
    """
    check_single(design)
    matrix = transmission.joint_from_motor(design, posture)
    envelope = motor_envelope(design)
    pair = [transmission.M_ANKLE_LEFT, transmission.M_ANKLE_RIGHT]
    rated = motor_arrays(design).rated_torque[pair[0]]
    points = _motor_points(design, matrix, torque, velocity)
    with figure_style():
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(2, 2, figsize=(9.2, 6.9), constrained_layout=True)
        single = envelope.select(pair[:1])
        for axis, motor, side in zip(axes[0], pair, ("left", "right"), strict=True):
            _envelope(axis, single, 1.0, 1.0, rated)
            _operating(axis, points, np.eye(matrix.shape[1])[motor], np.eye(matrix.shape[1])[motor])
            axis.set(
                title=f"{side} ankle motor",
                xlabel="motor speed [rad/s]",
                ylabel="motor torque [Nm]",
            )
        for axis, row, sign, title in (
            (axes[1, 0], transmission.ANKLE_PITCH, 1.0, "ankle pitch (L + R)"),
            (axes[1, 1], transmission.ANKLE_ROLL, -1.0, "ankle roll (L − R)"),
        ):
            ratio = abs(float(matrix[row, pair[0]]))
            _envelope(axis, single, 2 * ratio, 1 / ratio, rated)
            mixed = np.zeros(matrix.shape[1])
            mixed[pair] = 1.0, sign
            _operating(axis, points, mixed * ratio, mixed / (2 * ratio))
            axis.set(title=title, xlabel="joint speed [rad/s]", ylabel="torque of both motors [Nm]")
        _legend(figure, points is not None)
        return figure


def _motor_points(
    design: Design, matrix: np.ndarray, torque: np.ndarray | None, velocity: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray] | None:
    """Motor torques and speeds `(t, motors)` of joint-space points."""
    if torque is None and velocity is None:
        return None
    shapes = [None if values is None else np.shape(values) for values in (torque, velocity)]
    if (
        torque is None
        or velocity is None
        or shapes[0] != shapes[1]
        or np.ndim(torque) != 2
        or np.shape(torque)[1] != len(matrix)
    ):
        raise InputError(
            "torque_speed_figure",
            "torque, velocity",
            shapes,
            f"expects both, of shape (t, {len(matrix)})",
        )
    heat = motor_envelope(design).power_constant
    return transmission.motor_torque(
        matrix, np.asarray(torque, float), heat
    ), transmission.motor_velocity(matrix, np.asarray(velocity, float))


def _envelope(
    axis: Axes, single: MotorEnvelope, torque_scale: float, speed_scale: float, rated: float
) -> None:
    """Regions of one motor's envelope, with torque and speed stretched to the panel's."""
    free, peak = float(single.no_load_speed[0]), float(single.peak_torque[0])
    end = min(1.25 * free, float(single.top_speed[0]))
    corner, at_corner = float(single.corner_speed[0]), float(single.standstill_torque[0])
    speed = np.unique(
        np.concatenate([np.linspace(-end, end, 401), [-corner, corner, -free, 0, free]])
    )
    lower, upper = (limit[:, 0] * torque_scale for limit in torque_limits(single, speed[:, None]))
    x = speed * speed_scale
    for part in (speed >= 0, speed <= 0):
        driving = np.sign(speed[part].sum())
        above, below = np.maximum(upper[part], 0), np.minimum(upper[part], 0)
        under, over = np.minimum(lower[part], 0), np.maximum(lower[part], 0)
        red, blue = (
            ((over, above), (under, below)) if driving > 0 else ((under, below), (over, above))
        )
        axis.fill_between(x[part], *red, color=MOTORING, alpha=0.16, linewidth=0)
        axis.fill_between(x[part], *blue, color=REGENERATIVE, alpha=0.16, linewidth=0)
    for limit in (lower, upper):
        axis.plot(x, limit, color=INK, linewidth=1.3)
    axis.axhline(0, color=GREY, linewidth=0.7)
    axis.axvline(0, color=GREY, linewidth=0.7)
    for level in (-rated, rated):
        axis.plot(
            [-free * speed_scale, free * speed_scale],
            [level * torque_scale] * 2,
            color=GREY,
            linewidth=0.9,
            linestyle=(0, (5, 3)),
        )
    note: dict[str, Any] = {"fontsize": 8, "color": INK, "textcoords": "offset points"}
    axis.plot(
        [corner * speed_scale, free * speed_scale],
        [at_corner * torque_scale, 0],
        "o",
        color=INK,
        markersize=3.5,
        zorder=5,
    )
    axis.annotate(
        f"{corner * speed_scale:.3g} rad/s, {at_corner * torque_scale:.3g} Nm",
        (corner * speed_scale, at_corner * torque_scale),
        xytext=(4, 5),
        **note,
    )
    axis.annotate(f"{free * speed_scale:.3g} rad/s", (free * speed_scale, 0), xytext=(4, 4), **note)
    axis.set(
        xlim=(-1.1 * end * speed_scale, 1.1 * end * speed_scale),
        ylim=(-1.2 * peak * torque_scale, 1.2 * peak * torque_scale),
    )


def _operating(
    axis: Axes,
    points: tuple[np.ndarray, np.ndarray] | None,
    torque_weight: np.ndarray,
    speed_weight: np.ndarray,
) -> None:
    if points is None:
        return
    torque, speed = points[0] @ torque_weight, points[1] @ speed_weight
    driving = torque * speed >= 0
    for chosen, colour in ((driving, MOTORING), (~driving, REGENERATIVE)):
        axis.plot(
            speed[chosen],
            torque[chosen],
            ".",
            color=colour,
            markersize=3.5,
            markeredgewidth=0,
            zorder=4,
        )


def _legend(figure: Figure, points: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    def handle(colour: str, label: str) -> Any:
        return (
            Line2D([], [], marker="o", linestyle="", color=colour, label=label)
            if points
            else Patch(color=colour, alpha=0.25, label=label)
        )

    handles = [
        handle(MOTORING, "motoring, torque × speed ≥ 0"),
        handle(REGENERATIVE, "regenerative, torque × speed < 0"),
        Line2D([], [], color=INK, label="envelope"),
        Line2D([], [], color=GREY, linestyle=(0, (5, 3)), label="rated torque"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9)
