"""The parts of the study's page, each a function from a context to a section and its headline
numbers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation import paper
from hyperleg_design.report.page import Cell, Details, Heading, Section, Table
from hyperleg_design.report.pictures import picture
from hyperleg_design.report.sizing.comparison import Row, motor_rows, table_one
from hyperleg_design.report.study.context import Made
from hyperleg_design.report.style import save
from hyperleg_design.robot import ablation, parameters, transmission
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.names import JOINTS, POSTURES
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
    drawn = [
        context.picture(
            "dimensions",
            "Dimensions [mm]; leg length and height are the paper's, the rest is assumed.",
            lambda p: picture.render(picture.dimensions_scene(design), p),
        ),
        context.picture(
            "frames",
            "Joint axes: an arrow points along the axis about which the angle is positive.",
            lambda p: picture.render(picture.frames_scene(design), p),
        ),
        context.picture(
            "masses",
            "Segment masses at their centres of mass; balls have the volume of that mass at 6.5 kg/dm³.",
            lambda p: picture.render(picture.masses_scene(design), p),
        ),
    ]
    side_by_side = context.picture(
        "variants",
        "The four variants; orange: active toe and its motor.",
        lambda p: picture.render(picture.variants_scene(context.variants), p),
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
        [*drawn],
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


def cooperative_actuation(context: Context) -> Made:
    """Show the matrix in both postures, and between them.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.report.sizing.linkage_figures import linkage_figure
    from hyperleg_design.robot.models import leg_reflected_inertia

    design = context.design
    joints = [j.replace("_", " ") for j in transmission.joint_names(design)]
    motors = [m.replace("_", " ") for m in transmission.motor_names(design)]
    tables = [
        Table(
            ["joint \\ motor", *motors],
            [
                [j, *map(float, row)]
                for j, row in zip(joints, transmission.joint_from_motor(design, p), strict=True)
            ],
            f"joint_from_motor, {p}",
        )
        for p in POSTURES
    ]
    inertia = leg_reflected_inertia(design)
    inertia = np.where(np.abs(inertia) < 1e-12, 0.0, inertia)  # rounding where motors cancel
    reflected = Table(
        ["", *joints],
        [[j, *map(float, row)] for j, row in zip(joints, inertia, strict=True)],
        f"Reflected rotor inertia M diag(J) Mᵀ [kg m²], {design.transmission.posture}",
    )
    content = [
        "Motor torques reach the joints by joint_torque = M motor_torque, and motor_velocity = Mᵀ joint_velocity, so power is the same on both sides. The knee's row is negative because knee flexion is positive: positive motor torque extends the knee and pushes the toes down.",
        *tables,
        reflected,
        f"Rotors couple the joints: the knee's {inertia[3, 3]:.3f} kg m² come with {inertia[3, 4]:.3f} kg m² between knee and ankle pitch, which a diagonal armature drops.",
        "M depends on posture. The paper prints two postures; between them stands a four-bar model of ours, calibrated to both and labelled assumed. It is the exact gradient of a motor-position map, so work around a closed path is zero.",
        context.picture(
            "linkage",
            "Reductions over posture. Squares and dots: the printed postures.",
            lambda p: save(linkage_figure(design), p),
        ),
    ]
    return Made(Section("Cooperative actuation", content))


