"""Figures of a diagnosis: where the gap lies on the robot, measured against predicted, how the gap
shrinks, and the rivals.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.gap.playback.evidence import Evidence, rms
from hyperleg_design.report.style import figure_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hyperleg_design.gap.model.subject import Subject

_INK, _PALE, _MEASURED, _EXPLAINED, _LEFT = "#1d2129", "#c9ced6", "#2f6db3", "#c8602a", "#6b7280"
AXIS = {"transmission": "speed [rad/s]", "base": "force, moment [N, Nm]", "ground": "force [N]"}
"""Of residuals that are none of torques."""
_LABELS = 5
"""Joints named in the drawing."""
_SPAN = 6.0
"""Longest stretch of a log drawn [s]."""


def robot_figure(subject: Subject, shares: Mapping[str, float]) -> Figure:
    """The robot at rest as a stick figure, its joints coloured by their share of the gap.

    Args:
        subject: the robot.
        shares: by joint or motor name; links and feet count for the joint that carries them.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        places, parents = joint_places(subject)
        across = _plane(places)
        flat = places @ across
        share = np.array([_share_of(subject, joint, shares) for joint in subject.joints])
        figure, panel = plt.subplots(figsize=(6.0, 4.4), layout="constrained")
        base = np.zeros(3) @ across
        for i, parent in enumerate(parents):
            start = base if parent < 0 else flat[parent]
            panel.plot(
                *zip(start, flat[i], strict=True),
                color=_PALE,
                linewidth=5,
                solid_capstyle="round",
                zorder=1,
            )
        panel.plot(*base, marker="s", markersize=13, color=_LEFT, zorder=2)
        size = 60 + 420 * share / max(share.max(initial=0.0), 1e-9)
        dots = panel.scatter(
            flat[:, 0],
            flat[:, 1],
            s=size,
            c=100 * share,
            cmap="YlOrRd",
            vmin=0,
            edgecolor=_INK,
            linewidth=0.8,
            zorder=3,
        )
        order = [i for i in np.argsort(-share)[:_LABELS] if share[i] >= 0.02]
        for rank, i in enumerate(order):
            side = 1 if flat[i, 0] >= flat[:, 0].mean() else -1
            text = f"{subject.joints[i]}  {100 * share[i]:.0f} %"
            offset = (
                26 * side,
                (26 + 9 * rank) * (1 if rank % 2 == 0 else -1),
            )  # up and down by turns, so that they do not meet
            arrow = {"arrowstyle": "-", "color": _LEFT, "linewidth": 0.8}
            panel.annotate(
                text,
                flat[i],
                xytext=offset,
                textcoords="offset points",
                ha="left" if side > 0 else "right",
                fontsize=9,
                arrowprops=arrow,
                zorder=4,
            )
        figure.colorbar(dots, ax=panel, label="share of the gap [%]", shrink=0.6)
        panel.set_aspect("equal", adjustable="datalim")
        panel.margins(0.45, 0.15)
        panel.set_axis_off()
        return figure


def joint_places(subject: Subject) -> tuple[np.ndarray, list[int]]:
    """Where the joints are at rest, in the base's frame `(n, 3)` [m], and the joint before each, -1
    for the base.
    """
    tree = subject.tree
    places, axes = np.zeros((tree.count, 3)), np.zeros((tree.count, 3, 3))
    for i in range(tree.count):
        parent = int(tree.parent[i])
        turned, origin = (np.eye(3), np.zeros(3)) if parent < 0 else (axes[parent], places[parent])
        places[i] = origin + turned @ tree.offset[i]
        axes[i] = turned @ tree.rotation[i]
        if tree.hinge[i]:
            angle = float(subject.default[i] - tree.reference[i])
            cosine, sine = np.cos(angle), np.sin(angle)
            axes[i] = axes[i] @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    return places, [int(p) for p in tree.parent]


