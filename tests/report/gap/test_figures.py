from __future__ import annotations

import numpy as np

from hyperleg_design.gap.playback.evidence import Evidence
from hyperleg_design.report.gap import figures as gap_figures

UNITS = ("Nm", "N"), ("rad/s", "m/s")


def test_traces_show_the_row_with_the_largest_gap() -> None:
    time = np.arange(2000) * 0.005
    before = np.column_stack([0.1 * np.sin(time), 2.0 * np.sin(3 * time)])
    shown = Evidence(
        "run", "motion", ("small", "large"), time, before, 0.5 * before, np.cos(before), *UNITS
    )
    figure = gap_figures.time_figure(shown)
    assert figure.axes[0].get_title() == "large, run"
    assert figure.axes[0].get_ylabel() == "force [N]"
    measured, predicted, left = (line.get_ydata() for line in figure.axes[0].lines)
    np.testing.assert_allclose(np.asarray(predicted) + np.asarray(left), measured)


def test_the_same_row_is_shown_over_its_speed() -> None:
    time = np.arange(400) * 0.005
    before = np.column_stack([np.zeros(400), np.sin(3 * time)])
    shown = Evidence("run", "motion", ("a", "b"), time, before, 0 * before, np.cos(before), *UNITS)
    (panel,) = gap_figures.speed_figure(shown).axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("speed [m/s]", "force [N]")
    (line,) = panel.lines
    np.testing.assert_allclose(line.get_xdata(), np.cos(before[:, 1]))
    np.testing.assert_allclose(line.get_ydata(), before[:, 1])
