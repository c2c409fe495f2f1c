"""A planned human walk is believed, one that falls, hops or slides is not."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hyperleg_design.evaluation.believable import walk_findings
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import WalkProtocol
from hyperleg_design.evaluation.protocols.walk import measure_walk
from hyperleg_design.evaluation.result import evaluation_of
from hyperleg_design.evaluation.rollout import FELL


def findings(trials, design, protocol=None):
    protocol = protocol or WalkProtocol()
    parts = [list(p) for p in zip(*(measure_walk(t, protocol) for t in trials), strict=True)]
    return {
        f.demand.measure: f
        for f in walk_findings([evaluation_of(standing(14), design, protocol, trials, *parts)])
    }


POSTURE = {"knee_touchdown", "knee_midstance", "knee_swing", "ankle_dorsiflexion"}


def test_the_planned_walk_is_believed_but_for_its_crouch(planned_trial, design):
    """The plan keeps the pelvis level, which takes knees bent by 37 deg and more."""
    found = findings([planned_trial], design)
    assert {name for name, f in found.items() if not f.met} == POSTURE
    assert found["steady_speed"].found == pytest.approx(1.33)


def test_human_angles_are_believed(planned_trial, design):
    """Knees of 10 deg that bend to 60 deg in the swing, ankles of 8 deg."""
    feet = planned_trial.foot_load > 0.0
    position = planned_trial.joint_position.copy()
    for i, joint in enumerate(planned_trial.layout.joints):
        swing = ~feet[:, int(joint.startswith("right"))]
        if joint.endswith("knee"):
            position[:, i] = np.deg2rad(np.where(swing, 60.0, 10.0))
            position[1:, i] = np.where(swing[1:] & swing[:-1], position[1:, i], np.deg2rad(10.0))
        elif joint.endswith("ankle_pitch"):
            position[:, i] = np.deg2rad(-8.0)
    found = findings([dataclasses.replace(planned_trial, joint_position=position)], design)
    assert {name for name, f in found.items() if f.met} >= POSTURE


def test_a_leaning_trunk_and_ankles_that_only_brake_are_not(planned_trial, design):
    lean = np.deg2rad(7.0) / 2
    orientation = np.zeros_like(planned_trial.base_orientation)
    orientation[:, [0, 2]] = np.cos(lean), np.sin(lean)
    found = findings(
        [
            dataclasses.replace(
                planned_trial,
                base_orientation=orientation,
                driven_joint_torque=-np.abs(planned_trial.joint_velocity),
                joint_velocity=np.abs(planned_trial.joint_velocity),
            )
        ],
        design,
    )
    assert not found["mean_tilt"].met
    assert not found["ankle_push_off_power"].met


def test_a_learned_crouch_is_not():
    """A walk trained with gait clock and contact match: deep knees, leaning trunk."""
    crouch = evaluate(Path(__file__).with_name("crouch.onnx"), threads=1)
    failed = {f.demand.measure for f in walk_findings([crouch]) if not f.met}
    assert failed >= {"knee_touchdown", "knee_midstance", "knee_swing", "ankle_dorsiflexion"}
    assert not failed & {"fell", "arrived", "cadence", "alternation"}


def test_one_fall_in_two_is_not(planned_trial, design):
    found = findings([planned_trial, dataclasses.replace(planned_trial, outcome=FELL)], design)
    assert found["fell"].found == 0.5
    assert not found["fell"].met
    assert not found["arrived"].met
    assert found["cadence"].met


def test_sliding_feet_and_a_wrong_speed_are_not(planned_trial, design):
    faster = planned_trial.base_position * [
        1.1,
        1.0,
        1.0,
    ]  # the same steps, so the feet are dragged along
    found = findings([dataclasses.replace(planned_trial, base_position=faster)], design)
    stance = 0.1 * 1.33 * 0.62  # of a stride of one second
    assert 0.4 * stance < found["foot_drift"].found < stance
    assert not found["foot_drift"].met
    assert not found["steady_speed"].met


def test_nothing_measured_is_not_met(planned_trial, design):
    found = findings([dataclasses.replace(planned_trial, outcome=FELL)], design)
    assert not found["cadence"].met
