"""Sums of products over the cells of a channel, against dense algebra."""

from __future__ import annotations

import numpy as np

from tests.gap.inference.channels.test_channel import SCALES, made


def test_products_between_columns_are_summed_over_the_noise():
    rng = np.random.default_rng(14)
    channel, _ = made(rng)
    some = rng.standard_normal((2, len(channel.samples)))
    others = [rng.standard_normal((n, len(channel.samples))) for n in (1, 3)]
    noise = np.concatenate(
        [
            np.full(len(place), SCALES.noise[band])
            for place, band in zip(channel.places, channel.band, strict=True)
        ]
    )
    expected = (some / noise) @ np.concatenate(others).T
    np.testing.assert_allclose(
        channel.between(channel.over_noise(SCALES.noise, some), others), expected, atol=1e-9
    )


def test_some_columns_are_multiplied_as_all_are():
    rng = np.random.default_rng(15)
    channel, _ = made(rng)
    columns = rng.standard_normal((5, len(channel.samples)))
    columns[3, channel.places[1]] = 0.0
    some, rest = np.array([1, 3]), np.array([0, 2, 4])
    cross, own = channel.crossed(columns)
    cross_of_some, own_of_some = channel.crossed(columns, some)
    np.testing.assert_allclose(cross_of_some, cross[:, :, some], atol=1e-12)
    np.testing.assert_allclose(own_of_some, own[:, some][:, :, some], atol=1e-12)
    beside = channel.crossed_with(columns, some, columns, rest)
    np.testing.assert_allclose(beside, own[:, some][:, :, rest], atol=1e-12)


def test_columns_that_are_zero_in_a_channel_do_not_show_there():
    channel, _ = made(np.random.default_rng(16))
    columns = np.zeros((3, len(channel.samples) + 4))
    columns[1, channel.places[2][3]] = 1e-9
    columns[2, -1] = 1.0
    assert channel.shows(columns).tolist() == [False, True, False]
