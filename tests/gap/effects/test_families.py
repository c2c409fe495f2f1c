"""Families of effects against the residuals in which their traces are."""

from __future__ import annotations

import numpy as np
import pytest
import robots

from hyperleg_design.gap.effects import EFFECTS, families
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

FAMILIES = {name: value for name, value in vars(families).items() if isinstance(value, frozenset)}


@pytest.fixture(scope="module")
def signals(robot_files):
    """Of a log of targets, commands, torques and speeds of motors."""
    log = robots.geared_run("joint", ("hip", "knee"), seed=1)
    return condition(log, load_subject(robot_files["geared"], [log]))


def shown(signals, name):
    """Residuals in which an effect shows anywhere on the robot."""
    effect, found = EFFECTS[name], set()
    for place in effect.locations(signals.subject):
        values = effect.example(place, signals.subject)[None]
        trace = effect.trace(signals, place, values)
        found |= {r for r, rows in trace.items() if np.any(np.abs(np.nan_to_num(rows)) > 1e-12)}
    return found


@pytest.mark.parametrize("family", sorted(FAMILIES))
def test_families_are_of_the_catalogue(family):
    assert FAMILIES[family] <= set(EFFECTS)
    assert len(FAMILIES[family]) > 1


@pytest.mark.parametrize("name", sorted(families.BESIDE_TRANSMISSIONS))
def test_speeds_of_rotors_and_joints_keep_their_ratio(signals, name):
    assert "transmission" in signals.residual
    assert "transmission" not in shown(signals, name)


@pytest.mark.parametrize("name", ["transmission_ratio", "backlash", "transmission_elasticity"])
def test_what_lies_between_rotors_and_joints_changes_their_ratio(signals, name):
    assert "transmission" in shown(signals, name)
    assert name not in families.BESIDE_TRANSMISSIONS


@pytest.mark.parametrize("name", sorted(families.INERTIAL | families.FRICTION))
def test_masses_and_friction_act_in_the_motion_alone(signals, name):
    assert shown(signals, name) == {"motion"}
    assert name not in families.IN_DRIVES


def test_friction_takes_power(signals):
    # what is added to sliding friction near standstill has the sign of noise while joints turn
    for name in sorted(families.FRICTION - {"stribeck_friction"}):
        effect = EFFECTS[name]
        for place in effect.locations(signals.subject):
            values = effect.example(place, signals.subject)[None]
            rows = np.nan_to_num(effect.trace(signals, place, values)["motion"][0])
            power = (rows * signals.velocity)[signals.valid].sum(1)
            assert abs(power.mean()) > 0
            # of one sign at all times but near standstill
            assert abs(power.mean()) > 0.9 * np.abs(power).mean(), name


def test_what_acts_in_drives_sits_at_motors_joints_or_the_robot():
    for name in families.IN_DRIVES:
        assert EFFECTS[name].kind in ("motor", "robot", "joint")
