"""Landmarks of the gait cycle on walks whose angles and forces are known from elsewhere."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.landmarks import (
    LANDMARKS,
    force_humps,
    in_order,
    landmark_measures,
)
from hyperleg_design.evaluation.motion.steps import measured_steps
from hyperleg_design.evaluation.protocol import WalkProtocol


@pytest.fixture(scope="module")
def steps(planned_trial):
    return measured_steps(planned_trial, WalkProtocol().events)


def measured(trial, steps):
    return landmark_measures(trial, steps, WalkProtocol().events)


def with_joint(trial, name, values):
    position = trial.joint_position.copy()
    for i, joint in enumerate(trial.layout.joints):
        if joint.endswith(name):
            position[:, i] = values
    return dataclasses.replace(trial, joint_position=position)


def test_angles_are_read_where_they_are_stated(planned_trial, steps):
    """A knee angle that counts samples gives each landmark the sample it is read at."""
    clock = np.arange(planned_trial.samples) * 1e-3
    found = measured(with_joint(planned_trial, "knee", clock), steps)
    whole = steps.toe_off > 0
    down, up = steps.touchdown[whole], steps.toe_off[whole]
    assert found["knee_touchdown"] == pytest.approx(down.mean() * 1e-3)
    assert found["knee_midstance"] == pytest.approx(((down + up) / 2).mean() * 1e-3, abs=1.5e-3)
    swing = [
        steps.touchdown[(steps.foot == f) & (steps.touchdown > u)][:1] - 1
        for f, u in zip(steps.foot[whole], up, strict=True)
    ]
    assert found["knee_swing"] == pytest.approx(np.concatenate(swing).mean() * 1e-3)


def test_dorsiflexion_is_the_ankle_bent_up(planned_trial, steps):
    assert measured(with_joint(planned_trial, "ankle_pitch", -0.3), steps)[
        "ankle_dorsiflexion"
    ] == pytest.approx(0.3)


def test_push_off_power_is_that_of_torque_and_speed(planned_trial, steps):
    trial = dataclasses.replace(
        planned_trial,
        driven_joint_torque=np.full_like(planned_trial.driven_joint_torque, 20.0),
        joint_velocity=np.full_like(planned_trial.joint_velocity, 1.5),
    )
    assert measured(trial, steps)["ankle_push_off_power"] == pytest.approx(30.0)


def test_the_planned_walk_rolls_from_heel_to_toe_with_two_humps(planned_trial, steps):
    found = measured(planned_trial, steps)
    assert found["event_order"] == 1.0
    assert found["force_humps"] == 2
    assert 0.9 < found["push_off_force"] < 1.4  # load_swing of the plan is 0.2


def test_backwards_in_time_the_events_are_out_of_order(planned_trial):
    reverse = {
        name: getattr(planned_trial, name)[::-1]
        for name in ("joint_position", "joint_velocity", "pad_force", "driven_joint_torque")
    }
    trial = dataclasses.replace(planned_trial, **reverse)
    steps = measured_steps(trial, WalkProtocol().events)
    assert measured(trial, steps)["event_order"] == 0.0


@pytest.mark.parametrize(
    ("heel", "forefoot", "order"),
    [
        ("11110000", "00111111", True),
        ("11110000", "11111111", False),  # flat at once
        ("00111100", "11111111", False),  # toes first
        ("11111111", "00111111", False),  # the heel leaves last
        ("11100000", "00011111", False),  # never flat
        ("00000000", "11111111", False),
    ],
)
def test_order_of_events(heel, forefoot, order):
    loaded = [np.array([c == "1" for c in text]) for text in (heel, forefoot)]
    assert in_order(*loaded) is order


def test_humps_are_counted_and_measured():
    share = np.linspace(0, 1, 101)
    one = np.sin(np.pi * share)
    two = one + 0.4 * np.sin(3 * np.pi * share)
    assert force_humps(one) == pytest.approx([1.0])
    assert len(force_humps(two)) == 2
    assert force_humps(two) == pytest.approx(two[[two[:50].argmax(), 50 + two[50:].argmax()]])
    assert len(force_humps(two + 0.02 * np.sin(40 * np.pi * share))) == 2  # ripple is no hump


def test_no_whole_contact_gives_nothing(planned_trial, steps):
    found = measured(planned_trial, steps.within(0, 0))
    assert list(found) == list(LANDMARKS)
    assert np.isnan(list(found.values())).all()
