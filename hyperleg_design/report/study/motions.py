"""Parts of the study's page about what a leg can push and what motions ask of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.report.page import Cell, Details, Missing, Section, Table
from hyperleg_design.report.study.context import Made
from hyperleg_design.report.style import save
from hyperleg_design.writing import write_json

if TYPE_CHECKING:
    from hyperleg_design.report.study.context import Context
    from hyperleg_design.sizing.demand import Demand

MOTIONS = ("walk", "stair", "squat", "hop")
"""Reference motions in the order of the page."""


def capability(context: Context) -> Made:
    """Show the largest forces that the feet can exert on the ground.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.sizing.capability import capability_table

    upright = [
        {**row, "direction": "vertical, through the centre of mass"}
        for row in capability_table(context.variants, upright=True)
        if row["direction"] == "vertical"
    ]
    free = capability_table(context.variants)
    forces = free + upright
    write_json(context.folder / "capability.json", forces)
    by_place: dict[tuple[str, str], dict[str, dict[str, Any]]] = {}
    for row in forces:
        by_place.setdefault((row["posture"], row["direction"]), {})[row["design"]] = row
    rows = []
    for (posture, direction), entries in by_place.items():
        best = max(e["force"] or 0.0 for e in entries.values())
        cells = [
            Cell(e["force"], "good" if e["force"] and e["force"] > 0.999 * best else "")
            for e in entries.values()
        ]
        stops = "; ".join(
            f"{name}: {', '.join(e['binding']).replace('_', ' ')}"
            for name, e in entries.items()
            if name in ("toe", "toe_removed_matched") and e.get("binding")
        )
        rows.append([posture.replace("_", " "), direction, *cells, Cell(stops, "note")])
    off = by_place[("toe_off", "vertical")]
    from hyperleg_design.report.sizing.demand_figures import capability_figure

    content: list[Any] = [
        "The largest force that one leg can press on the floor in a posture at rest, inside the motors' envelopes and the friction cones of the sole's pads (a second-order cone programme). The pelvis is held. Near straight knees the vertical force is almost borne by the structure; with the force through the centre of mass, as in standing on that leg, it is what motors can hold.",
        Table(
            [
                "posture",
                "direction",
                *(f"{v} [N]" for v in context.variants),
                "motors at their limit",
            ],
            rows,
        ),
    ]
    content.append(
        context.picture(
            "capability",
            "Largest contact force of one leg by posture.",
            lambda p: save(capability_figure(free), p),
        )
    )
    if off["toe"]["force"] and off["toe_locked"]["force"]:
        ratio = off["toe"]["force"] / off["toe_locked"]["force"]
        verdict = (
            "so the active toe is the weak link there: it buys motion, not force"
            if ratio < 0.95
            else "so the active toe costs no force there"
        )
        content.append(
            f"With the heel up and only the tip on the floor, the active toe presses {off['toe']['force']:.0f} N, the locked toe, whose motor helps knee and ankle, {off['toe_locked']['force']:.0f} N: {verdict}."
        )
    return Made(Section("What the leg can push", content))


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
    rows = []
    for motion, entries in summaries.items():
        for name, s in entries.items():
            beyond = Cell(f"{100 * s['beyond_share']:.0f} %", "bad" if s["beyond_share"] else "")
            rows.append(
                [
                    motion,
                    name,
                    s["joule"],
                    s["mechanical"],
                    s["motor_side"],
                    s["battery"],
                    s.get("cost_of_transport", float("nan")),
                    s.get("cost_of_transport_battery", float("nan")),
                    beyond,
                ]
            )
    walk = summaries["walk"]
    ratio = walk["toe"]["motor_side"] / walk["toe_removed_matched"]["motor_side"] - 1
    content: list[Any] = [
        "Motions are planned for each design (inverse kinematics with the design's own lengths), inverse dynamics gives the forces they need, and contact forces and motor torques of least Joule heat are found inside envelopes and friction cones. These are planned motions, not learned ones: they compare designs on one task, and say nothing about what a good controller would do.",
        Table(
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
        ),
        f"On the planned walk at 1.33 m/s the active toe changes motor-side power by {100 * ratio:+.1f} % against no toe at equal mass; the locked toe, whose motor still helps, by {100 * (walk['toe_locked']['motor_side'] / walk['toe_removed_matched']['motor_side'] - 1):+.1f} %.",
    ]
    content += _figures(context, demands)
    details = []
    for motion, entries in summaries.items():
        for name, s in entries.items():
            head = [
                "motor",
                "peak [Nm]",
                "rms [Nm]",
                "rms / rated",
                "peak speed [rad/s]",
                "speed / no load",
                "smallest margin [Nm]",
                "Joule [W]",
                "mechanical [W]",
            ]
            keys = (
                "peak_torque",
                "rms_torque",
                "rms_over_rated",
                "peak_speed",
                "speed_over_no_load",
                "margin",
                "joule",
                "mechanical",
            )
            table_rows = [
                [
                    r["motor"].replace("_", " "),
                    *(Cell(r[k], "bad" if k == "margin" and r[k] < -1e-6 else "") for k in keys),
                ]
                for r in s["motors"]
            ]
            details.append(Table(head, table_rows, f"{motion}, {name}"))
    assumed = [
        [m, what, text]
        for m, entries in summaries.items()
        for what, text in next(iter(entries.values()))["assumptions"].items()
    ]
    content += [
        Details("Every motor in every motion", details),
        Details("What the motions assume", [Table(["motion", "what", "assumed"], assumed)]),
    ]
    content += [Missing("motion that a variant cannot make", reason) for reason in reasons]
    facts = (
        (
            f"{walk['toe']['cost_of_transport']:.3f} / {walk['toe_removed_matched']['cost_of_transport']:.3f}",
            "CoT of a planned walk with / without the toe, equal mass",
        ),
    )
    return Made(Section("What motions ask of the motors", content), facts)


def _figures(context: Context, demands: dict[str, dict[str, Demand]]) -> list[Any]:
    from hyperleg_design.report.sizing.demand_figures import (
        cycle_figure,
        margin_figure,
        operating_points_figure,
    )
    from hyperleg_design.report.sizing.stick_figures import stick_figure_strip

    walk = demands["walk"]
    pair: dict[str, Demand] = {n: walk[n] for n in ("toe", "toe_removed_matched") if n in walk}
    drawn: list[Any] = [
        context.picture(
            "walk",
            "The planned walk with the active toe, from the right side, with the floor's force on each foot.",
            lambda p: save(stick_figure_strip(walk["toe"]), p),
        ),
        context.picture(
            "walk_cycle",
            "Joint angles and torques of the left leg over one cycle of the planned walk.",
            lambda p: save(cycle_figure(pair), p),
        ),
        context.picture(
            "walk_points",
            "Operating points of every motor on the planned walk, in their envelopes.",
            lambda p: save(operating_points_figure(pair), p),
        ),
        context.picture(
            "walk_margins",
            "Smallest margin, thermal use and heat of every motor on the planned walk.",
            lambda p: save(margin_figure(walk), p),
        ),
    ]
    others = [m for m in MOTIONS[1:] if "toe" in demands.get(m, {})]
    strips = [
        context.picture(
            m,
            f"The planned {m}, active toe.",
            lambda p, m=m: save(stick_figure_strip(demands[m]["toe"]), p),  # type: ignore[misc]
        )
        for m in others
    ]
    return [*drawn, *strips]
