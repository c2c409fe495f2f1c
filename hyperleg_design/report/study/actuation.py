"""Parts of the study's page about how motors share joints: the matrix, envelopes, and how light that
makes the leg.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.report.page import Section, Table
from hyperleg_design.report.study.context import Context, Made
from hyperleg_design.report.style import later
from hyperleg_design.robot import transmission
from hyperleg_design.robot.names import POSTURES

if TYPE_CHECKING:
    from hyperleg_design.sizing.inertia import LegInertia


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
            later(linkage_figure, design),
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
    from hyperleg_design.report.sizing.envelope_figures import torque_speed_figure
    from hyperleg_design.report.sizing.slice_figures import polyhedron_figure, slice_figure
    from hyperleg_design.sizing import zonotope
    from hyperleg_design.sizing.demand import demand
    from hyperleg_design.sizing.envelope import motor_envelope

    design = context.design
    walk = demand(design, "walk")
    torque = walk.joint_torque.reshape(-1, walk.joint_torque.shape[-1])
    velocity = walk.motion.v[:, 6:].reshape(torque.shape)
    matrix, limit = (
        transmission.joint_from_motor(design, "walking"),
        motor_envelope(design).standstill_torque,
    )
    _, high = zonotope.box(matrix, -limit, limit)
    rows: list[list[Any]] = []
    for index, joint in enumerate(transmission.joint_names(design)):
        alone = float(zonotope.alone(matrix, -limit, limit, index))
        rows.append(
            [
                joint.replace("_", " "),
                float(high[index]),
                alone,
                f"{100 * alone / high[index]:.0f} %",
            ]
        )
    share = float(zonotope.zonotope_to_box_volume(matrix[3:, 3:], -limit[3:], limit[3:]))
    pitch = float(zonotope.alone(matrix[3:, 3:], -limit[3:], limit[3:], 1, held=[0]))
    content = [
        "Each motor lives inside four quadrants: peak torque, and the line from stall torque to no-load speed. Projected through M, the ankle's two motors make the pitch and roll envelopes of the paper's Fig. 4.",
        context.picture(
            "envelopes",
            "Envelopes of the ankle motors, and of ankle pitch (L+R) and roll (L−R), with the operating points of a planned walk at 1.33 m/s.",
            later(torque_speed_figure, design, torque, velocity),
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
            later(slice_figure, design),
        ),
        context.picture(
            "polyhedron",
            "Knee, ankle pitch and toe together, inside the box of their maxima.",
            later(polyhedron_figure, design),
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
    rows = [_leg_row(name, leg) for name, leg in own.items()]
    rows += [_leg_row(other.source.name, other.leg) for other in others]
    toe, bare = own["toe"], own["toe_removed"]
    bipeds = [r for r in others if r.source.legs == 2]
    content = [
        f"Below the knee is {100 * toe.distal_share:.0f} % of the leg's mass. Swinging the straight leg about the hip takes {toe.swing_inertia:.3f} kg m² ({bare.swing_inertia:.3f} without toe and toe motor), and the rotors add {float(rotor_swing_inertia(context.design)):.3f} kg m² there.",
        f"Over the leg's own mass the swing inertia is {toe.inertia_over_leg:.3f}, less than that of {_lighter(toe.inertia_over_leg, [r.leg.inertia_over_leg for r in bipeds])} other two-legged bodies, the human's among them; over the robot's total mass it is {toe.inertia_over_total:.3f}, less than that of {_lighter(toe.inertia_over_total, [r.leg.inertia_over_total for r in bipeds])}, because the legs are {200 * toe.leg_share:.0f} % of the robot. Masses are the paper's, centres of mass and radii of gyration are assumed; the other robots' come from their URDF or SDF files.",
        context.picture(
            "lightness",
            "Share of the leg's mass below the knee, and swing inertia of the straight leg about the hip.",
            later(leg_comparison_figure, list(context.variants.values()), others),
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


def _leg_row(name: str, leg: LegInertia) -> list[Any]:
    """Mass and inertia of a robot's leg, and what they are over its size."""
    numbers = (
        leg.total_mass,
        leg.leg_mass,
        leg.distal_share,
        leg.inertia_over_leg,
        leg.inertia_over_total,
        leg.gyration_over_length,
    )
    return [name, *map(float, numbers)]


def _lighter(own: Any, others: list[Any]) -> str:
    """How many of some robots have more than this one, of those that are known."""
    known = [float(v) for v in others if v == v]
    return f"{sum(v > own for v in known)} of {len(known)}"
