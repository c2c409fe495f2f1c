"""Power of trials: constant torque, sums over joints and motors, both legs."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.power import (
    FLOWS,
    GROUPS,
    cycle_power,
    flows,
    ledger,
    leg_means,
)
from hyperleg_design.evaluation.motion.steps import measured_steps
from hyperleg_design.evaluation.protocol import Events
from hyperleg_design.robot.motors import motor_arrays


def test_constant_torque_and_speed_give_the_formula(planned_trial, design):
    torque, speed = np.linspace(-1, 1, 14), np.linspace(100, -50, 14)
    trial = dataclasses.replace(
        planned_trial, motor_torque=np.tile(torque, (50, 1)), motor_velocity=np.tile(speed, (50, 1))
    )
    found = flows(ledger(trial))
    constants = np.tile(motor_arrays(design).power_constant, 2)
    electrical = constants * torque**2 + torque * speed
    assert set(found) == set(FLOWS)
    assert found["joule"] == pytest.approx(np.sum(constants * torque**2))
    assert found["mechanical"] == pytest.approx(np.sum(torque * speed))
    assert found["motor_side"] == pytest.approx(found["joule"] + found["mechanical"])
    assert found["battery"] == pytest.approx(
        np.where(electrical > 0, electrical / 0.9, 0.8 * electrical).sum()
    )
    assert found["battery"] == pytest.approx(
        found["mechanical"] + found["joule"] + found["driver_loss"]
    )


def test_joints_of_both_legs_and_joule_add_up_to_the_whole_robot(planned_trial):
    steps = measured_steps(planned_trial, Events())
    whole = flows(ledger(planned_trial))
    legs = [cycle_power(planned_trial, steps, foot).means for foot in (0, 1)]
    assert sum(leg["total"] for leg in legs) == pytest.approx(whole["motor_side"], rel=1e-9)
    assert sum(leg[g] for leg in legs for g in GROUPS) == pytest.approx(
        whole["mechanical"], rel=1e-9
    )
    assert sum(leg["joule"] for leg in legs) == pytest.approx(whole["joule"], rel=1e-9)


def test_the_cycle_has_the_strides_the_joints_and_the_motors(planned_trial):
    steps = measured_steps(planned_trial, Events())
    found = cycle_power(planned_trial, steps, foot=1)
    assert found.joints[-1] == "toe"
    assert found.motors[4:] == ("ankle_left", "ankle_right", "toe")
    assert found.mechanical.shape == (np.sum(steps.foot == 1) - 1, 101, 7)
    assert found.mechanical[3] == pytest.approx(
        found.mechanical[5], abs=1e-6
    )  # every stride is the same
    assert found.mechanical[:, 0] == pytest.approx(found.mechanical[:, -1], abs=1e-6)
    assert sum(found.of_group(g) for g in GROUPS) == pytest.approx(found.mechanical.sum(-1))


def test_signed_positive_and_absolute_are_told_apart():
    mechanical = np.array([[10.0, -4.0], [-2.0, -4.0]])
    found = leg_means(("ankle_pitch", "ankle_roll"), mechanical, np.ones((2, 3)))
    assert (found["ankle"], found["ankle_positive"], found["ankle_absolute"]) == (0, 5, 10)
    assert (found["hip"], found["toe"], found["joule"], found["total"]) == (0, 0, 3, 3)
    assert np.isnan(list(leg_means(("toe",), np.empty((0, 1)), np.empty((0, 1))).values())).all()


def test_a_leg_that_never_steps_has_no_cycle(planned_trial):
    steps = measured_steps(planned_trial, Events()).within(0, 60)
    found = cycle_power(planned_trial, steps, foot=1)
    assert len(found.mechanical) == 0
    assert np.isnan(found.means["total"])
