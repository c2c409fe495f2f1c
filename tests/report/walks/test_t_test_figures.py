"""Speeds along a path, and what the figure of a T-test shows."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.report.walks import t_test_figures


def test_the_speed_of_a_straight_path_is_constant():
    path = np.stack([np.linspace(0, 6, 101), np.linspace(0, 8, 101)], -1)
    assert t_test_figures.speeds(path, 0.05) == pytest.approx(np.full(101, 2.0))


def test_smoothing_keeps_the_mean():
    rng = np.random.default_rng(0)
    way = np.cumsum(1.0 + 0.3 * rng.random(2000)) * 0.02
    path = np.stack([way, 0 * way], -1)
    assert t_test_figures.speeds(path, 0.02).mean() == pytest.approx(
        (way[-1] - way[0]) / (0.02 * 1999), rel=0.01
    )


def test_ways_speed_and_falls_are_drawn(found):
    one = found.of("t_test", "toe")[0]
    fallen = dataclasses.replace(one, outcomes=["arrived", "fell", "arrived"])
    figure = t_test_figures.t_test_figure({"toe": [fallen]}, 0.02)
    layout, panel = figure.axes[:2]
    assert {t.get_text() for t in layout.texts} >= {"A", "B", "C", "D", "1", "2", "3", "4", "5"}
    assert "3 trials, 1 without arrival" in panel.get_title(loc="left")
    ways = [c for c in panel.collections if c.get_array() is not None]
    assert len(ways) == 3
    assert np.median(ways[0].get_array()) == pytest.approx(2.0, rel=0.02)
    below = next(a for a in figure.axes if a.get_xlabel() == "way of the pelvis [m]")
    assert np.median(below.get_lines()[0].get_ydata()) == pytest.approx(2.0, rel=0.02)
