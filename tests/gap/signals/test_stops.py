from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.signals.stops import NO_STOP, STOP, at_stop, wrong_limits

ROBOT = SimpleNamespace(position_low=np.array([-1.0, -np.inf]), position_high=np.array([1.0, 2.0]))


def test_a_stop_may_push_near_the_ends_of_a_range_and_beyond_them():
    position = np.array([[0.0, -50.0], [1.0 - 2 * STOP, 1.9], [1.0 - STOP / 2, 2.0], [-1.05, 2.05]])
    expected = [[False, False], [False, False], [True, True], [True, True]]
    assert at_stop(ROBOT, position).tolist() == expected


def test_a_joint_far_beyond_its_range_has_no_stop_there():
    position = np.array([[0.0, 0.0], [1.0, 2.0 + 1.5 * NO_STOP]])
    assert wrong_limits(ROBOT, position).tolist() == [False, True]
    assert at_stop(ROBOT, position).tolist() == [[False, False], [True, False]]
