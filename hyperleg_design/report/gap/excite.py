"""Text and figures of recommended experiments: the motions, what each shows, and which look-alikes
each tells apart.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS, LOOK_ALIKES
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.designed_experiment import (
    CLEAR,
    Experiment,
    hidden,
    inseparable,
)
from hyperleg_design.gap.experiments.pair import apart
from hyperleg_design.gap.model.joint_units import slides, unit_at
from hyperleg_design.report.style import figure_style, save
from hyperleg_design.writing import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

MOST_DRAWN = 7
"""Joints drawn of a robot with more: one leg's."""
MOST_NAMED = 8


def plan_text(experiment: Experiment) -> str:
    """Describe an experiment in text for a terminal.

    Args:
        experiment: the plan.

    Returns:
        The text.
    """
    subject, blocks = experiment.subject, experiment.blocks
    measured = "motor torque measured" if experiment.torque else "no torque measured"
    lines = [
        f"Experiments for {subject.name} on a rig, base fixed, targets at {experiment.rate:g} Hz",
        f"Noise: {100 * experiment.noise:g} % of each joint's strength, correlated over "
        f"{1000 * info.NOISE_TIME:g} ms; {measured}.",
        f"A number is how many standard deviations an effect of usual size stands out; {CLEAR:g} "
        f"are clear.",
        "",
        f"{'motion':<10} {'length':>7} {'size':>5} {'torque':>7} {'heat':>5}  nearest limit        "
        f"purpose",
    ]
    for m in experiment.motions:
        mark = "*" if m.name in experiment.chosen else " "
        use = m.use
        torque, heat = f"{100 * use.envelope:>5.0f} %", f"{100 * use.continuous:>3.0f} %"
        lines.append(
            f"{m.name:<9}{mark} {m.duration:>5.1f} s {m.scale:>5.2f} {torque} {heat}  "
            f"{use.worst:<20} {m.purpose}"
        )
    lines += [f"{motion.name:<10} left out: {motion.why}" for motion in experiment.left_out]
    total = sum(experiment.motion(n).duration for n in experiment.chosen)
    lines += [
        "",
        f"* Shortest set that tells what all can: {', '.join(experiment.chosen)}; {total:.0f} s.",
        "",
    ]
    names = [m.name for m in experiment.motions]
    head = " ".join(f"{n:>9}" for n in [*names, "set", "all"])
    lines.append(f"{'least clear place of each effect':<46} {head}")
    grams = [
        *(experiment.grams[n] for n in names),
        experiment.gram(experiment.chosen),
        experiment.gram(),
    ]
    for effect in dict.fromkeys(place[0] for place in blocks.places):
        places = [place for place in blocks.places if place[0] == effect]
        cells = [min(info.strength(gram, blocks, place) for place in places) for gram in grams]
        lines.append(f"{effect:<46} {' '.join(f'{_short(c):>9}' for c in cells)}")
    lines += ["", f"{'least clear place of look-alikes that show':<46} {head}"]
    for first, second, values in _pair_rows(experiment, grams):
        lines.append(f"{first + ' / ' + second:<46} {' '.join(f'{_short(v):>9}' for v in values)}")
    lines += [
        "",
        "Standard deviation of each parameter by the shortest set, worst place and best place:",
    ]
    lines += _deviation_lines(experiment)
    left = inseparable(experiment)
    if left:
        lines += ["", "Not told apart by all motions together, though each shows:"]
        for first, second, by in LOOK_ALIKES:
            joints = [p.joint for p in left if (p.first[0], p.second[0]) == (first, second)]
            if joints:
                lines.append(f"  {first} / {second}, which {by} would separate: {_few(joints)}")
    unseen = hidden(experiment)
    if unseen:
        grouped: dict[str, list[str]] = {}
        for effect, location in unseen:
            grouped.setdefault(effect, []).append(location)
        lines += [
            "",
            "Not shown at its usual size by any motion:",
            *(f"  {e}: {_few(where)}" for e, where in grouped.items()),
        ]
    return "\n".join([*lines, "", *experiment.notes]) + "\n"


