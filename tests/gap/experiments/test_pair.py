"""Pairs of look-alikes and how far a motion tells them apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.effects import LOOK_ALIKES
from hyperleg_design.gap.experiments import information as info
from hyperleg_design.gap.experiments.pair import apart, pairs_of, place_at
from hyperleg_design.gap.signals.loading import load_subject


@pytest.fixture(scope="module")
def coupled(robot_files):
    subject = load_subject(robot_files["coupled"])
    return subject, info.blocks_of(subject)


def test_pairs_are_look_alikes_each_once(coupled):
    subject, blocks = coupled
    pairs = pairs_of(subject, blocks)
    known = {(first, second): by for first, second, by in LOOK_ALIKES}
    assert len({(p.first, p.second) for p in pairs}) == len(pairs) > 10
    for pair in pairs:
        assert known[pair.first[0], pair.second[0]] == pair.by
        assert {pair.first, pair.second} <= set(blocks.places)
        assert pair.joint in subject.joints


def test_an_effect_is_found_at_its_joint_its_motor_its_link_or_the_robot(coupled):
    subject, blocks = coupled
    knee = subject.joints.index("knee")
    assert place_at("viscous_friction", knee, subject, blocks) == ("viscous_friction", "knee")
    assert place_at("link_mass", knee, subject, blocks) == ("link_mass", "shank")
    assert place_at("command_delay", knee, subject, blocks)[1] in (*subject.motors, "robot")
    assert place_at("ground_friction", knee, subject, blocks) is None
    motor = place_at("rotor_inertia", knee, subject, blocks)[1]
    strongest = np.abs(subject.joint_from_motor[knee])
    assert strongest[subject.motors.index(motor)] == strongest.max()


def left(columns, blocks, place, rival):
    """Length of a trace without its regression on a rival's columns."""
    trace, span = columns[:, blocks.trace(place)], columns[:, blocks.span(rival)]
    return np.linalg.norm(trace - span @ np.linalg.lstsq(span, trace)[0])


def test_what_is_left_is_that_of_a_regression_on_the_other(coupled):
    subject, blocks = coupled
    columns = np.random.default_rng(0).standard_normal((40, blocks.columns))
    for pair in pairs_of(subject, blocks)[:5]:
        found = apart(columns.T @ columns, blocks, pair)
        expected = min(
            left(columns, blocks, pair.first, pair.second),
            left(columns, blocks, pair.second, pair.first),
        )
        assert found == pytest.approx(expected, rel=1e-6)
        swapped = replace(pair, first=pair.second, second=pair.first)
        assert apart(columns.T @ columns, blocks, swapped) == found


def test_an_effect_that_leaves_what_the_other_can_is_not_told_apart(coupled):
    subject, blocks = coupled
    pair = pairs_of(subject, blocks)[0]
    rng = np.random.default_rng(1)
    columns = rng.standard_normal((40, blocks.columns))
    assert apart(columns.T @ columns, blocks, pair) > 1.0
    span = blocks.span(pair.second)
    columns[:, blocks.trace(pair.first)] = columns[:, span] @ rng.standard_normal(len(span))
    assert apart(columns.T @ columns, blocks, pair) < 1e-3
