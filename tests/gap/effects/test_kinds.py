"""Places of effects by kind, and torques as residuals of motion."""

from __future__ import annotations

import numpy as np
import pytest
from pendulum import Wrong

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.kinds import (
    FootEffect,
    JointEffect,
    JointTorque,
    MotorEffect,
    MotorTorque,
)
from hyperleg_design.gap.signals.loading import load_subject

FEET = {"floating": ("left_foot", "right_foot"), "fixed": ()}


def of_kind(kind):
    return [effect for effect in EFFECTS.values() if isinstance(effect, kind)]


@pytest.mark.parametrize("base", ["floating", "fixed"])
def test_effects_sit_at_every_joint_motor_and_foot_of_the_biped(base):
    from hyperleg_design.gap.model.design_subject import subject_of
    from hyperleg_design.robot.design import load_design

    subject = subject_of(load_design("hyperleg"), base)
    for kind, places in (
        (JointEffect, subject.joints),
        (MotorEffect, subject.motors),
        (FootEffect, FEET[base]),
    ):
        effects = of_kind(kind)
        assert len(effects) >= 2
        assert {effect.locations(subject) for effect in effects} == {places}


def test_a_motor_of_a_passive_joint_is_no_place(robot_files):
    subject = load_subject(robot_files["pendulum"])
    assert {effect.locations(subject) for effect in of_kind(MotorEffect)} == {("swing",)}


@pytest.mark.parametrize("name", [e.identifier for e in of_kind((JointTorque, MotorTorque))])
def test_a_torque_is_the_residual_of_motion_of_each_setting(name, pendulum):
    """K settings at once are the same as one after the other, and nothing else is touched."""
    sees = ("motor_torque", "temperature")
    signals, effect = pendulum(Wrong(), duration=2.0, sees=sees), EFFECTS[name]
    (place, *_) = effect.locations(signals.subject)
    values = np.stack([effect.nulls, effect.example(place, signals.subject)])
    both = effect.trace(signals, place, values)
    assert set(both) == {"motion"}
    assert not np.nan_to_num(both["motion"][0]).any()
    for setting, rows in zip(values, both["motion"], strict=True):
        alone = effect.trace(signals, place, setting)["motion"]
        np.testing.assert_array_equal(alone, rows[None])
