from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation.stepping.divergence import FASTEST, all_sound, broken


@pytest.fixture
def state():
    return np.zeros((4, 21)), np.ones((4, 20)), np.zeros((4, 8, 2), int)


def test_simulations_that_move_within_bounds_are_sound(state):
    assert all_sound(*state)
    assert broken(*state) == {}


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_position_that_is_no_number_is_broken(state, value):
    state[0][2, 5] = value
    assert not all_sound(*state)
    assert list(broken(*state)) == [2]


@pytest.mark.parametrize("value", [np.nan, FASTEST, -2 * FASTEST])
def test_a_speed_without_bounds_is_broken(state, value):
    state[1][1, 0] = value
    assert not all_sound(*state)
    assert broken(*state) == {1: "speed or position without bounds"}


def test_only_warnings_of_wrong_steps_count(state):
    state[2][0, [0, 6, 7], 1] = 1
    assert all_sound(*state)
    assert broken(*state) == {}
    state[2][3, 4, 1] = 1
    assert not all_sound(*state)
    assert broken(*state) == {3: "warning of MuJoCo"}


def test_many_fast_simulations_are_looked_at_one_by_one_and_found_sound(state):
    state[1][:] = FASTEST / 5
    assert not all_sound(*state)
    assert broken(*state) == {}
