"""Residuals of conditioned logs and what their table says of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import robots

from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.signals import OF_MOTORS, RESIDUALS


@pytest.fixture(scope="module")
def geared(robot_files):
    log = robots.geared_run("joint", ("hip", "knee"), seed=1)
    return condition(log, load_subject(robot_files["geared"], [log]))


def test_each_residual_has_a_row_for_each_of_its_places(geared, standing):
    seen = set()
    for signals in (geared, standing()):
        subject = signals.subject
        rows = {
            "joint": len(subject.joints),
            "motor": len(subject.motors),
            "robot": 6,
            "foot": 3 * len(subject.feet),
            "sensor": 3,
        }
        for name, values in signals.residual.items():
            kind, _ = RESIDUALS[name]
            assert values.shape == (len(signals.time), rows[kind])
            seen.add(name)
    assert {"motion", "base", "ground", "transmission"} <= seen


def test_residuals_of_motors_turn_with_the_motors(geared):
    """Of a log whose motors' speeds are told twice as large, only theirs change."""
    log = geared.log
    doubled = {
        c: (1.1 * v if c.startswith("motor_velocity") else v) for c, v in log.signals.items()
    }
    other = condition(log.changed(signals=doubled), geared.subject)
    changed = {
        name
        for name, values in geared.residual.items()
        if not np.allclose(values, other.residual[name], equal_nan=True, atol=1e-9)
    }
    assert changed == {"transmission"}
    assert changed <= set(OF_MOTORS)


def test_motors_without_a_supply_follow_no_voltage(geared):
    ticks = len(geared.time)
    sagging = np.linspace(24.0, 18.0, ticks)
    nominal = np.array([24.0, np.nan])
    subject = replace(geared.subject, supply=nominal)
    found = replace(geared, subject=subject, voltage=sagging).supplied
    np.testing.assert_allclose(found[:, 0], np.linspace(1.0, 0.75, ticks))
    assert (np.broadcast_to(found, (ticks, 2))[:, 1] == 1.0).all()
    unknown = replace(geared, subject=subject, voltage=None).supplied
    assert (unknown == 1.0).all()
    sagging = sagging.copy()
    sagging[5] = np.nan
    gap = replace(geared, subject=subject, voltage=sagging).supplied
    assert gap[5, 0] == 1.0
