"""Masses of several designs beside each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

from hyperleg_design.robot.masses import mass_table
from hyperleg_design.robot.names import SEGMENTS
from hyperleg_design.robot.trees import limb_masses
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg


def masses_text(designs: Mapping[str, RobotDesign]) -> str:
    """Write the masses of some designs beside each other, as a Markdown table [kg].

    Args:
        designs: one robot each, by label.

    Returns:
        The table.
    """
    columns = {label: _masses(design) for label, design in designs.items()}
    rows = list(dict.fromkeys(name for column in columns.values() for name in column))
    head = ["mass [kg]", *columns]
    lines = [head, ["---", *["---:"] * len(columns)]]
    for name in rows:
        cells = (column.get(name) for column in columns.values())
        lines.append([name, *("" if cell is None else f"{cell:.3f}" for cell in cells)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _masses(design: RobotDesign) -> dict[str, float]:
    if isinstance(design, TreeDesign):
        table = limb_masses.limb_masses(design)
        links = {name.replace("_", " "): float(body.mass) for name, body in table.links.items()}
        return links | {"one limb": float(table.limb), "**robot**": float(table.total)}
    own = mass_table(cast("HyperLeg", design))
    parts = {name: float(getattr(own, name)) for name in SEGMENTS}
    return parts | {"one leg": float(own.leg), "**robot**": float(own.total)}