def envelopes(context: Context) -> Made:
    """Show motor envelopes, and the set of torques that joints can have together.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.report.sizing.envelope_figures import (
        polyhedron_figure,
        slice_figure,
        torque_speed_figure,
    )
    from hyperleg_design.sizing import zonotope
    from hyperleg_design.sizing.demand import demand
    from hyperleg_design.sizing.envelope import motor_envelope

    design = context.design
    walk = demand(design, "walk")
    torque = walk.joint_torque.reshape(-1, walk.joint_torque.shape[-1])
    velocity = walk.motion.v[:, 6:].reshape(torque.shape)
    matrix, peak = (
        transmission.joint_from_motor(design, "walking"),
        motor_envelope(design).peak_torque,
    )
    _, high = zonotope.box(matrix, -peak, peak)
    rows: list[list[Any]] = []
    for index, joint in enumerate(transmission.joint_names(design)):
        alone = float(zonotope.alone(matrix, -peak, peak, index))
        rows.append(
            [
                joint.replace("_", " "),
                float(high[index]),
                alone,
                f"{100 * alone / high[index]:.0f} %",
            ]
        )
    share = float(zonotope.zonotope_to_box_volume(matrix[3:, 3:], -peak[3:], peak[3:]))
    pitch = float(zonotope.alone(matrix[3:, 3:], -peak[3:], peak[3:], 1, held=[0]))
    content = [
        "Each motor lives inside four quadrants: peak torque, and the line from stall torque to no-load speed. Projected through M, the ankle's two motors make the pitch and roll envelopes of the paper's Fig. 4.",
        context.picture(
            "envelopes",
            "Envelopes of the ankle motors, and of ankle pitch (L+R) and roll (L−R), with the operating points of a planned walk at 1.33 m/s.",
            lambda p: save(torque_speed_figure(design, torque, velocity), p),
        ),
        f"The printed maxima of the joints are one at a time. Below the hip the reachable torques are a zonotope that fills {100 * share:.1f} % of the box those maxima span. With no knee torque, ankle pitch reaches {pitch:.1f} Nm, not {high[4]:.1f}.",
        Table(
            [
                "joint",
                "largest, whatever the others do [Nm]",
                "largest, the others at zero [Nm]",
                "of it",
            ],
            rows,
            "Walking posture, zero speed, not derated.",
        ),
        context.picture(
            "slices",
            "What two joints can have together, the others at zero, against the box (dashed).",
            lambda p: save(slice_figure(design), p),
        ),
        context.picture(
            "polyhedron",
            "Knee, ankle pitch and toe together, inside the box of their maxima.",
            lambda p: save(polyhedron_figure(design), p),
        ),
    ]
    return Made(Section("Envelopes, and what a box hides", content))


def lightness(context: Context) -> Made:
    """Compare the leg's mass and inertia with those of other robots.

    Args:
        context: what the study is about, and where its files go.

    Returns:
        The section, and its headline numbers.
    """
    from hyperleg_design.report.sizing.inertia_figures import leg_comparison_figure
    from hyperleg_design.sizing.inertia import leg_inertia, rotor_swing_inertia
    from hyperleg_design.sizing.other_robots import compare

    own = {name: leg_inertia(design) for name, design in context.variants.items()}
    others = compare()
    rows: list[list[Any]] = [
        [
            name,
            float(m.total_mass),
            float(m.leg_mass),
            float(m.distal_share),
            float(m.inertia_over_leg),
            float(m.inertia_over_total),
            float(m.gyration_over_length),
        ]
        for name, m in own.items()
    ]
    rows += [
        [
            r.source.name,
            float(r.leg.total_mass),
            float(r.leg.leg_mass),
            float(r.leg.distal_share),
            float(r.leg.inertia_over_leg),
            float(r.leg.inertia_over_total),
            float(r.leg.gyration_over_length),
        ]
        for r in others
    ]
    toe, bare = own["toe"], own["toe_removed"]
    bipeds = [r for r in others if r.source.legs == 2]
    content = [
        f"Below the knee is {100 * toe.distal_share:.0f} % of the leg's mass. Swinging the straight leg about the hip takes {toe.swing_inertia:.3f} kg m² ({bare.swing_inertia:.3f} without toe and toe motor), and the rotors add {float(rotor_swing_inertia(context.design)):.3f} kg m² there.",
        f"Over the leg's own mass the swing inertia is {toe.inertia_over_leg:.3f}, less than that of {_lighter(toe.inertia_over_leg, [r.leg.inertia_over_leg for r in bipeds])} other two-legged bodies, the human's among them; over the robot's total mass it is {toe.inertia_over_total:.3f}, less than that of {_lighter(toe.inertia_over_total, [r.leg.inertia_over_total for r in bipeds])}, because the legs are {200 * toe.leg_share:.0f} % of the robot. Masses are the paper's, centres of mass and radii of gyration are assumed; the other robots' come from their URDF or SDF files.",
        context.picture(
            "lightness",
            "Share of the leg's mass below the knee, and swing inertia of the straight leg about the hip.",
            lambda p: save(leg_comparison_figure(list(context.variants.values()), others), p),
        ),
        Table(
            [
                "robot",
                "total kg",
                "leg kg",
                "below the knee [-]",
                "swing inertia / (leg mass · length²)",
                "… / (total mass · length²)",
                "gyration / length",
            ],
            rows,
        ),
    ]
    return Made(
        Section("How light the leg is", content),
        ((f"{100 * toe.distal_share:.0f} %", "of the leg's mass is below the knee"),),
    )


def _lighter(own: Any, others: list[Any]) -> str:
    known = [float(v) for v in others if v == v]
    return f"{sum(v > own for v in known)} of {len(known)}"


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
    design = context.design
    labels: dict[str, int] = {}
    rows = []
    for path, rule in parameters.rules(Design).items():
        origin = design.origins.get(path)
        label = origin.label if origin else ""
        labels[label] = labels.get(label, 0) + 1
        value = design[path]
        shown = ", ".join(f"{v:g}" for v in value) if isinstance(value, np.ndarray) else value
        rows.append([path, shown, rule.unit, label, origin.source if origin else ""])
    summary = ", ".join(f"{count} {label}" for label, count in sorted(labels.items()))
    content = [
        f"The design has {len(rows)} parameters: {summary}. Any of them can be set from the command line, in a file, or in Python, and can be an axis of a sweep.",
        Details("All parameters", [Table(["parameter", "value", "unit", "label", "source"], rows)]),
    ]
    return Made(Section("What this page was made from", content))
