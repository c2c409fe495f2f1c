import numpy as np
import pytest

from hyperleg_design.gap.signals.filtering import filtered_log, traced


def test_bands_add_up_to_the_energy_below_the_cutoff(signals):
    one = filtered_log(signals)
    wave = np.zeros(len(signals.time))
    inside = one.mask[0]
    rng = np.random.default_rng(0)
    for frequency in (0.3, 0.9, 2.0, 5.0, 8.0):
        wave += np.sin(2 * np.pi * frequency * signals.time + rng.uniform(0, 6)) * inside
    found = one.sample(0, wave[None])[0]
    band, _, _ = one.labels(0)
    total = sum(np.sum(found[band == b] ** 2) / (band == b).sum() for b in np.unique(band))
    known = np.mean(wave[inside] ** 2)
    assert total == pytest.approx(known, rel=0.05)


def test_the_filter_is_linear_and_blind_to_unknown_ticks(signals):
    one = filtered_log(signals)
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, len(signals.time)))
    assert np.allclose(
        one.sample(0, (2 * a - 3 * b)[None]),
        2 * one.sample(0, a[None]) - 3 * one.sample(0, b[None]),
    )
    spoiled = np.where(one.mask[0], a, np.nan)
    assert np.allclose(one.sample(0, spoiled[None]), one.sample(0, a[None]))


def test_noise_above_the_cutoff_does_not_pass(signals):
    one = filtered_log(signals)
    fast = np.sin(2 * np.pi * 70 * signals.time) * np.hanning(len(signals.time))
    assert np.abs(one.sample(0, fast[None])).max() < 0.02


def test_independent_numbers_of_a_band_are_its_bandwidth_times_the_time(signals):
    one = filtered_log(signals)
    band, time, share = one.labels(0)
    span = signals.time[-1] - signals.time[0]
    assert share[band == 0].sum() == pytest.approx(2 * 0.5 * span, rel=0.15)
    assert np.all(np.diff(time[band == 1]) > 0)
    assert share.max() <= 1.0 + 1e-9


def test_rows_that_a_trace_leaves_alone_are_missing(signals):
    one = filtered_log(signals)
    trace = {"motion": np.zeros((1, len(signals.time), 2))}
    trace["motion"][0, :, 1] = 1.0
    assert [one.rows[r].name for r in traced(one, trace)] == ["knee"]
