import dataclasses

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.signals.filtering import (
    UNDERWAY,
    filtered_log,
    moving,
    moving_ticks,
    sticking,
    traced,
    travelled,
)
from hyperleg_design.gap.signals.sliding import presliding


@pytest.fixture(scope="module")
def signals(robot_files):
    return diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]


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


def test_a_joint_at_rest_may_stick_and_a_moving_one_does_not(signals):
    found = sticking(signals)
    fast = np.abs(signals.velocity) > 0.2
    assert not np.any(found & fast)
    first = np.all(np.abs(signals.velocity[:5]) < 1e-2)
    assert not first or found[2].all()


def test_a_joint_that_creeps_may_stick_unless_it_follows_a_slow_target_or_comes_far(signals):
    slow = 0.05 * signals.time[:, None] * np.ones(2)
    creeps = dataclasses.replace(
        signals, position=slow, velocity=np.full_like(slow, 0.05), limit_cycle=None
    )
    assert not sticking(dataclasses.replace(creeps, target=slow + 0.01))[20:-20].any()
    astray = dataclasses.replace(creeps, target=np.ones_like(slow))
    far = slow > UNDERWAY * presliding(astray)
    assert sticking(astray)[~far].all()
    assert not sticking(astray)[far][20:].any()
    assert sticking(dataclasses.replace(astray, measured=None)).all()
    swing = 0.002 * np.sin(25 * signals.time)[:, None] * np.ones(2)  # to and fro at the same speed
    assert sticking(
        dataclasses.replace(
            astray, position=swing, velocity=np.gradient(swing, signals.step, axis=0)
        )
    ).all()
    assert not sticking(dataclasses.replace(creeps, target=None))[20:-20].any()


def test_way_begins_anew_at_rest_and_at_each_return():
    position = np.array([0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 1.0, 2.0])[:, None]
    rest = np.zeros_like(position, bool)
    assert travelled(position, rest)[:, 0].tolist() == [0, 1, 2, 3, 0, -1, -1, 0]
    rest[2] = True
    assert travelled(position, rest)[:, 0].tolist() == [0, 1, 0, 1, 0, -1, -1, 0]


def test_the_rest_of_a_joint_that_hardly_moves_counts_only_without_dry_friction(signals):
    known, resting, step = np.ones(1000, bool), np.arange(1000) >= 50, 0.005
    assert moving(known, resting, step, rubs=False).all()
    np.testing.assert_array_equal(moving(known, resting, step, rubs=True), ~resting)
    # a tenth of the time, in pieces of 0.1 s: too short to be told from what smoothing leaves
    pieces = np.arange(1000) % 200 >= 20
    assert not moving(known, pieces, step, rubs=True).any()
    np.testing.assert_array_equal(moving(known, pieces, step, rubs=False), ~pieces)
    half = np.arange(1000) % 40 >= 20
    for rubs in (False, True):
        np.testing.assert_array_equal(moving(known, half, step, rubs=rubs), ~half)

    still = np.ones_like(signals.position, bool)
    still[:50] = False
    dry = dataclasses.replace(
        signals, subject=dataclasses.replace(signals.subject, coulomb=np.array([0.0, 1.0]))
    )
    one = filtered_log(dry, still)
    mask = {
        row.name: m
        for row, m in zip(one.rows, one.mask, strict=True)
        if row.residual_name == "motion"
    }
    assert mask["hip"][60:].any()
    assert "knee" not in mask or not mask["knee"][50:].any()
    every = moving_ticks(dry, np.ones_like(still), still)
    assert every[:, 0].all()
    np.testing.assert_array_equal(every[:, 1], ~still[:, 1])


def test_rows_that_a_trace_leaves_alone_are_missing(signals):
    one = filtered_log(signals)
    trace = {"motion": np.zeros((1, len(signals.time), 2))}
    trace["motion"][0, :, 1] = 1.0
    assert [one.rows[r].name for r in traced(one, trace)] == ["knee"]
