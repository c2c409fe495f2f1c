"""Products of columns that only some channels show, against dense algebra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.crossing import Crossing
from tests.gap.inference.channels.test_channel import SCALES, dense, made

OTHER = replace(SCALES, noise=SCALES.noise[::-1].copy(), standing=-0.7, change=0.2)
COLUMNS = 4


@pytest.fixture(scope="module")
def channels():
    """Two channels, one after the other among the samples, and a silent third."""
    found, first = [], 0
    for seed in range(3):
        channel, _ = made(np.random.default_rng(seed), count=20)
        places = tuple(first + place for place in channel.places)
        first += len(channel.samples)
        found.append(replace(channel, places=places))
    return found


@pytest.fixture(scope="module")
def columns(channels):
    """Of which one shows in the first channel only, two in the second only, one in both."""
    found = np.random.default_rng(7).standard_normal(
        (COLUMNS, sum(len(c.samples) for c in channels))
    )
    found[0, channels[1].samples] = 0.0
    found[1:3, channels[0].samples] = 0.0
    found[:, channels[2].samples] = 0.0
    return found


def test_columns_count_where_they_are_anything(channels, columns):
    crossing = Crossing.of(channels, columns)
    assert [one.tolist() for one in crossing.shown] == [[0, 3], [1, 2, 3], []]
    assert crossing.count == COLUMNS


def test_products_are_those_in_the_metric_of_all_channels_covariance(channels, columns):
    found = Crossing.of(channels, columns).reduced(channels, [SCALES, OTHER, SCALES])
    expected = np.zeros((COLUMNS + 1,) * 2)
    for channel, scales in zip(channels, (SCALES, OTHER, SCALES), strict=True):
        value = np.concatenate([one[-1] for one in channel.whitened])
        rows = np.concatenate([value[None], columns[:, np.concatenate(channel.places)]])
        expected += rows @ np.linalg.solve(dense(channel, scales), rows.T)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9)


def test_order_and_mixture_of_columns_carry_over(channels, columns):
    scales = [SCALES, OTHER, SCALES]
    mixture = np.random.default_rng(3).standard_normal((2, COLUMNS))
    whole = Crossing.of(channels, columns).reduced(channels, scales)
    mixed = Crossing.of(channels, mixture @ columns).reduced(channels, scales)
    turn = np.block([[np.eye(1), np.zeros((1, COLUMNS))], [np.zeros((2, 1)), mixture]])
    np.testing.assert_allclose(mixed, turn @ whole @ turn.T, atol=1e-9)


def test_what_is_left_is_the_residual_without_the_trace(channels, columns):
    theta = np.array([0.4, -1.0, 2.0, 0.3])
    left = Crossing.of(channels, columns).left(channels, theta)
    for channel, own in zip(channels, left, strict=True):
        expected = channel.without(theta @ columns).whole_residual
        np.testing.assert_allclose(own.cross, expected.cross, atol=1e-9)
        np.testing.assert_allclose(own.square, expected.square, rtol=1e-9)


def test_no_columns_leave_all_of_the_residual(channels):
    nothing = np.zeros((0, sum(len(c.samples) for c in channels)))
    crossing = Crossing.of(channels, nothing)
    (alone,) = crossing.reduced(channels, [SCALES] * 3)
    expected = sum(channel.reduced(SCALES)[0, 0] for channel in channels)
    assert alone == pytest.approx(expected)
    for channel, own in zip(channels, crossing.left(channels, np.zeros(0)), strict=True):
        assert own is channel.whole_residual


def test_products_of_further_columns_join_the_first_ones(channels, columns):
    scales = [SCALES, OTHER, SCALES]
    whole = Crossing.of(channels, columns)
    dropped = np.concatenate([columns[:2], columns[-1:]])  # the last one is not among the first two
    joined = Crossing.of(channels, dropped).extended(channels, columns[:2], columns[2:])
    assert joined.count == whole.count
    np.testing.assert_allclose(
        joined.reduced(channels, scales), whole.reduced(channels, scales), rtol=1e-12, atol=1e-12
    )
    for one, other in zip(joined.shown, whole.shown, strict=True):
        assert one.tolist() == other.tolist()
