"""Masses beside each other: parts of both families in one table."""

from __future__ import annotations

from hyperleg_design.report.viewer.masses import masses_text
from hyperleg_design.robot.load import load_robot


def test_a_biped_and_a_leg_share_a_table_and_parts_add_up():
    designs = {"biped": load_robot("hyperleg"), "leg": load_robot("teaching_leg")}
    head, rule, *rows = (line.strip("| ").split("|") for line in masses_text(designs).splitlines())
    assert [cell.strip() for cell in head] == ["mass [kg]", "biped", "leg"]
    assert [cell.strip() for cell in rule] == ["---", "---:", "---:"]
    cells = {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows}
    assert cells["**robot**"] == ["32.000", "2.550"]
    leg = sum(float(cells[part][1]) for part in ("stand", "thigh", "shank"))
    assert round(leg, 3) == 2.55
    assert "thigh" in cells
