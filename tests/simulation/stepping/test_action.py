from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.stepping.action import checked_action


def test_actions_become_double_precision():
    given = np.linspace(-1, 1, 6, dtype=np.float32).reshape(2, 3)
    checked = checked_action(given, (2, 3))
    assert checked.dtype == float
    np.testing.assert_array_equal(checked, given)


def test_actions_of_another_robot_are_refused():
    with pytest.raises(InputError, match="another robot"):
        checked_action(np.zeros((2, 4)), (2, 3))


def test_actions_that_are_no_numbers_are_refused_with_the_first_simulation():
    action = np.zeros((5, 3))
    action[[2, 4], 1] = np.nan
    with pytest.raises(InputError, match="in 2 simulations, first in 2"):
        checked_action(action, (5, 3))


def test_infinite_actions_whose_sum_is_not_a_number_are_refused():
    action = np.array([[np.inf, 0.0], [-np.inf, 0.0]])
    with np.errstate(invalid="ignore"), pytest.raises(InputError, match="not finite"):
        checked_action(action, (2, 2))