def _few(names: list[str]) -> str:
    """Names, not too many of them."""
    return (
        ", ".join(names)
        if len(names) <= MOST_NAMED
        else f"{', '.join(names[:MOST_NAMED])} and {len(names) - MOST_NAMED} more"
    )


def _short(value: float) -> str:
    return "-" if value < 0.05 else f"{value:.1f}" if value < 99.5 else f"{value:.0f}"


def _pair_rows(
    experiment: Experiment, grams: list[np.ndarray]
) -> list[tuple[str, str, list[float]]]:
    """How far each kind of pair is told apart, at the worst of the joints at which both show by all
    motions together.
    """
    whole, blocks = experiment.gram(), experiment.blocks
    rows = []
    for first, second, _ in LOOK_ALIKES:
        pairs = [p for p in experiment.pairs if (p.first[0], p.second[0]) == (first, second)]
        pairs = [
            p
            for p in pairs
            if min(info.strength(whole, blocks, place) for place in (p.first, p.second)) >= CLEAR
        ]
        if pairs:
            rows.append(
                (first, second, [min(apart(gram, blocks, p) for p in pairs) for gram in grams])
            )
    return rows


def _deviation_lines(experiment: Experiment) -> list[str]:
    blocks, gram = experiment.blocks, experiment.gram(experiment.chosen)
    lines = []
    for effect in dict.fromkeys(place[0] for place in blocks.places):
        subject, kind = experiment.subject, EFFECTS[effect].kind
        units = {p.name: p.unit for p in EFFECTS[effect].parameters}
        deviations = {
            place[1]: info.standard_deviations(gram, blocks, place, subject)
            for place in blocks.places
            if place[0] == effect
        }
        parts = []
        for name in next(iter(deviations.values())):
            shown: dict[str, list[float]] = {}
            for location, sizes in deviations.items():
                if np.isfinite(sizes[name]):
                    unit = unit_at(subject, kind, location, units[name])
                    shown.setdefault(unit, []).append(sizes[name])
            ranges = ", ".join(
                f"{max(values):.2g} .. {min(values):.2g} {unit}".rstrip()
                for unit, values in shown.items()
            )
            parts.append(f"{name} {ranges or 'not shown'}")
        lines.append(f"  {effect:<26} {'; '.join(parts)}")
    return lines


