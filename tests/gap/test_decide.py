from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.decide import _verdict, decide
from hyperleg_design.gap.equivalence import alike
from hyperleg_design.gap.judge import Judge, rank
from hyperleg_design.gap.screen import places
from hyperleg_design.gap.thresholds import load_thresholds


@pytest.fixture(scope="module")
def judged(robot_files):
    ready = diagnosed.prepared(robot_files["coupled"], *(diagnosed.run("viscous", s, session="a") for s in (0, 1)))
    subject = ready.base.samples.sieves[0].signals.subject
    friction = ("viscous_friction", "coulomb_friction", "stribeck_friction", "torque_constant")
    return decide(ready.base, load_thresholds(), places(subject, friction))


def test_the_gap_is_what_the_cause_leaves_out(judged):
    judge, found = judged
    assert found.verdict == "explained"
    assert found.model.names == (("viscous_friction", "knee"),)
    rows = [judge.base.samples.rows[r].name for r in np.flatnonzero(found.rows)]
    assert rows == ["knee"]
    assert judge.closed(found.model.held, found.rows, found.model.held) > 0.95
    assert judge.closed(judge.nothing.held, found.rows, found.model.held) < 0.5


def test_each_slot_has_the_chosen_first(judged):
    judge, found = judged
    assert found.slots[0][0].names == found.model.names
    gains = [rank(m) for m in found.slots[0]]
    assert gains == sorted(gains, reverse=True)
    assert alike(judge, found.slots[0], found.model, found.rows) == []


def test_nothing_is_left_by_nothing(judged):
    judge, _ = judged
    assert isinstance(judge, Judge)
    assert judge.nothing.gain == 0
    assert np.allclose(judge.nothing.held.square, judge.nothing.held.bare)


def test_causes_that_leave_far_more_than_the_floor_must_close_most_of_it(judged):
    judge, found = judged
    rules = judge.thresholds
    closed = judge.closed(found.model.held, found.rows, found.model.held)
    strict = replace(rules, far=0.0, far_required=1.01 * closed)
    for several, verdict in ((strict, "unknown"), (replace(strict, far_required=0.5 * closed), "explained")):
        assert _verdict(replace(judge, thresholds=several), found.model, found.rows, ()) == verdict