def trace_figure(shown: Evidence, title: str = "") -> Figure:
    """Residual measured, explained and left, over time and, where the row has one, over speed, of
    the row where the gap is largest.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        row = shown.worst
        window = _window(shown, row)
        time, before, explained, after = (
            values[window]
            for values in (
                shown.time,
                shown.before[:, row],
                shown.explained[:, row],
                shown.after[:, row],
            )
        )
        speed = shown.speed[:, row]
        thin = np.flatnonzero(np.isfinite(speed) & np.isfinite(shown.before[:, row]))
        thin = thin[:: max(1, len(thin) // 3000)]
        panels = 2 if thin.size else 1
        figure, axes = plt.subplots(
            1,
            panels,
            figsize=(10.5, 3.4),
            width_ratios=(2.4, 1)[:panels],
            layout="constrained",
            squeeze=False,
        )
        left = axes[0, 0]
        left.plot(time, before, color=_MEASURED, label="gap measured")
        left.plot(time, explained, color=_EXPLAINED, label="causes predict")
        left.plot(time, after, color=_LEFT, linewidth=1, label="left")
        left.set_xlabel("time [s]")
        left.set_ylabel(AXIS.get(shown.residual_name, "torque [Nm]"))
        left.set_title(title or f"{shown.rows[row]}, {shown.log}")
        left.legend(ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.16))
        if thin.size:
            right = axes[0, 1]
            right.plot(speed[thin], shown.before[thin, row], ".", color=_MEASURED, markersize=2)
            right.plot(speed[thin], shown.explained[thin, row], ".", color=_EXPLAINED, markersize=2)
            right.set_xlabel("speed [rad/s]")
        return figure


def ringing_figure(
    motor: str, log: str, time: np.ndarray, need: np.ndarray, torque: np.ndarray
) -> Figure:
    """A motor that rings on its belt: torque that its joints take beside the one that it gives,
    some periods of it [s], [Nm].
    """
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(10.5, 3.0), layout="constrained")
        panel.plot(
            time, need, color=_MEASURED, marker=".", label="joints and rotor take, by their motion"
        )
        panel.plot(time, torque, color=_EXPLAINED, marker=".", label="the motor gives")
        panel.set_xlabel("time [s]")
        panel.set_ylabel("torque [Nm]")
        panel.set_title(f"{motor}, {log}")
        panel.legend(ncols=2, loc="upper center", bbox_to_anchor=(0.5, -0.2))
        return figure


def swinging_figure(
    joints: Sequence[str], log: str, time: np.ndarray, speed: np.ndarray, mode: np.ndarray
) -> Figure:
    """Joints that swing by themselves: speeds about that frequency, and what of them goes with a
    mode, `(t, n)` [rad/s] over [s].
    """
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(10.5, 3.2), layout="constrained")
        for joint, measured, predicted in zip(joints, speed.T, mode.T, strict=True):
            (line,) = panel.plot(time, measured, marker=".", label=joint)
            panel.plot(time, predicted, linestyle="--", color=line.get_color())
        panel.set_xlabel("time [s]")
        panel.set_ylabel("speed [rad/s]")
        panel.set_title(log)
        panel.legend(ncols=len(joints), loc="upper center", bbox_to_anchor=(0.5, -0.2))
        return figure


def knocking_figure(
    joints: Sequence[str], log: str, time: np.ndarray, left: np.ndarray, explained: np.ndarray
) -> Figure:
    """A joint that knocks about unseen: torques that the model lacks, beside those of a hidden
    motion, `(t, n)` [Nm] over [s].
    """
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panels = plt.subplots(
            1, len(joints), figsize=(10.5, 3.0), layout="constrained", squeeze=False
        )
        for panel, joint, measured, moved in zip(
            panels[0], joints, left.T, explained.T, strict=True
        ):
            panel.plot(time, measured, color=_MEASURED, marker=".", label="the model lacks")
            panel.plot(time, moved, color=_EXPLAINED, label="a motion that no encoder tells")
            panel.set_xlabel("time [s]")
            panel.set_ylabel("torque [Nm]")
            panel.set_title(f"{joint}, {log}")
        panels[0][0].legend(ncols=2, loc="upper left", bbox_to_anchor=(0.0, -0.2))
        return figure


def slipping_figure(
    foot: str, log: str, speed: np.ndarray, ratio: np.ndarray, nominal: float, coefficient: float
) -> Figure:
    """A foot that slides: tangential force over load [-] at the speeds against it [m/s] of its
    contacts, beside the nominal ground's.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(10.5, 3.2), layout="constrained")
        panel.plot(
            speed,
            ratio,
            linestyle="none",
            marker=".",
            markersize=3,
            alpha=0.4,
            color=_MEASURED,
            label="measured, each contact and tick",
        )
        panel.axhline(coefficient, color=_EXPLAINED, label=f"slides at {coefficient:.2f}")
        panel.axhline(
            nominal, color=_MEASURED, linestyle="--", label=f"the model's ground, {nominal:.2f}"
        )
        panel.set_xlabel("speed against the force [m/s]")
        panel.set_ylabel("tangential force over load")
        panel.set_ylim(0.0, 1.3 * max(nominal, coefficient))
        panel.set_title(f"{foot}, {log}")
        panel.legend(ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.2))
        return figure


