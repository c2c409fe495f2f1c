"""Straights and turns of runs whose speeds are known."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.stretches import NEAR, stretches
from hyperleg_design.evaluation.protocol import TTestProtocol
from hyperleg_design.evaluation.protocols.course import course_length

STEP = 0.02


def along_course(speed, turning):
    """A run along the course: `speed` on straights, `turning` within `NEAR` of inner waypoints."""
    protocol = TTestProtocol()
    points = protocol.course
    ends = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=-1))])
    place, places = 0.0, []
    while place < ends[-1] - protocol.arrival:
        places.append(place)
        near = np.abs(ends[1:-1] - place).min() < NEAR
        place += STEP * (turning if near else speed)
    return protocol, np.stack([np.interp(places, ends, points[:, i]) for i in (0, 1)], -1)


def test_straights_and_turns_are_told_apart_and_sum_to_the_run():
    protocol, path = along_course(3.0, 1.0)
    found = stretches(path, protocol, STEP)
    names = [one.name for one in found]
    assert names == [
        "A to B",
        "turn at B (1)",
        "B to C",
        "turn at C",
        "C to D",
        "turn at D",
        "D to B",
        "turn at B (2)",
        "B to A",
    ]
    assert sum(one.time for one in found) == pytest.approx((len(path) - 1) * STEP)
    for one in found:
        turn = one.name.startswith("turn")
        assert one.mean_speed == pytest.approx(1.0 if turn else 3.0, rel=0.06)
        if turn:
            assert one.way == pytest.approx(2 * NEAR, abs=0.1)
    assert found[0].way == pytest.approx(9.14 - NEAR, abs=0.1)
    assert found[4].way == pytest.approx(9.14 - 2 * NEAR, abs=0.1)  # B on the way is no turn


def test_a_run_at_one_speed_takes_its_length_over_its_speed():
    protocol, path = along_course(2.0, 2.0)
    found = stretches(path, protocol, STEP)
    total = course_length(protocol.course) - protocol.arrival
    assert sum(one.time for one in found) == pytest.approx(total / 2.0, abs=0.1)
    assert {round(one.fastest, 2) for one in found} == {2.0}


def test_a_run_that_misses_a_waypoint_has_none():
    protocol, path = along_course(2.0, 2.0)
    assert stretches(path[: len(path) // 2], protocol, STEP) == []
