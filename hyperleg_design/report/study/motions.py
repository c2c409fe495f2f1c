"""Parts of the study's page about what a leg can push and what motions ask of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.report.page import Cell, Details, Missing, Section, Table
from hyperleg_design.report.study.context import Context, Made
from hyperleg_design.report.style import later
from hyperleg_design.writing import write_json

if TYPE_CHECKING:
    from hyperleg_design.sizing.demand import Demand

MOTIONS = ("walk", "stair", "squat", "hop")
"""Reference motions in the order of the page."""
PAIR = ("toe", "toe_removed_matched")
"""Variants that are compared: an active toe, and none at equal mass."""
Summaries: TypeAlias = "dict[str, dict[str, dict[str, Any]]]"
"""Summaries of demands by motion and variant."""


def capability(context: Context) -> Made:
    """Show the largest forces that the feet can exert on the ground.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.report.sizing.demand_figures import capability_figure
    from hyperleg_design.sizing.capability import capability_table

    upright = [
        {**row, "direction": "vertical, through the centre of mass"}
        for row in capability_table(context.variants, upright=True)
        if row["direction"] == "vertical"
    ]
    free = capability_table(context.variants)
    write_json(context.folder / "capability.json", free + upright)
    by_place: dict[tuple[str, str], dict[str, dict[str, Any]]] = {}
    for row in free + upright:
        by_place.setdefault((row["posture"], row["direction"]), {})[row["design"]] = row
    content: list[Any] = [
        "The largest force that one leg can press on the floor in a posture at rest, inside the motors' envelopes and the friction cones of the sole's pads (a second-order cone programme). The pelvis is held. Near straight knees the vertical force is almost borne by the structure; with the force through the centre of mass, as in standing on that leg, it is what motors can hold.",
        Table(
            [
                "posture",
                "direction",
                *(f"{v} [N]" for v in context.variants),
                "motors at their limit",
            ],
            [_force_row(*place, entries) for place, entries in by_place.items()],
        ),
        context.picture(
            "capability",
            "Largest contact force of one leg by posture.",
            later(capability_figure, free),
        ),
    ]
    tip = by_place[("toe_off", "vertical")]
    active, locked = tip["toe"]["force"], tip["toe_locked"]["force"]
    if active and locked:
        verdict = (
            "so the active toe is the weak link there: it buys motion, not force"
            if active / locked < 0.95
            else "so the active toe costs no force there"
        )
        content.append(
            f"With the heel up and only the tip on the floor, the active toe presses {active:.0f} N, the locked toe, whose motor helps knee and ankle, {locked:.0f} N: {verdict}."
        )
    return Made(Section("What the leg can push", content))


def _force_row(posture: str, direction: str, entries: dict[str, dict[str, Any]]) -> list[Any]:
    """Largest forces of all variants in one posture and direction, the best ones marked."""
    best = max(entry["force"] or 0.0 for entry in entries.values())
    cells = [
        Cell(entry["force"], "good" if entry["force"] and entry["force"] > 0.999 * best else "")
        for entry in entries.values()
    ]
    limits = "; ".join(
        f"{name}: {', '.join(entry['binding']).replace('_', ' ')}"
        for name, entry in entries.items()
        if name in PAIR and entry.get("binding")
    )
    return [posture.replace("_", " "), direction, *cells, Cell(limits, "note")]


