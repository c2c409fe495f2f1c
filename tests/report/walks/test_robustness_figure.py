"""Curves of robustness: a panel a measure and condition, a line a layout, through its points."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.robustness import CONDITIONS, CurvePoint
from hyperleg_design.evaluation.statistics import estimate
from hyperleg_design.report.walks.robustness_figure import robustness_figure

CHOSEN = ("push", "slope")
VARIANTS = ("toe", "toe_locked")


@pytest.fixture(scope="module")
def points():
    """Costs that are the level, plus one with the toe locked."""
    return [
        CurvePoint(name, level, variant, measure, estimate([[np.array([shift + level] * 3)]] * 2))
        for name in CHOSEN
        for level in CONDITIONS[name].levels
        for shift, variant in enumerate(VARIANTS)
        for measure in ("arrived", "steady_cost_of_transport")
    ]


def test_panels_are_measures_by_conditions(points):
    figure = robustness_figure(points)
    assert len(figure.axes) == 4
    assert [axes.get_xlabel() for axes in figure.axes[2:]] == [CONDITIONS[c].label for c in CHOSEN]
    assert figure.axes[0].get_ylabel() == "share that arrived"
    assert figure.axes[0].get_ylim() == pytest.approx((-0.03, 1.03))


def test_lines_go_through_the_means(points):
    axes = robustness_figure(points).axes[3]
    assert [line.get_label() for line in axes.get_lines()] == ["toe", "toe locked"]
    for shift, line in enumerate(axes.get_lines()):
        np.testing.assert_allclose(line.get_xdata(), CONDITIONS["slope"].levels)
        np.testing.assert_allclose(line.get_ydata(), line.get_xdata() + shift)
