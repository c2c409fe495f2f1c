"""Curves of robustness in a terminal."""

from __future__ import annotations

from hyperleg_design.report.walks.robustness_text import robustness_text


def point(level, measure, mean, low=None, high=None):
    return {
        "condition": "slope",
        "level": level,
        "variant": "toe",
        "measure": measure,
        "mean": mean,
        "low": low,
        "high": high,
    }


def test_each_level_is_a_row_with_intervals_and_units():
    points = [
        point(0.0, "arrived", 1.0, 0.7, 1.0),
        point(0.0, "steady_speed", 1.3),
        point(6.0, "arrived", 0.0, 0.0, 0.3),
        point(6.0, "steady_speed", None),
    ]
    head, _, flat, steep = robustness_text(points).splitlines()
    assert "arrived [-]" in head
    assert "steady_speed [m/s]" in head
    assert "1 (0.7 .. 1)" in flat
    assert flat.endswith("1.3")
    assert "slope, uphill positive [deg]" in steep
    assert steep.endswith("0 (0 .. 0.3)")
