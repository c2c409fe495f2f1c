"""Gait events and measures on square waves and paths whose answers are known by construction."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.evaluation.motion import gait

STEP = 0.005


def square_feet(period, stance, strides, offset=0.5, begin=10):
    """Contacts of two feet, the right `offset` of a period behind; both start in the air."""
    samples = begin + period * strides + round(offset * period) + 5
    feet = np.zeros((samples, 2), bool)
    for foot, shift in ((0, 0), (1, round(offset * period))):
        for k in range(strides):
            down = begin + shift + k * period
            feet[down : down + stance, foot] = True
    return feet


@given(period=st.integers(60, 240), duty=st.floats(0.3, 0.8), strides=st.integers(3, 8))
@settings(max_examples=30)
def test_a_square_wave_gives_back_its_own_numbers(period, duty, strides):
    period -= period % 2
    stance = round(duty * period)
    feet = square_feet(period, stance, strides)
    steps = gait.find_steps(feet, feet, feet, STEP)
    assert len(steps) == 2 * strides
    assert steps.foot.tolist() == [0, 1] * strides
    assert np.array_equal(np.diff(steps.touchdown), np.full(2 * strides - 1, period // 2))
    assert gait.cadence(steps, STEP) == pytest.approx(2 / (period * STEP))
    assert gait.alternation(steps) == 1
    assert gait.event_shares(steps)["duty_factor"] == pytest.approx(stance / period)
    window = gait.whole_strides(steps, 0, len(feet))
    assert window == (10, 10 + period * (strides - 1))
    inner = slice(10 + period, 10 + 2 * period)
    shares = gait.support_shares(feet[inner])
    assert shares["double_support"] == pytest.approx(max(0.0, 2 * stance / period - 1), abs=1e-12)
    assert shares["flight"] == pytest.approx(max(0.0, 1 - 2 * stance / period), abs=1e-12)
    assert sum(shares.values()) == pytest.approx(1)


def test_hysteresis_waits_for_the_second_threshold():
    load = np.array([0, 3, 6, 3, 3, 1, 3, 0, 6, 1.0])
    assert gait.stance(load, 5, 2).astype(int).tolist() == [0, 0, 1, 1, 1, 0, 0, 0, 1, 0]


def test_hysteresis_never_chatters_between_its_thresholds():
    rng = np.random.default_rng(0)
    ramp = np.concatenate([np.linspace(0, 10, 200), np.linspace(10, 0, 200)])
    noisy = ramp + rng.uniform(-0.9, 0.9, len(ramp))
    found = gait.stance(noisy, 4, 2)
    assert np.sum(np.diff(found.astype(int)) == 1) == 1
    single = noisy > 3
    assert np.sum(np.diff(single.astype(int)) == 1) > 1


def test_short_contacts_and_gaps_are_not_counted():
    load = np.r_[
        np.zeros(20),
        np.full(3, 9),
        np.zeros(20),
        np.full(30, 9),
        np.zeros(2),
        np.full(30, 9),
        np.zeros(20),
    ]
    found = gait.stance(load, 5, 2, shortest=5)
    assert np.flatnonzero(np.diff(found.astype(int))).tolist() == [42, 104]


def test_columns_are_treated_alone():
    rng = np.random.default_rng(1)
    load = rng.uniform(0, 10, (300, 2, 3))
    together = gait.stance(load, 7, 3, 3)
    for i in np.ndindex(2, 3):
        assert np.array_equal(
            together[(slice(None), *i)], gait.stance(load[(slice(None), *i)], 7, 3, 3)
        )


@pytest.mark.parametrize(("heel_first", "expected"), [(4, 0.02), (0, 0.0), (-6, -0.03)])
def test_heel_lead_tells_heel_flat_and_toe_landing(heel_first, expected):
    feet, heel, fore = (np.zeros((100, 2), bool) for _ in range(3))
    feet[20:80, 0] = True
    heel[20 + max(0, -heel_first) : 50, 0] = True
    fore[20 + max(0, heel_first) : 80, 0] = True
    steps = gait.find_steps(feet, heel, fore, STEP)
    assert steps.heel_lead == pytest.approx([expected])
    assert (steps.touchdown, steps.heel_off, steps.toe_off) == ([20], [50], [80])


def test_a_contact_that_lasts_to_the_end_has_no_toe_off():
    feet = np.zeros((50, 2), bool)
    feet[30:, 1] = True
    steps = gait.find_steps(feet, feet, feet, STEP)
    assert steps.toe_off.tolist() == [-1]
    slip = gait.slip_per_step(steps, np.ones((50, 2)), np.ones((50, 2)), np.array([0, 1]), STEP)
    assert np.isnan(slip).all()


def test_a_foot_down_from_the_start_has_no_touchdown():
    feet = np.ones((50, 2), bool)
    assert len(gait.find_steps(feet, feet, feet, STEP)) == 0
    assert np.isnan(gait.cadence(gait.find_steps(feet, feet, feet, STEP), STEP))


def test_hopping_on_one_leg_does_not_alternate():
    feet = square_feet(100, 40, 5)
    feet[:, 1] = False
    assert gait.alternation(gait.find_steps(feet, feet, feet, STEP)) == 0


@pytest.mark.parametrize("angle", [0.0, 0.7, -2.4])
def test_step_length_and_width_in_any_direction(angle):
    feet = square_feet(100, 60, 6)
    steps = gait.find_steps(feet, feet, feet, STEP)
    ahead = np.arange(len(steps)) * 0.6
    aside = np.where(steps.foot == 0, 0.1, -0.1)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    length, width = gait.step_vectors(steps, np.column_stack([ahead, aside]) @ turn.T + [5, 7])
    assert length == pytest.approx(np.full(len(steps) - 2, 0.6))
    assert width == pytest.approx(np.full(len(steps) - 2, 0.2))


def test_slip_is_speed_times_time_weighted_by_load():
    feet = np.zeros((200, 2), bool)
    feet[50:150, 0] = True
    steps = gait.find_steps(feet, feet, feet, STEP)
    load, slip = np.zeros((200, 4)), np.zeros((200, 4))
    load[50:151, 0], load[50:151, 1] = 300.0, 100.0
    slip[51:151, 0], slip[51:151, 1] = 0.02, 0.06
    slip[50, :2] = 5.0  # with which it meets the floor
    slip[:, 2:] = 9.0  # the other foot's
    found = gait.slip_per_step(steps, load, slip, np.array([0, 0, 1, 1]), STEP)
    assert found == pytest.approx([100 * STEP * 0.03])


def test_cycles_bring_strides_of_any_length_to_one_scale():
    lengths = [100, 140, 80]
    feet = np.zeros((sum(lengths) + 60, 2), bool)
    phase, at = np.zeros(len(feet)), 20
    for length in [*lengths, 30]:
        feet[at : at + length // 2, 1] = True
        stop = min(at + length, len(phase))
        phase[at:stop] = np.arange(stop - at) / length
        at += length
    steps = gait.find_steps(feet, feet, feet, STEP)
    wave = np.column_stack([np.sin(2 * np.pi * phase), np.cos(2 * np.pi * phase)])
    found = gait.cycles(wave, steps, foot=1)
    assert found.shape == (3, 101, 2)
    share = np.linspace(0, 2 * np.pi, 101)
    assert np.max(np.abs(found - np.column_stack([np.sin(share), np.cos(share)]))) < 2e-3
    assert gait.cycles(wave, steps, foot=0).shape == (0, 101, 2)