def demand(context: Context) -> Made:
    """Show what planned motions ask of every motor.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.sizing.demand import demand as demand_of

    demands: dict[str, dict[str, Demand]] = {}
    reasons: list[str] = []
    for motion in MOTIONS:
        for name, design in context.variants.items():
            try:
                demands.setdefault(motion, {})[name] = demand_of(design, motion)
            except InfeasibleError as error:
                reasons.append(f"{name}, {motion}: {error}")
    summaries = {m: {n: d.summary() for n, d in by.items()} for m, by in demands.items()}
    write_json(context.folder / "demand.json", summaries)
    walk = summaries["walk"]
    active, locked, none = (walk[n] for n in ("toe", "toe_locked", "toe_removed_matched"))
    changes = [100 * (own["motor_side"] / none["motor_side"] - 1) for own in (active, locked)]
    content: list[Any] = [
        "Motions are planned for each design (inverse kinematics with the design's own lengths), inverse dynamics gives the forces they need, and contact forces and motor torques of least Joule heat are found inside envelopes and friction cones. These are planned motions, not learned ones: they compare designs on one task, and say nothing about what a good controller would do.",
        _totals(summaries),
        f"On the planned walk at 1.33 m/s the active toe changes motor-side power by {changes[0]:+.1f} % against no toe at equal mass; the locked toe, whose motor still helps, by {changes[1]:+.1f} %.",
        *_figures(context, demands),
        Details("Every motor in every motion", _motor_tables(summaries)),
        Details("What the motions assume", [_assumptions(summaries)]),
        *(Missing("motion that a variant cannot make", reason) for reason in reasons),
    ]
    facts = (
        (
            f"{active['cost_of_transport']:.3f} / {none['cost_of_transport']:.3f}",
            "CoT of a planned walk with / without the toe, equal mass",
        ),
    )
    return Made(Section("What motions ask of the motors", content), facts)


def _totals(summaries: Summaries) -> Table:
    """Mean powers of each motion and variant."""
    rows = []
    for motion, entries in summaries.items():
        for name, summary in entries.items():
            beyond = summary["beyond_share"]
            rows.append(
                [
                    motion,
                    name,
                    *(summary[key] for key in ("joule", "mechanical", "motor_side", "battery")),
                    summary.get("cost_of_transport", float("nan")),
                    summary.get("cost_of_transport_battery", float("nan")),
                    Cell(f"{100 * beyond:.0f} %", "bad" if beyond else ""),
                ]
            )
    return Table(
        [
            "motion",
            "variant",
            "Joule [W]",
            "mech. [W]",
            "motors [W]",
            "battery [W]",
            "CoT motors",
            "CoT battery",
            "beyond",
        ],
        rows,
        "Mean powers, joint friction included. CoT: energy over m g distance. Beyond: part of the time that needs more than the envelopes give.",
    )


def _motor_tables(summaries: Summaries) -> list[Table]:
    """What each motion asks of each motor, a table for each motion and variant."""
    columns = {
        "peak_torque": "peak [Nm]",
        "rms_torque": "rms [Nm]",
        "rms_over_rated": "rms / rated",
        "peak_speed": "peak speed [rad/s]",
        "speed_over_no_load": "speed / no load",
        "margin": "smallest margin [Nm]",
        "joule": "Joule [W]",
        "mechanical": "mechanical [W]",
    }

    def row(motor: dict[str, Any]) -> list[Any]:
        cells = [
            Cell(motor[key], "bad" if key == "margin" and motor[key] < -1e-6 else "")
            for key in columns
        ]
        return [motor["motor"].replace("_", " "), *cells]

    return [
        Table(
            ["motor", *columns.values()], [row(m) for m in summary["motors"]], f"{motion}, {name}"
        )
        for motion, entries in summaries.items()
        for name, summary in entries.items()
    ]


def _assumptions(summaries: Summaries) -> Table:
    """What was chosen for each motion, the same for all variants."""
    rows = [
        [motion, what, text]
        for motion, entries in summaries.items()
        for what, text in next(iter(entries.values()))["assumptions"].items()
    ]
    return Table(["motion", "what", "assumed"], rows)


def _figures(context: Context, demands: dict[str, dict[str, Demand]]) -> list[Any]:
    from hyperleg_design.report.sizing.demand_figures import (
        cycle_figure,
        margin_figure,
        operating_points_figure,
    )
    from hyperleg_design.report.sizing.stick_figures import stick_figure_strip

    walk = demands["walk"]
    pair: dict[str, Demand] = {n: walk[n] for n in PAIR if n in walk}
    drawn: list[Any] = [
        context.picture(
            "walk",
            "The planned walk with the active toe, from the right side, with the floor's force on each foot.",
            later(stick_figure_strip, walk["toe"]),
        ),
        context.picture(
            "walk_cycle",
            "Joint angles and torques of the left leg over one cycle of the planned walk.",
            later(cycle_figure, pair),
        ),
        context.picture(
            "walk_points",
            "Operating points of every motor on the planned walk, in their envelopes.",
            later(operating_points_figure, pair),
        ),
        context.picture(
            "walk_margins",
            "Smallest margin, thermal use and heat of every motor on the planned walk.",
            later(margin_figure, walk),
        ),
    ]
    others = [m for m in MOTIONS[1:] if "toe" in demands.get(m, {})]
    strips = [
        context.picture(
            m,
            f"The planned {m}, active toe.",
            later(stick_figure_strip, demands[m]["toe"]),
        )
        for m in others
    ]
    return [*drawn, *strips]
