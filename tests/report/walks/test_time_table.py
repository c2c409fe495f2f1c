"""Where the time of T-tests goes: the parts are the whole, and fallen runs do not count."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.rollout import ARRIVED, FELL
from hyperleg_design.report.walks.time_table import stretch_means, time_table

STEP = 0.02


def run_at(speed):
    """The path of a pelvis that follows the course at one speed `(t, 2)` [m]."""
    course = TTestProtocol().course
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(course, axis=0), axis=-1))])
    way = np.arange(0, length[-1] + speed * STEP, speed * STEP)
    return np.stack([np.interp(way, length, course[:, k]) for k in (0, 1)], -1)


def evaluation(*outcomes):
    """Runs at 2, 4 and 1 m/s that ended so."""
    paths = [run_at(speed) for speed, _ in zip((2.0, 4.0, 1.0), outcomes, strict=False)]
    return SimpleNamespace(protocol=TTestProtocol(), paths=paths, outcomes=outcomes)


def test_times_of_the_stretches_sum_to_that_of_the_run():
    runs = evaluation(ARRIVED, ARRIVED, FELL)
    means = stretch_means([runs], STEP)
    whole = np.mean([(len(path) - 1) * STEP for path in runs.paths[:2]])
    assert sum(time for time, *_ in means.values()) == pytest.approx(whole)
    # 2 and 4 m/s all the way, corners of the path apart; the run at 1 m/s fell
    for name, (_, mean, slowest, fastest) in means.items():
        assert slowest <= mean * 1.001, name
        assert fastest == pytest.approx(3.0, rel=0.02)


def test_a_straight_at_one_speed_has_that_speed():
    means = stretch_means([evaluation(ARRIVED)], STEP)
    straights = [values for name, values in means.items() if " to " in name]
    assert straights
    for _, mean, slowest, _ in straights:
        assert (mean, slowest) == (pytest.approx(2.0, rel=0.01), pytest.approx(2.0, rel=0.01))


def test_designs_stand_side_by_side():
    runs = [evaluation(ARRIVED, ARRIVED)]
    table = time_table({"toe": runs, "toe_locked": runs}, "t_test", STEP)
    assert table.headers[1::2] == ["toe: time [s]", "toe locked: time [s]"]
    for row in table.rows:
        assert row[1:3] == row[3:5]


def test_without_an_arrival_there_is_a_sentence():
    fallen = evaluation(FELL, FELL, FELL)
    assert stretch_means([fallen], STEP) == {}
    assert "No T-test of t test arrived" in time_table({"toe": [fallen]}, "t_test", STEP)