def sinking_figure(
    foot: str, log: str, load: np.ndarray, height: np.ndarray, nominal: np.ndarray, ratio: float
) -> Figure:
    """A foot that sinks: heights of its pads over their loads [N], each about its mean [m], beside
    the nominal ground's.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        figure, panel = plt.subplots(figsize=(10.5, 3.2), layout="constrained")
        panel.plot(
            load,
            1e3 * height,
            linestyle="none",
            marker=".",
            markersize=3,
            alpha=0.3,
            color=_MEASURED,
            label="measured, each pad and tick",
        )
        ends = np.array([float(load.min()), float(load.max())])
        slope = float(load @ nominal / (load @ load))
        panel.plot(
            ends,
            1e3 * ratio * slope * ends,
            color=_EXPLAINED,
            label=f"gives {ratio:.2g} times as much",
        )
        panel.plot(
            ends, 1e3 * slope * ends, color=_MEASURED, linestyle="--", label="the model's ground"
        )
        panel.set_xlabel("load about its mean [N]")
        panel.set_ylabel("height about its mean [mm]")
        panel.set_title(f"{foot}, {log}")
        panel.legend(ncols=3, loc="upper center", bbox_to_anchor=(0.5, -0.2))
        return figure


def rows_figure(shown: Sequence[Evidence]) -> Figure:
    """Size of the residual of every row before and after."""
    with figure_style():
        import matplotlib.pyplot as plt

        names = shown[0].rows
        before, after = (
            rms(np.concatenate(part))
            for part in ([s.before for s in shown], [s.after for s in shown])
        )
        figure, panel = plt.subplots(
            figsize=(max(5.0, 0.55 * len(names) + 1.5), 3.2), layout="constrained"
        )
        place = np.arange(len(names))
        panel.bar(place - 0.2, before, 0.38, color=_MEASURED, label="before")
        panel.bar(place + 0.2, after, 0.38, color=_EXPLAINED, label="after")
        panel.set_xticks(place, names, rotation=40, ha="right")
        panel.set_ylabel("RMS " + AXIS.get(shown[0].residual_name, "torque [Nm]"))
        panel.legend()
        return figure


def waterfall_figure(gap: Mapping[str, Any], causes: Sequence[Mapping[str, Any]]) -> Figure:
    """The gap before, what each cause takes off it, what is left, and the floor."""
    with figure_style():
        import matplotlib.pyplot as plt

        before, after, floor = (float(gap[key]) for key in ("before", "after", "floor"))
        parts = np.array([max(float(c["closed"]), 0.0) for c in causes])
        taken = (before - after) * (parts / parts.sum() if parts.sum() > 0 else parts)
        figure, panel = plt.subplots(
            figsize=(max(4.6, 1.5 * (2 + len(causes)) + 1.0), 3.4), layout="constrained"
        )
        panel.bar(0, before, color=_MEASURED)
        level = before
        for i, size in enumerate(taken, 1):
            panel.bar(i, -size, bottom=level, color=_EXPLAINED)
            panel.plot([i - 1.4, i + 0.4], [level, level], color=_INK, linewidth=0.7)
            level -= size
        panel.bar(len(causes) + 1, after, color=_LEFT)
        panel.axhline(floor, color=_INK, linestyle="--", linewidth=1)
        panel.annotate(
            "floor",
            (1, floor),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            fontsize=9,
        )
        labels = [
            "before",
            *(
                f"{c['effect']}\n{textwrap.shorten(str(c['location']), 22, placeholder='…')}"
                for c in causes
            ),
            "after",
        ]
        panel.set_xticks(
            range(len(labels)),
            [
                text.replace("_", " ", 1) if i in (0, len(labels) - 1) else text
                for i, text in enumerate(labels)
            ],
            fontsize=9,
        )
        panel.set_ylabel(f"gap on held-out data [{gap['unit']}]")
        return figure


def rivals_figure(
    causes: Sequence[Mapping[str, Any]], rivals: Sequence[Mapping[str, Any]]
) -> Figure:
    """Named causes and their rivals: how much of the excess gap each closes on held-out data, and
    how probable it is.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        rows = [*causes, *rivals][:12]
        figure, panel = plt.subplots(figsize=(7.4, 0.42 * len(rows) + 1.2), layout="constrained")
        place = np.arange(len(rows))[::-1]
        colours = [_EXPLAINED] * len(causes) + [_PALE] * len(rivals)
        panel.barh(place, [100 * float(r["closed"]) for r in rows], color=colours[: len(rows)])
        for y, row in zip(place, rows, strict=True):
            panel.annotate(
                f"p {float(row['probability']):.2f}",
                (1.01, y),
                xycoords=("axes fraction", "data"),
                va="center",
                fontsize=9,
            )
        panel.set_yticks(place, [f"{r['effect']} at {r['location']}" for r in rows])
        panel.set_xlabel("excess gap closed on held-out data [%]")
        panel.axvline(0, color=_INK, linewidth=0.8)
        return figure


