import numpy as np

from hyperleg_design.simulation.settings import Limits
from hyperleg_design.simulation.state import read_motion
from hyperleg_design.simulation.terms.terminations import (
    COURSE_FINISHED,
    LOW,
    OFF_PATH,
    RUNNING,
    TILTED,
    TIME_OUT,
    ending,
    fell,
)


class _Goal:
    def __init__(self, deviation, finished):
        self.deviation, self.finished = np.array(deviation), np.array(finished)


def test_each_way_to_end():
    height = np.array([0.7, 0.5, 0.7, 0.7, 0.5, 0.7, 0.7])
    lean = np.array([0.0, 0.0, 1.0, 0.9, 1.0, 0.0, 0.0])
    qpos = np.zeros((7, 21))
    qpos[:, 2], qpos[:, 3], qpos[:, 5] = height, np.cos(lean / 2), np.sin(lean / 2)
    goal = _Goal([0, 0, 0, 0, 5, 5, 0], [False] * 6 + [True])
    steps = np.array([10, 10, 10, 1000, 1000, 10, 1000])
    code = ending(read_motion(qpos, np.zeros((7, 20))), goal, steps, Limits(), 0.02)
    np.testing.assert_array_equal(
        code, [RUNNING, LOW, TILTED, TIME_OUT, LOW, OFF_PATH, COURSE_FINISHED]
    )
    np.testing.assert_array_equal(fell(code), [False, True, True, False, True, False, False])
    without = ending(read_motion(qpos, np.zeros((7, 20))), None, steps, Limits(), 0.02)
    np.testing.assert_array_equal(without, [RUNNING, LOW, TILTED, TIME_OUT, LOW, RUNNING, TIME_OUT])
