"""Tables and summaries for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from hyperleg_design.robot.names import JOINTS

NARROWEST = 20
"""Characters that the last column of a table keeps in a narrow terminal."""


def table(
    headers: Sequence[str], rows: Iterable[Sequence[object]], width: int | None = None
) -> str:
    """Write aligned columns: texts to the left, numbers to the right.

    Args:
        headers: of the columns.
        rows: of cells.
        width: in characters, to which the texts of the last column are wrapped; not by default.

    Returns:
        The text.
    """
    cells = [[_cell(v) for v in row] for row in rows]
    numeric = (
        [
            all(isinstance(row[i], int | float) or row[i] == "" for row in rows)
            for i in range(len(headers))
        ]
        if isinstance(rows, list)
        else []
    )
    widths = [
        max(len(h), *(len(row[i]) for row in cells)) if cells else len(h)
        for i, h in enumerate(headers)
    ]

    indent = sum(widths[:-1]) + 2 * len(widths[:-1])
    if width is not None:
        widths[-1] = min(widths[-1], max(NARROWEST, width - indent))

    def line(parts: Sequence[str]) -> str:
        aligned = [
            p.rjust(w) if numeric and numeric[i] else p.ljust(w)
            for i, (p, w) in enumerate(zip(parts, widths, strict=True))
        ]
        return "  ".join(aligned).rstrip()

    def lines(parts: Sequence[str]) -> list[str]:
        if len(parts[-1]) <= widths[-1]:
            return [line(parts)]
        first, *more = textwrap.wrap(parts[-1], widths[-1])
        return [line([*parts[:-1], first]), *(" " * indent + text for text in more)]

    body = [part for row in cells for part in lines(row)]
    return "\n".join([line(list(headers)), line(["-" * w for w in widths]), *body])


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e5 else f"{value:.3e}"
    return str(value)


_LIMITS = ("max_torque", "torque_alone", "speed", "reflected_inertia")
"""Entries of `joint_limits` in an analysis."""


def analysis_text(analysis: Mapping[str, Any]) -> str:
    """Write an analysis as a page for a terminal.

    Args:
        analysis: as `analyze` returns it.

    Returns:
        The text.
    """
    masses = ", ".join(f"{k} {v:.3g}" for k, v in analysis["segment_mass"].items())
    printed = ", ".join(f"{j} {v:.4g}" for j, v in analysis["max_joint_torque"].items())
    parts = [
        f"{analysis['design']} ({analysis['variant']}): {analysis['total_mass']:.2f} kg, leg "
        f"{analysis['leg_mass']:.2f} kg, "
        f"leg length {analysis['leg_length']:.3f} m, height {analysis['height']:.4f} m",
        f"segments [kg]: {masses}",
        "",
        table(*joint_table(analysis)),
        joints_note(analysis),
        f"as the paper's Table I prints it, standing and derated [Nm]: {printed}",
        f"reachable torques below the hip fill {100 * analysis['zonotope_to_box_volume']:.1f} % of "
        f"the box that their maxima span",
        "",
        table(*motor_table(analysis)),
    ]
    if analysis["ablation_confound"]:
        parts += [
            "",
            "what taking the toe away takes besides (torques standing, derated):",
            confound_text(analysis["ablation_confound"]),
        ]
    return "\n".join(parts)


def joint_table(analysis: Mapping[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Tabulate what the joints can do.

    Args:
        analysis: as `analyze` returns it, of a design of HyperLeg's family.

    Returns:
        Heads, and a row a joint.
    """
    heads = ["joint", "max torque [Nm]", "alone [Nm]", "speed [rad/s]"]
    heads.append("reflected inertia [kg m^2]")
    limits = analysis["joint_limits"]
    return heads, [[j, *(limits[name][j] for name in _LIMITS)] for j in analysis["joints"]]


def joints_note(analysis: Mapping[str, Any]) -> str:
    """Say what the columns of `joint_table` mean.

    Args:
        analysis: as `analyze` returns it, of a design of HyperLeg's family.

    Returns:
        One line.
    """
    return (
        f"all columns: {analysis['joint_limits']['convention']}; max torque: whatever the others "
        "do; alone: the others at zero torque"
    )


def motor_table(analysis: Mapping[str, Any]) -> tuple[list[str], list[list[Any]]]:
    """Tabulate the motors and gears.

    Args:
        analysis: as `analyze` returns it, of a design of HyperLeg's family.

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


def confound_text(effects: Mapping[str, Any]) -> str:
    """Write the ablations beside each other.

    Args:
        effects: as `confound` returns them, by ablation.

    Returns:
        The text.
    """
    joints = [j for j in JOINTS if j in ("knee", "ankle_pitch", "ankle_roll", "toe")]
    rows = [
        [
            name,
            v["total_mass"],
            2 * v["motors"],
            *(v["max_joint_torque"].get(j, "") for j in joints),
            v["removes"],
        ]
        for name, v in effects.items()
    ]
    return table(
        ["variant", "mass [kg]", "motors", *(f"{j} [Nm]" for j in joints), "what it is"], rows
    )
