"""The analysis of a robot that writes its tree out, for a terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hyperleg_design.report.text import table
from hyperleg_design.robot.checks.check_pads import pads_text

JOINTS_NOTE = (
    "max torque: derated, one joint at its best whatever the others do; alone: the others at zero "
    "torque; all in the default posture"
)
MOST_LINKS = 20
"""Links that the analysis lists; where there are more, the lightest are summed."""


def tree_analysis_text(analysis: Mapping[str, Any]) -> str:
    """Write what `tree_analysis.analyze_tree` returns as a page for a terminal.

    Args:
        analysis: the analysis.

    Returns:
        The text.
    """
    limbs = analysis["limbs"]
    copies = f"limbs: {', '.join(limbs)}" if limbs else "described as a whole"
    limb, behind = _limb(analysis), "limb" if limbs else "all but the trunk"
    return "\n".join(
        [
            f"{analysis['design']} ({copies}): {analysis['total_mass']:.2f} kg, {behind} "
            f"{analysis['limb_mass']:.2f} kg, standing height {_height(analysis)}",
            f"links [kg]: {_links(analysis['link_mass'])}",
            "",
            table(*joint_table(analysis)),
            JOINTS_NOTE,
            f"reachable torques of {limb} fill {100 * analysis['zonotope_to_box_volume']:.1f} % "
            f"of the box that their maxima span",
            "",
            table(*motor_table(analysis)),
            "",
            *_linkages(analysis["linkages"]),
            *force_lines(analysis),
        ]
    )


def joint_table(analysis: Mapping[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Tabulate what the joints can do.

    Args:
        analysis: as `tree_analysis.analyze_tree` returns it.

    Returns:
        Heads, and a row a joint.
    """
    heads = ["joint", "max torque [Nm]", "alone [Nm]", "speed [rad/s]"]
    heads += ["reflected inertia [kg m^2]", "link inertia [kg m^2]"]
    keys = ("max_joint_torque", "torque_alone", "single_joint_speed")
    return heads, [
        [
            name,
            *(analysis[key][name] for key in keys),
            analysis["reflected_inertia"][row][row],
            analysis["link_inertia"][name],
        ]
        for row, name in enumerate(analysis["joints"])
    ]


def motor_table(analysis: Mapping[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Tabulate the motors and gears.

    Args:
        analysis: as `tree_analysis.analyze_tree` returns it.

    Returns:
        Heads, and a row a motor.
    """
    heads = ["motor", "type", "gear", "peak [Nm]", "rated [Nm]", "stall [Nm]", "no load [rad/s]"]
    heads.append("Cp [W/Nm^2]")
    keys = ("peak_torque", "rated_torque", "stall_torque", "no_load_speed", "power_constant")
    return heads, [
        [name, m["motor"], m["gear"], *(float(m[k]) for k in keys)]
        for name, m in analysis["motors"].items()
    ]


def _limb(analysis: Mapping[str, Any]) -> str:
    return "one limb" if analysis["limbs"] else "the robot"


def _height(analysis: Mapping[str, Any]) -> str:
    height = analysis["standing_height"]
    return "unknown without pads" if height is None else f"{height:.3f} m"


def _links(masses: Mapping[str, float]) -> str:
    """Masses of the heaviest links in the order of the file, and the sum of the others."""
    heaviest = sorted(masses, key=lambda name: -masses[name])[:MOST_LINKS]
    shown = [f"{name} {mass:.3g}" for name, mass in masses.items() if name in heaviest]
    rest = [mass for name, mass in masses.items() if name not in heaviest]
    return ", ".join([*shown, f"{len(rest)} lighter ones {sum(rest):.3g}"] if rest else shown)


def _linkages(linkages: Mapping[str, Any]) -> list[str]:
    """One line for each joint that a rod drives, and one for a rod that does not reach."""
    lines = []
    for motor, linkage in linkages.items():
        for joint, (low, high) in linkage["reduction"].items():
            lines.append(
                f"rod of motor {motor}: reduction {low:.4g} .. {high:.4g} to {joint} over its "
                f"range, {linkage['default'][joint]:.4g} in the default posture"
            )
        if linkage["beyond"]:
            posture = ", ".join(f"{j} {angle:g} deg" for j, angle in linkage["beyond"].items())
            lines.append(f"rod of motor {motor}: does not reach in all postures, not at {posture}")
    return [*lines, ""] if lines else []


def force_lines(analysis: Mapping[str, Any]) -> list[str]:
    """State the largest forces on the floor, or the reasons why there is none.

    Args:
        analysis: as `tree_analysis.analyze_tree` returns it.

    Returns:
        A line a direction that has a force, a line a reason, and one where feet are in the air.
    """
    forces, limb = analysis["contact_force"], _limb(analysis)
    lines = [
        f"largest {direction} force of {limb}, default posture, other components free: "
        f"{force['force']:.4g} N, "
        f"{force['body_weights']:.3g} body weights; at their limit: "
        f"{_at_limit(force) or 'no motor, the floor slips'}"
        for direction, force in forces.items()
        if force["force"] is not None
    ]
    if lines and analysis["hanging_pads"]:
        lines.append(
            f"{pads_text(analysis['hanging_pads'])}; these forces are those of the lowest pads of "
            f"{limb} alone"
        )
    reasons: dict[str, list[str]] = {}
    for direction, force in forces.items():
        if force["force"] is None:
            reasons.setdefault(force["reason"], []).append(direction)
    return lines + [
        f"largest {' and '.join(directions)} force of {limb}: none; {reason}"
        for reason, directions in reasons.items()
    ]


def _at_limit(force: Mapping[str, Any]) -> str:
    """Motors, and joints at their derated torque, that allow no more force."""
    return ", ".join([*force["binding"], *(f"joint {name} (derated)" for name in force["derated"])])
