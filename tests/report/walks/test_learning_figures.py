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
