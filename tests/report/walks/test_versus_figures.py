from __future__ import annotations

import pytest

from hyperleg_design.evaluation.attribution import attribute
from hyperleg_design.report.walks.beside_paper import rows_beside_paper
from hyperleg_design.report.walks.versus_figures import WIDEST, attribution_figure, change_figure


def test_changes_stand_beside_the_papers(found):
    rows = rows_beside_paper(found)["Table III, walk"]
    axes = change_figure({"Table III": rows}).axes[0]
    paper = [line for line in axes.get_lines() if line.get_marker() == "D"]
    ours = [line for line in axes.get_lines() if line.get_marker() == "o"]
    assert [line.get_xdata()[0] for line in paper] == pytest.approx(
        [100 * row.printed.change for row in rows]
    )
    assert ours[0].get_xdata()[0] == pytest.approx(100 * rows[0].difference.relative)
    assert axes.get_yticklabels()[0].get_text() == "total power"


def test_steps_of_the_ladder_are_drawn_and_wide_intervals_are_cut():
    groups = {
        "toe": [[10.0, 10.1], [9.9, 10.0]],
        "toe_locked": [[11.0, 11.1], [10.9, 11.0]],
        "toe_removed": [[2.0, 40.0], [30.0, 1.0]],
    }
    shares = attribute(groups)
    axes = attribution_figure({"power": shares}).axes[0]
    points = [
        line.get_xdata()[0]
        for line in axes.get_lines()
        if line.get_marker() == "o" and len(line.get_xdata())
    ]
    assert points == pytest.approx([100 * s.change.relative for s in shares])
    low, high = axes.get_xlim()
    assert -WIDEST <= low < high <= WIDEST
