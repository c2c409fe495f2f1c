from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.validation.blind import walking_case
from hyperleg_design.validation.blind.wrong import Wrong

PLAN = SimpleNamespace(duration=10.0)
PUSH = Wrong("periodic_push", "robot", 0.1, {"frequency": 1.0})
LOAD = Wrong("payload", "pelvis", 0.1, {"x": 0.0, "y": 0.0, "z": 0.1})


class Fragile:
    """Falls where the effects together are larger than `most`; a log is a tuple of their sizes."""

    chain = None

    def __init__(self, most):
        self.most = most

    def trace(self, wrongs, stand, duration, seed):
        return tuple(w.size for w in wrongs)

    def log(self, made, seed, name, **metadata):
        return None if sum(made) > self.most else made


@pytest.fixture(autouse=True)
def plainly_shown(monkeypatch):
    monkeypatch.setattr(
        walking_case, "shown", lambda effect, logs, clean, robot: float(sum(logs[0]))
    )


def recorded(most, *wrongs):
    return walking_case._recorded(Fragile(most), PLAN, wrongs, np.random.default_rng(0))


def test_effects_that_fell_the_robot_are_made_milder_until_it_stands():
    logs, wrongs, reached = recorded(0.02, PUSH)
    assert wrongs == [replace(PUSH, size=pytest.approx(0.4**2 * 0.1))]
    assert logs == [(wrongs[0].size,)] * walking_case.RECORDINGS
    assert reached == (wrongs[0].size,)


def test_each_of_two_effects_is_measured_alone():
    logs, wrongs, reached = recorded(1.0, PUSH, LOAD)
    assert wrongs == [PUSH, LOAD]
    assert logs[0] == (0.1, 0.1)
    assert reached == (0.1, 0.1)


def test_motions_that_no_mildness_saves_are_given_up():
    assert recorded(0.001, PUSH) is None
    with pytest.raises(RuntimeError, match="healthy"):
        recorded(-1.0, PUSH)


def test_nothing_wrong_is_recorded_as_it_is():
    logs, wrongs, reached = recorded(0.0)
    assert (logs, wrongs, reached) == ([()] * walking_case.RECORDINGS, [], ())
