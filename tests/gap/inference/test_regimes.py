from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.regimes import regimes

STEP = 0.01
TIME = np.arange(400) * STEP


@pytest.fixture
def signals():
    angle = 0.5 * np.sin(2 * np.pi * TIME / 2)
    speed = np.gradient(angle, STEP)
    both = np.stack([angle, 2 * angle], -1)
    subject = SimpleNamespace(joint_from_motor=np.array([[1.0, 0.0], [0.0, -1.0]]))
    return SimpleNamespace(
        position=both,
        velocity=np.stack([speed, 2 * speed], -1),
        rigid=3 * both,
        step=STEP,
        subject=subject,
    )


def test_regimes_split_the_time(signals):
    found = regimes(signals, "motion", 1)
    for one, other in (
        ("forward", "backward"),
        ("slow", "fast"),
        ("light load", "heavy load"),
        ("low posture", "high posture"),
    ):
        assert np.array_equal(found[one], ~found[other])
    assert np.array_equal(found["forward"], signals.velocity[:, 1] >= 0)
    assert found["fast"].mean() == pytest.approx(0.5, abs=0.01)


def test_reversals_are_about_the_turns(signals):
    turning = TIME[regimes(signals, "motion", 0)["reversal"]]
    assert all(np.abs(turning - turn).min() < 0.02 for turn in (0.5, 1.5, 2.5, 3.5))
    assert np.abs(turning[:, None] - [0.5, 1.5, 2.5, 3.5]).min(1).max() < 0.08


def test_motors_go_by_their_own_sense_and_have_no_posture(signals):
    found = regimes(signals, "drive", 1)
    assert np.array_equal(found["forward"], signals.velocity[:, 1] <= 0)
    assert "heavy load" not in found
