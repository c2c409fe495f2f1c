"""What a log can say of an effect by the facts of its motion."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.gap.effects.excitation import (
    REVERSALS,
    SWING,
    Motion,
    Need,
    by_speeds,
    shown_by,
)

JOINTS = np.array(["hip", "knee", "ankle"])
FLAGS = st.lists(st.booleans(), min_size=3, max_size=3).map(np.array)


def motion(**changes) -> Motion:
    """Of three joints that move in all ways."""
    full = np.full(3, 1e3)
    facts = dict.fromkeys(
        ("reversals", "spread", "swing", "acceleration", "content", "command", "slow"), full
    )
    names = ("torque", "measured", "asked", "steered", "posture", "turning")
    known = {name: np.ones(3, bool) for name in names}
    return Motion(joints=JOINTS, **(facts | known | changes))


def need(passed, **options) -> Need:
    return Need(lambda _: passed, "good", "lacking", **options)


@given(FLAGS, FLAGS)
def test_joints_show_what_they_pass_where_their_torque_is_known(passed, torque):
    found = shown_by("spring", need(passed), None, motion(torque=torque))
    expected = tuple(j for j, p, t in zip(JOINTS, passed, torque, strict=True) if p and t)
    assert found.where == expected
    assert found.shown == bool(expected)
    assert found.effect == "spring"
    if not torque.any():
        assert "forces are unknown" in found.why
    else:
        assert found.why == ("good" if expected else "lacking")


@given(FLAGS, FLAGS)
def test_gains_show_by_targets_alone_whatever_commands_are_logged(passed, steered):
    asked = motion(asked=np.ones(3, bool), steered=steered)
    found = shown_by("gain", need(passed, asked=True, steered=True), None, asked)
    assert found.where == tuple(
        j for j, p, s in zip(JOINTS, passed, steered, strict=True) if p and s
    )
    if not steered.any():
        assert found.why == "no targets with gains: what the controller asked for is unknown"


@given(FLAGS, FLAGS, FLAGS)
def test_drives_show_what_was_asked_and_best_what_was_measured_too(passed, asked, measured):
    found = shown_by(
        "delay", need(passed, asked=True), None, motion(asked=asked, measured=measured)
    )
    expected = tuple(j for j, p, a in zip(JOINTS, passed, asked, strict=True) if p and a)
    assert found.where == expected
    assert found.shown == bool(expected)
    if not asked.any():
        assert "what was asked for is unknown" in found.why
    elif not expected:
        assert found.why == "lacking"
    else:
        both = (passed & asked & measured).any()
        assert found.why.startswith("good")
        assert ("only through the motion" in found.why) == (not both)


def test_joints_reverse_and_swing_from_their_bounds_on():
    facts = motion(
        reversals=np.array([REVERSALS - 1, REVERSALS, REVERSALS + 1]),
        swing=np.array([SWING, np.nextafter(SWING, 1), 0.0]),
    )
    assert facts.reversing.tolist() == [False, True, True]
    assert facts.swinging.tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("motors", "reversals", "where"),
    [(("m", "n"), 1, ("m", "n")), (("n",), 1, ("n",)), ((), 1, None), (("m", "n"), 0, None)],
)
def test_speeds_of_motors_and_moving_joints_show_what_lies_between(motors, reversals, where):
    log = SimpleNamespace(
        motors=("m", "n"), has=lambda kind, name: kind == "motor_velocity" and name in motors
    )
    facts = motion(reversals=np.full(3, reversals))
    found = by_speeds("backlash", log, facts)
    assert (None if found is None else found.where) == where
    either = shown_by("backlash", need(np.ones(3, bool), speeds=True), log, facts)
    assert either.where == (where or tuple(JOINTS))
