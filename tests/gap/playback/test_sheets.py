"""Residuals by frequency band against signals whose spectrum is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hyperleg_design.gap.playback.sheets import (
    BAND,
    BANDS,
    regime_names,
    regime_values,
    root_mean_square,
    sheets_of,
)
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def signals(robot_files, runs):
    log = runs["pendulum"]
    return condition(log, load_subject(robot_files["pendulum"], [log]))


def torque_sheet(signals, residual):
    """Sheet of the torque whose residual is `(t,)`."""
    changed = replace(signals, residual={"motion": residual[:, None]}, valid=np.isfinite(residual))
    return sheets_of(changed, False)["torque", "joint"]


def name(low, top):
    return f"{low:g}-{top:g} Hz"


@given(arrays(float, (7, 2), elements=st.one_of(st.floats(-1e3, 1e3), st.just(np.nan))))
@settings(max_examples=50)
def test_root_mean_square_is_that_of_known_ticks(values):
    found = root_mean_square(values)
    for column, one in zip(values.T, found, strict=True):
        known = column[~np.isnan(column)]
        if len(known):
            assert one == pytest.approx(np.linalg.norm(known) / np.sqrt(len(known)))
        else:
            assert np.isnan(one)


@pytest.mark.parametrize(("frequency", "band"), [(0.5, 0), (2.0, 1), (5.0, 2), (15.0, 3)])
def test_a_sine_lies_in_its_band_alone(signals, frequency, band):
    count = len(signals.time) // 200 * 200  # whole periods
    residual = np.where(
        np.arange(len(signals.time)) < count, np.sin(2 * np.pi * frequency * signals.time), 0.0
    )
    sheet = torque_sheet(signals, residual)
    size = root_mean_square(residual[:, None])[0]
    for place, (low, top) in enumerate(BANDS):
        share = root_mean_square(sheet.bands[name(low, top)])[0] / size
        assert share == pytest.approx(float(place == band), abs=0.1)
    assert root_mean_square(sheet.residual)[0] / size == pytest.approx(
        float(frequency < BAND), abs=0.1
    )


def test_bands_add_up_to_the_residual_below_the_band(signals):
    residual = np.random.default_rng(0).standard_normal(len(signals.time))
    sheet = torque_sheet(signals, residual)
    parts = [sheet.bands[name(low, top)] for low, top in BANDS if top <= BAND]
    np.testing.assert_allclose(sum(parts), sheet.residual, atol=1e-9)
    squares = [np.sum(part**2) for part in parts]
    assert sum(squares) == pytest.approx(np.sum(sheet.residual**2), rel=1e-9)


@pytest.mark.parametrize("known", [1.0, 0.6])
def test_the_floor_is_the_size_of_noise_that_is_the_same_at_all_frequencies(signals, known):
    rng = np.random.default_rng(1)
    residual = 0.3 * rng.standard_normal(len(signals.time))
    residual[round(known * len(residual)) :] = np.nan
    sheet = torque_sheet(signals, residual)
    assert root_mean_square(sheet.residual)[0] == pytest.approx(sheet.floor[0], rel=0.15)
    np.testing.assert_array_equal(np.isnan(sheet.residual[:, 0]), np.isnan(residual))


def test_regimes_are_parts_of_the_residual(signals):
    sheet = torque_sheet(signals, np.cos(signals.time))
    names = regime_names([sheet, sheet])
    assert names[0] == "all"
    assert len(set(names)) == len(names) > len(BANDS)
    assert set(sheet.regimes) | set(sheet.bands) | {"all"} == set(names)
    for regime in sheet.regimes:
        found = regime_values(sheet, regime)
        np.testing.assert_array_equal(np.isfinite(found), sheet.regimes[regime])
        inside = np.isfinite(found)
        np.testing.assert_array_equal(found[inside], sheet.residual[inside])
    assert regime_values(sheet, "all") is sheet.residual
    assert np.isnan(regime_values(sheet, "of another robot")).all()


def test_predictions_of_a_robot_without_a_gap_leave_little(signals):
    found = sheets_of(signals, True)
    assert {("torque", "joint"), ("position", "joint"), ("velocity", "joint")} <= set(found)
    for quantity in ("position", "velocity"):
        sheet = found[quantity, "joint"]
        assert sheet.units == ({"position": "rad", "velocity": "rad/s"}[quantity],)
        assert sheet.bands == {}
        assert root_mean_square(sheet.residual)[0] < 0.01 * sheet.size[0]