def motions_figure(experiment: Experiment) -> Figure:
    """Draw the targets of all motions over time, with a panel for each motion: of joints that turn
    in degrees, of joints that slide in metres, dashed and on an axis of their own beside others.

    Args:
        experiment: the plan.

    Returns:
        The figure.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        joints = list(experiment.subject.joints)[:MOST_DRAWN]
        motions = experiment.motions
        columns = 2
        rows = -(-len(motions) // columns)
        figure, panels = plt.subplots(
            rows, columns, figsize=(11, 2.1 * rows + 0.6), squeeze=False, layout="constrained"
        )
        colours = plt.get_cmap("viridis")(np.linspace(0, 0.92, len(joints)))
        sliding = [slides(experiment.subject, "joint", joint) for joint in joints]
        mixed = any(sliding) and not all(sliding)
        lines: list[Line2D] = []
        for panel, motion in zip(panels.flat, motions, strict=False):
            beside = panel.twinx() if mixed else panel
            lines = [
                (beside if along else panel).plot(
                    motion.time,
                    motion.position[:, i] if along else np.degrees(motion.position[:, i]),
                    color=colours[i],
                    linewidth=0.9,
                    linestyle="--" if along and mixed else "-",
                    label=f"{joint} [m]" if along and mixed else joint,
                )[0]
                for i, (joint, along) in enumerate(zip(joints, sliding, strict=True))
            ]
            if mixed:
                beside.set_ylabel("m")
                beside.grid(False)
                beside.spines["right"].set_visible(True)
            if motion.off.any():
                panel.axvspan(
                    motion.time[motion.off][0], motion.time[-1], color="#f3f4f6", zorder=0
                )
                panel.text(
                    motion.time[-1],
                    panel.get_ylim()[1],
                    "drives off ",
                    ha="right",
                    va="top",
                    fontsize=8,
                )
            chosen = ", in the shortest set" if motion.name in experiment.chosen else ""
            panel.set_title(f"{motion.name}{chosen}", loc="left", fontsize=10)
            panel.set_ylabel("m" if all(sliding) else "deg")
            panel.margins(x=0.01)
        for panel in panels.flat[len(motions) :]:
            panel.set_axis_off()
        for panel in panels[-1]:
            panel.set_xlabel("time [s]")
        figure.legend(
            handles=lines, loc="outside lower center", ncols=min(len(joints), 7), fontsize=8
        )
        return figure


def separation_figure(experiment: Experiment) -> Figure:
    """Draw how clearly each motion separates effects that look alike, at the least clear joint, and
    how clear each effect is.

    Args:
        experiment: the plan.

    Returns:
        The figure.
    """
    with figure_style():
        import matplotlib.pyplot as plt

        names = [m.name for m in experiment.motions]
        grams = [*(experiment.grams[n] for n in names), experiment.gram(experiment.chosen)]
        blocks = experiment.blocks
        effects = list(dict.fromkeys(place[0] for place in blocks.places))
        clear = np.array(
            [
                [
                    np.median([info.strength(g, blocks, p) for p in blocks.places if p[0] == e])
                    for g in grams
                ]
                for e in effects
            ]
        )
        pairs = _pair_rows(experiment, grams)
        figure, (left, right) = plt.subplots(
            1, 2, figsize=(13, 0.32 * max(len(effects), len(pairs)) + 1.8), layout="constrained"
        )
        title = "look-alikes, worst joint at which both show"
        image = _table(left, clear, effects, [*names, "set"], "effects of usual size, median place")
        _table(
            right,
            np.array([row[2] for row in pairs]),
            [f"{a}\nagainst {b}" for a, b, _ in pairs],
            [*names, "set"],
            title,
        )
        figure.colorbar(
            image, ax=(left, right), label=f"standard deviations; {CLEAR:g} are clear", shrink=0.7
        )
        return figure


def _table(
    panel: object, values: np.ndarray, rows: list[str], columns: list[str], title: str
) -> object:
    from matplotlib.colors import BoundaryNorm, ListedColormap

    shades = ListedColormap(["#f3f4f6", "#fde6d8", "#f3b48f", "#7fb3d9", "#2f6db3"])
    image = panel.imshow(  # type: ignore[attr-defined]
        values, aspect="auto", cmap=shades, norm=BoundaryNorm([0, 1, 2, CLEAR, 10, 1000], 5)
    )
    panel.set_xticks(range(len(columns)), columns, rotation=35, ha="right")  # type: ignore[attr-defined]
    panel.set_yticks(range(len(rows)), rows, fontsize=8)  # type: ignore[attr-defined]
    panel.set_title(title, loc="left")  # type: ignore[attr-defined]
    panel.grid(False)  # type: ignore[attr-defined]
    for (row, column), value in np.ndenumerate(values):
        ink = "white" if value >= 10 else "#1d2129"
        panel.text(  # type: ignore[attr-defined]
            column, row, _short(float(value)), ha="center", va="center", fontsize=8, color=ink
        )
    return image


def write_report(experiment: Experiment, folder: str | Path) -> list[Path]:
    """Write the plan as text and figures into a folder.

    Args:
        experiment: the plan.
        folder: must exist.

    Returns:
        The files.
    """
    folder = Path(folder)
    return [
        write_text(folder / "plan.txt", plan_text(experiment)),
        save(motions_figure(experiment), folder / "motions.png"),
        save(separation_figure(experiment), folder / "separation.png"),
    ]
