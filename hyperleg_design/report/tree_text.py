"""The analysis of a robot that writes its tree out, for a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hyperleg_design.report.text import table


def tree_analysis_text(analysis: Mapping[str, Any]) -> str:
    """Write what `tree_analysis.analyze_tree` returns as a page for a terminal.

    Args:
        analysis: the analysis.

    Returns:
        The text.
    """
    masses = ", ".join(f"{name} {mass:.3g}" for name, mass in analysis["link_mass"].items())
    joints = [
        [
            name,
            analysis["max_joint_torque"][name],
            analysis["torque_alone"][name],
            analysis["single_joint_speed"][name],
            analysis["reflected_inertia"][row][row],
            analysis["link_inertia"][name],
        ]
        for row, name in enumerate(analysis["joints"])
    ]
    heads = ["joint", "max torque [Nm]", "alone [Nm]", "speed [rad/s]"]
    heads += ["reflected inertia [kg m^2]", "link inertia [kg m^2]"]
    keys = ("peak_torque", "rated_torque", "no_load_speed", "power_constant")
    motors = [
        [name, m["motor"], m["gear"], *(float(m[k]) for k in keys)]
        for name, m in analysis["motors"].items()
    ]
    lines = []
    for direction, force in analysis["contact_force"].items():
        if force["force"] is None:
            lines.append(f"largest {direction} force of one limb: none; {force['reason']}")
            continue
        lines.append(
            f"largest {direction} force of one limb, default posture: {force['force']:.4g} N, "
            f"{force['body_weights']:.3g} body weights; at their limit: "
            f"{', '.join(force['binding']) or 'no motor, the floor slips'}"
        )
    return "\n".join(
        [
            f"{analysis['design']} (limbs: {', '.join(analysis['limbs'])}): "
            f"{analysis['total_mass']:.2f} kg, limb "
            f"{analysis['limb_mass']:.2f} kg, standing height {analysis['standing_height']:.3f} m",
            f"links [kg]: {masses}",
            "",
            table(heads, joints),
            "max torque: derated, one joint at its best whatever the others do; alone: the others "
            "at zero torque; all in the default posture",
            f"reachable torques of one limb fill {100 * analysis['zonotope_to_box_volume']:.1f} % "
            f"of the box that their maxima span",
            "",
            table(
                [
                    "motor",
                    "type",
                    "gear",
                    "peak [Nm]",
                    "rated [Nm]",
                    "no load [rad/s]",
                    "Cp [W/Nm^2]",
                ],
                motors,
            ),
            "",
            *lines,
        ]
    )
