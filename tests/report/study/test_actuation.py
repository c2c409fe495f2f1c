"""The part of the study on cooperative actuation shows the printed matrices."""

from __future__ import annotations

from hyperleg_design.report.drawer import FIGURES
from hyperleg_design.report.page import Table
from hyperleg_design.report.study import actuation
from hyperleg_design.report.study.context import Context
from hyperleg_design.robot.ablation import variants
from hyperleg_design.robot.design import load_design


def test_printed_matrices_are_on_the_page(tmp_path):
    (tmp_path / FIGURES).mkdir()
    design = load_design("hyperleg")
    made = actuation.cooperative_actuation(Context(design, variants(design), tmp_path))
    tables = [c for c in made.section.content if isinstance(c, Table)]
    assert tables[0].rows[3][1:] == [0, 0, 0, -31.11, -31.11, -31.11, -31.11]
    assert tables[2].rows[3][6] == 0  # knee and ankle roll: left and right ankle motors cancel
