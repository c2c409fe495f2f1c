from __future__ import annotations

import itertools

import numpy as np
import pytest

from hyperleg_design.simulation.stepping.partition import CHUNK, SMALLEST_SPLIT, partition


def draws(parts):
    return np.concatenate([part.streams().uniform(size=part.end - part.first) for part in parts])


@pytest.mark.parametrize("simulations", [1, SMALLEST_SPLIT - 1, SMALLEST_SPLIT, 700, 3 * CHUNK])
def test_parts_hold_every_simulation_once_and_no_more_than_a_chunk(simulations):
    parts = partition(simulations, 0, threads=4)
    assert parts[0].first == 0
    assert parts[-1].end == simulations
    assert all(a.end == b.first for a, b in itertools.pairwise(parts))
    assert all(0 < part.end - part.first <= CHUNK for part in parts)


def test_random_numbers_do_not_depend_on_threads():
    alone, shared = (draws(partition(96, 3, threads, designs=3)) for threads in (1, 8))
    np.testing.assert_array_equal(alone, shared)


def test_designs_with_common_random_numbers_draw_as_if_each_were_alone():
    together = draws(partition(120, 5, 1, designs=3)).reshape(3, 40)
    np.testing.assert_array_equal(together[1], together[0])
    np.testing.assert_array_equal(together[2], draws(partition(40, 5, 1)))


def test_without_them_no_two_simulations_draw_alike():
    values = draws(partition(120, 5, 1))
    assert len(np.unique(values)) == 120
