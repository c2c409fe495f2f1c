from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.checks import zeros
from hyperleg_design.gap.results.finding import NOTE
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture
def subject(robot_files):
    return load_subject(robot_files["coupled"])


def test_the_spread_of_each_joint_is_told(subject, monkeypatch):
    monkeypatch.setattr(zeros, "zero_spread", lambda log, robot: np.array([0.031, 0.0872]))
    (found,) = zeros.zeroed(SimpleNamespace(), subject)
    assert (found.severity, found.signal) == (NOTE, "position")
    assert "hip 0.031 rad, knee 0.087 rad" in found.what


def test_encoders_with_a_fixed_zero_give_no_note(subject, monkeypatch):
    monkeypatch.setattr(zeros, "zero_spread", lambda log, robot: np.zeros(2))
    assert not list(zeros.zeroed(SimpleNamespace(), subject))
