from __future__ import annotations

import pytest

from hyperleg_design.report.walks.learning_figures import SHOWN, learning_figure


def test_a_line_a_training_a_row_a_group(found):
    figure = learning_figure([p for p in found.policies if p.group == "walk"])
    assert len(figure.axes) == len(SHOWN)
    speed = figure.axes[0]
    assert len(speed.get_lines()) == 6
    assert speed.get_lines()[0].get_ydata() == pytest.approx([0.1 * k for k in range(11)])
    assert speed.get_lines()[0].get_xdata() == pytest.approx([0.001 * k for k in range(11)])
    assert (
        len(figure.axes[2].get_lines()[0].get_ydata()) == 0
    )  # nothing on cost of transport was recorded


def test_an_assist_is_drawn_where_a_training_had_one(found, monkeypatch):
    from hyperleg_design.report.walks import learning_figures

    rows = [{"steps": 1000 * k, "speed": 1.0, "assist": 0.0} for k in range(11)]
    monkeypatch.setattr(learning_figures, "learning_curve", lambda _: rows)
    figure = learning_figure([p for p in found.policies if p.group == "walk"])
    assert [axes.get_title() for axes in figure.axes] == [title for _, title in SHOWN[:-1]]
