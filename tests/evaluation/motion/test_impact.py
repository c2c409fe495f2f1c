"""Impacts of forces whose peak, slope and integral are known."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.motion.impact import impacts, low_pass

STEP = 0.001


def test_a_ramp_gives_peak_slope_and_impulse():
    force = np.r_[np.zeros(100), np.linspace(0, 800, 41), np.full(200, 800.0)]  # 800 N in 40 ms
    found = impacts(force, force, [100], STEP, 0.05)
    assert found.peak == pytest.approx([800])
    assert found.raw_peak == pytest.approx([800])
    assert found.loading_rate == pytest.approx([20_000], rel=1e-9)
    assert found.impulse == pytest.approx([0.5 * 800 * 0.04 + 800 * 0.01])


def test_only_the_window_counts():
    force = np.r_[np.zeros(50), np.full(30, 400.0), np.full(100, 900.0)]
    assert impacts(force, force, [50], STEP, 0.02).peak == pytest.approx([400])
    assert impacts(force, force, [50], STEP, 0.05).peak == pytest.approx([900])


def test_a_window_that_the_record_does_not_hold_is_not_measured():
    force = np.r_[np.zeros(50), np.full(30, 400.0)]
    found = impacts(force, force, [50], STEP, 0.05)
    assert np.isnan([found.peak, found.loading_rate, found.impulse]).all()


@pytest.mark.parametrize("order", [2, 4, 8])
def test_the_filter_halves_its_cutoff_keeps_slow_parts_and_does_not_delay(order):
    time = np.arange(4000) * STEP
    slow, at_cutoff = np.sin(2 * np.pi * 2 * time), np.sin(2 * np.pi * 50 * time)
    middle = slice(1000, 3000)
    kept = low_pass(slow, STEP, 50, order)
    assert np.max(np.abs(kept - slow)[middle]) < 0.01
    assert np.sqrt(2 * np.mean(low_pass(at_cutoff, STEP, 50, order)[middle] ** 2)) == pytest.approx(
        0.5, abs=0.01
    )


def test_no_filter_changes_nothing_and_columns_are_filtered_alone():
    force = np.random.default_rng(0).uniform(size=(100, 2))
    assert np.array_equal(low_pass(force, 0.005, 0, 4), force)
    both = low_pass(force, 0.005, 50, 4)
    assert both[:, 1] == pytest.approx(low_pass(force[:, 1], 0.005, 50, 4))


def test_a_cutoff_past_half_the_sampling_rate_is_refused():
    with pytest.raises(InputError, match="100 Hz"):
        low_pass(np.zeros(50), 0.005, 120, 4)