def _share_of(subject: Subject, joint: str, shares: Mapping[str, float]) -> float:
    found = float(shares.get(joint, 0.0))
    if not subject.one_to_one:
        row = np.abs(subject.joint_from_motor[subject.joints.index(joint)])
        whole = np.abs(subject.joint_from_motor).sum(0)
        parts = row / np.maximum(whole, 1e-12)
        found += sum(
            float(shares.get(m, 0.0)) * part
            for m, part in zip(subject.motors, parts, strict=True)
            if m not in subject.joints
        )
    tree = subject.tree
    carried = [
        link
        for link, place in zip(tree.links, tree.link_joint, strict=True)
        if place >= 0 and tree.joints[int(place)] == joint
    ]
    return found + sum(
        float(shares.get(link, 0.0)) for link in carried if link not in subject.joints
    )


def _plane(places: np.ndarray) -> np.ndarray:
    """Two directions that show most of a robot, the vertical kept upright, `(3, 2)`."""
    spread = places[:, :2] - places[:, :2].mean(0)
    _, _, axes = np.linalg.svd(spread, full_matrices=True)
    sideways = axes[0] if np.abs(spread).max(initial=0.0) > 1e-6 else np.array([1.0, 0.0])
    view = np.zeros((3, 2))
    view[:2, 0], view[2, 1] = sideways, 1.0
    view[:2, 1] = 0.25 * np.array(
        [-sideways[1], sideways[0]]
    )  # a little from above, so that joints in a line do not hide
    return view


def _window(shown: Evidence, row: int) -> slice:
    """The stretch of a log in which the row's residual is largest."""
    length = min(
        len(shown.time), max(2, round(_SPAN / max(float(np.median(np.diff(shown.time))), 1e-9)))
    )
    power = np.concatenate([[0.0], np.cumsum(np.nan_to_num(shown.before[:, row]) ** 2)])
    start = int(np.argmax(power[length:] - power[:-length]))
    return slice(start, start + length)
