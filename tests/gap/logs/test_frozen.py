import numpy as np
import pytest

from hyperleg_design.gap.logs.frozen import frozen
from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata

TIME = np.arange(0, 4, 0.005)
SWING = np.sin(2 * TIME)
STUCK = slice(200, 500)


def log(position, **signals):
    columns = {"position/knee": position, **{f"{k}/knee": v for k, v in signals.items()}}
    return Log("x", TIME, columns, Metadata(base="fixed"))


def stuck(values):
    values = values.copy()
    values[STUCK] = values[STUCK.start]
    return values


def test_a_sensor_that_comes_back_with_a_jump_was_stuck():
    assert frozen(log(stuck(SWING)), "knee") == STUCK


def test_a_joint_that_sticks_and_moves_on_gently_was_not():
    held = np.concatenate([SWING[:200], np.full(300, SWING[199]), SWING[200 : len(SWING) - 300]])
    assert frozen(log(held), "knee") is None


@pytest.mark.parametrize(
    ("driven", "is_frozen"), [({"velocity": 2 * np.cos(2 * TIME)}, True), ({}, False)]
)
def test_a_joint_whose_speed_says_that_it_turned_was_stuck(driven, is_frozen):
    held = np.concatenate([SWING[:200], np.full(300, SWING[199]), SWING[200 : len(SWING) - 300]])
    assert (frozen(log(held, **driven), "knee") is not None) == is_frozen


def test_a_joint_that_never_moves_and_a_log_that_moves_all_the_time():
    assert frozen(log(np.zeros_like(TIME)), "knee") is None
    assert frozen(log(SWING), "knee") is None
    assert frozen(log(np.full_like(TIME, np.nan)), "knee") is None
