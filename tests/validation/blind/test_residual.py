"""How large a gap is, against motions whose torques are known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.validation.blind.residual import EDGE, multiple, residual, rms
from hyperleg_design.validation.blind.robots.catalogue import chain


def slow_motion(robot, extra=0.0):
    """A log of a smooth motion whose motor torques are those that it needs, and `extra` [Nm]."""
    time = np.arange(0, 6, 0.005)
    n = len(robot.joints)
    w = 2 * np.pi * 0.3 * (1 + 0.1 * np.arange(n))
    position = robot.rest + 0.2 * np.sin(w * time[:, None])
    velocity, acceleration = 0.2 * w * np.cos(w * time[:, None]), 0.2 * w**2
    acceleration = -acceleration * np.sin(w * time[:, None])
    model = robot.pinocchio()
    data = model.createData()
    needed = np.array(
        [pin.rnea(model, data, *row) for row in zip(position, velocity, acceleration, strict=True)]
    )
    matrix = robot.joint_from_motor
    needed += acceleration @ (matrix * robot.rotor_inertia @ matrix.T)
    torque = (needed + extra) @ np.linalg.inv(matrix).T
    signals = {f"position/{j}": position[:, k] for k, j in enumerate(robot.joints)}
    signals |= {f"position_target/{j}": position[:, k] for k, j in enumerate(robot.joints)}
    signals |= {f"motor_torque/{m}": torque[:, k] for k, m in enumerate(robot.motors)}
    return Log("a", time, signals, Metadata(base="fixed"))


@pytest.fixture(scope="module")
def arm():
    """Without friction, of which inverse dynamics says nothing at rest."""
    robot = chain("arm")
    return dataclasses.replace(robot, coulomb=0 * robot.coulomb, viscous=0 * robot.viscous)


def test_torques_that_the_motion_needs_leave_nothing(arm):
    n = len(arm.joints)
    left = residual(slow_motion(arm), arm)
    assert left.shape[1] == n + len(arm.motors)
    assert len(left) == pytest.approx((6 - 2 * EDGE) / 0.005, abs=2)
    assert rms(left[:, :n]).max() < 2e-3 * (np.abs(arm.joint_from_motor) @ arm.peak_torque).max()


def test_a_torque_too_much_is_left_at_its_joint(arm):
    extra = np.zeros(len(arm.joints))
    extra[2] = 1.5
    more = residual(slow_motion(arm, extra), arm) - residual(slow_motion(arm), arm)
    np.testing.assert_allclose(more[:, : len(extra)], np.tile(extra, (len(more), 1)), atol=1e-6)


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30), st.integers(0, 5))
def test_root_mean_square_leaves_unknown_values_out(values, unknown):
    column = np.r_[values, np.full(unknown, np.nan)][:, None]
    assert rms(column)[0] == pytest.approx(np.sqrt(np.mean(np.square(values))), abs=1e-12)


@given(st.floats(0.01, 100), st.integers(0, 2))
def test_the_multiple_is_the_largest_ratio_of_a_row(factor, row):
    clean = np.random.default_rng(0).normal(size=(200, 3))
    effect = clean.copy()
    effect[:, row] *= 1 + factor
    assert multiple([effect, clean], [clean, clean]) == pytest.approx(factor / np.sqrt(2))


def test_a_row_that_is_hardly_known_does_not_count():
    clean = np.ones((1000, 2))
    effect = clean * [2.0, 500.0]
    effect[5:, 1] = np.nan
    assert multiple([effect], [clean]) == pytest.approx(1.0)
    assert multiple([np.full((9, 1), np.nan)], [np.ones((9, 1))]) == 0.0
