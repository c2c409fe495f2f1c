"""The parts of the study's page, each a function from a context to a section and its headline
numbers.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation import paper
from hyperleg_design.report.page import Cell, Heading, Section, Table
from hyperleg_design.report.pictures import picture, scenes
from hyperleg_design.report.sizing.comparison import Row, motor_rows, table_one
from hyperleg_design.report.sizing.robot_page import parameters_content
from hyperleg_design.report.study.context import Made
from hyperleg_design.robot import ablation
from hyperleg_design.robot.names import JOINTS
from hyperleg_design.sizing.analysis import analyze
from hyperleg_design.writing import write_json

if TYPE_CHECKING:
    from hyperleg_design.report.study.context import Context

LEAD = (
    "From one file of parameters: masses, cooperative actuation, torque-speed envelopes, what the motors can do and what "
    "walking asks of them, for the robot of the paper and for the same robot without its active toe. Every number is "
    "computed when this page is made; values are labelled paper, derived, vendor or assumed."
)


def robot(context: Context) -> Made:
    """Show pictures of the robot and its variants.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    analysis = analyze(context.design)
    write_json(context.folder / "analysis.json", analysis)
    design = context.design
    scenes_of = {
        "dimensions": (
            "Dimensions [mm]; leg length and height are the paper's, the rest is assumed.",
            scenes.dimensions_scene(design),
        ),
        "frames": (
            "Joint axes: an arrow points along the axis about which the angle is positive.",
            scenes.frames_scene(design),
        ),
        "masses": (
            "Segment masses at their centres of mass; balls have the volume of that mass at 6.5 kg/dm³.",
            scenes.masses_scene(design),
        ),
        "variants": (
            "The four variants; orange: active toe and its motor.",
            scenes.variants_scene(context.variants),
        ),
    }
    *drawn, side_by_side = context.picture.together(
        [
            (name, caption, partial(picture.render, scene), ".png", True)
            for name, (caption, scene) in scenes_of.items()
        ]
    )
    confound = ablation.confound(design)
    rows = []
    for name, entry in confound.items():
        torque = entry["max_joint_torque"]
        lost = entry["lost"]
        cells: list[Any] = [name, entry["total_mass"], 2 * entry["motors"]]
        cells += [
            Cell(torque[j], "bad" if lost[j] > 1e-9 else "") if j in torque else "–"
            for j in JOINTS[3:]
        ]
        rows.append([*cells, entry["removes"]])
    content = [
        drawn,
        side_by_side,
        Table(
            [
                "variant",
                "mass [kg]",
                "motors",
                *(f"{j.replace('_', ' ')} [Nm]" for j in JOINTS[3:]),
                "what it is",
            ],
            rows,
            "Largest joint torque, standing, derated as in Table I.",
        ),
        "The motors below the hip are shared. Taking the toe's motor away therefore also takes "
        f"{confound['toe_removed']['lost']['knee']:.1f} Nm from the knee and {confound['toe_removed']['lost']['ankle_pitch']:.1f} Nm from ankle pitch: "
        "a comparison of “toe” and “no toe” is also one of a strong and a weak knee. The locked toe, whose motor still helps, and the removal at equal mass separate the two.",
    ]
    facts = (
        (f"{analysis['total_mass']:.2f} kg", "total mass, as printed"),
        (f"{analysis['leg_mass']:.2f} kg", "one leg, as printed"),
        (
            f"{100 * analysis['zonotope_to_box_volume']:.1f} %",
            "of the box of maximum torques below the hip can be reached",
        ),
        (
            f"{confound['toe']['max_joint_torque']['knee']:.0f} → {confound['toe_removed']['max_joint_torque']['knee']:.0f} Nm",
            "knee torque lost with the toe's motor",
        ),
    )
    return Made(Section("The robot and its variants", content), facts)


