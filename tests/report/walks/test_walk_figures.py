"""Figures of walks show the powers, forces and torques that were recorded."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.power import GROUPS
from hyperleg_design.report.walks import walk_figures


def curve(axes, label):
    return next(line for line in axes.get_lines() if line.get_label() == label).get_ydata()


def test_power_over_the_cycle_is_the_mean_of_the_strides_and_adds_up(found):
    walks = {d: found.of("walk", d) for d in found.designs("walk")}
    figure = walk_figures.cycle_power_figure(walks)
    upper, _, lower, _ = figure.axes
    cycle = walks["toe"][0].cycles[0]
    assert curve(upper, "toe") == pytest.approx(cycle.of_group("toe").mean(0), abs=1e-6)
    work = sum(curve(upper, group) for group in GROUPS)
    assert curve(lower, "mechanical") == pytest.approx(work, abs=1e-6)
    assert curve(lower, "total") == pytest.approx(
        curve(lower, "mechanical") + curve(lower, "Joule heat"), abs=1e-6
    )
    assert "toe" not in [
        line.get_label() for line in figure.axes[1].get_lines()
    ]  # the removed toe has no power


def test_walks_without_a_steady_stride_leave_a_panel_that_says_so(found):
    import dataclasses

    none = [dataclasses.replace(e, cycles=[None] * 3) for e in found.of("walk", "toe")]
    figure = walk_figures.cycle_power_figure({"toe": none})
    assert [t.get_text() for t in figure.axes[0].texts] == ["no steady stride"]


def test_impacts_stand_over_stiffness(found):
    figure = walk_figures.impact_band_figure(found.band, {0.01: 20e3, 0.02: 5e3})
    (line, _) = figure.axes[0].get_lines()
    assert line.get_xdata() == pytest.approx([20.0, 5.0])
    expected = np.nanmean([e.values("grf_peak_body_weights")[0] for e in found.band["toe"][0.01]])
    assert line.get_ydata()[0] == pytest.approx(expected, rel=0.02)


def test_operating_points_lie_in_their_envelopes(found):
    trials = {d: found.shown("walk", d) for d in found.designs("walk")}
    figure = walk_figures.operating_points_figure(trials)
    titles = [axes.get_title() for axes in figure.axes if axes.get_title()]
    assert len(titles) == 7
    assert len(figure.axes[titles.index("toe")].collections) == 1  # one robot has the motor
    assert len(figure.axes[titles.index("knee")].collections) == 2
    trial = trials["toe"]
    knee = figure.axes[titles.index("knee")].collections[0].get_offsets()
    index = trial.layout.motors.index("left_knee")
    assert np.abs(np.asarray(knee)[:, 1]).max() <= np.abs(trial.motor_torque).max() + 1e-9
    assert np.asarray(knee)[0] == pytest.approx(
        [trial.motor_velocity[0, index], trial.motor_torque[0, index]]
    )