def table_i(context: Context) -> Made:
    """Compare Table I and the motors with the paper's values.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    rows = table_one(context.design)
    agreeing = sum(r.verdict == "agrees" for r in rows)
    content = [
        "Recomputed from the parameters; a number agrees when it is within 0.1 %, which is what rounding leaves. The speeds differ because the joint block of the paper's table prints the motors'.",
        _rows_table(rows),
        "The paper's power constants against those that follow from the catalogue:",
        _rows_table(motor_rows()),
    ]
    return Made(
        Section("Table I beside the paper", content),
        ((f"{agreeing} / {len(rows)}", "numbers of Table I agree; the others are explained"),),
    )


def _rows_table(rows: list[Row]) -> Table:
    cells = [
        [
            r.place,
            r.quantity.replace("_", " "),
            r.paper,
            r.ours,
            r.unit,
            f"{100 * r.difference:+.2f} %",
            Cell(r.verdict, "good" if r.verdict == "agrees" else "bad"),
            Cell("" if r.verdict == "agrees" else r.note, "note"),
        ]
        for r in rows
    ]
    return Table(
        ["place", "quantity", "paper", "ours", "unit", "difference", "verdict", "why"], cells
    )


def inconsistencies(context: Context) -> Made:
    """List what does not fit together in the paper.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    rows = [[i.place, i.finding, i.choice] for i in paper.INCONSISTENCIES]
    return Made(
        Section(
            "What does not fit together in the paper",
            [Table(["place", "what was found", "what is done here"], rows)],
        )
    )


def sweeps(context: Context) -> Made:
    """Run every shipped sweep of sizing measures; those whose designs walk take hours and have
    pages of their own.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design import resources
    from hyperleg_design.report.sweep.page import sweep_content
    from hyperleg_design.sweep.run import run_sweep
    from hyperleg_design.sweep.space import load_sweep

    content: list[Any] = [
        "Thousands of designs at once, each with its masses, torques, speeds, reachable torque set and heat. Every table stands beside this page as Parquet, with the resolved configuration inside."
    ]
    designs = 0
    for name in sorted(resources.names("sweeps"), key=lambda n: (n == "combined", n)):
        sweep = load_sweep(name)
        if sweep.evaluated:
            continue
        result = run_sweep(sweep, context.folder / "sweeps" / name, progress=False)
        designs += result.summary["designs"]
        content += [
            Heading(name.replace("_", " ").capitalize()),
            *sweep_content(result, f"sweep-{name}"),
        ]
    return Made(
        Section("Sweeps", content), ((f"{designs:,}".replace(",", " "), "designs in the sweeps"),)
    )


def motors(context: Context) -> Made:
    """List the motors of the catalogue.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.robot.motors import catalogue

    rows = []
    for m in catalogue().values():
        weakest = min(
            (m.constants[k].confidence for k in ("peak_torque", "torque_constant", "resistance")),
            key=["low", "medium", "high"].index,
        )
        assumed = [k for k, c in m.constants.items() if c.label == "assumed"]
        numbers = [
            m.mass,
            m.peak_torque("vendor"),
            m.rated_torque,
            m.no_load_speed("vendor"),
            m.stall_torque("vendor"),
            m.corner_speed("vendor"),
            m.power_constant("vendor"),
            m.motor_constant("vendor"),
            m.rated_heat("vendor"),
        ]
        rows.append(
            [
                m.name,
                m.vendor,
                m.kind,
                *numbers,
                weakest,
                Cell(", ".join(a.split("_")[0] for a in assumed) or "–", "note"),
            ]
        )
    heads = [
        "motor",
        "vendor",
        "kind",
        "kg",
        "peak Nm",
        "rated Nm",
        "no load rad/s",
        "stall Nm",
        "corner rad/s",
        "Cp W/Nm²",
        "Km Nm/√W",
        "rated heat W",
        "confidence",
        "assumed",
    ]
    content = [
        "Vendors' constants; stall torque, corner speed, power constant, motor constant and heat are computed from them. Each constant's source stands in the motor's file.",
        Table(heads, rows),
    ]
    return Made(
        Section("Motors to choose from", content), ((str(len(rows)), "motors in the catalogue"),)
    )


def made_from(context: Context) -> Made:
    """List all parameters with their labels and sources.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    return Made(Section("What this page was made from", parameters_content(context.design)))
