"""A biased inertial sensor: what it leaves in the residuals, and what the policy is told."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.model.design_subject import subject_of
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.tasks import load_task

BIAS = np.array([0.03, -0.02, 0.05, 0.4, -0.3, 0.2])


@pytest.fixture(scope="module")
def thrown(biped_runs):
    """A biped in the air, told by an exact sensor and by a biased one."""
    log = biped_runs["thrown"]
    subject = load_subject("hyperleg", [log])
    added = {
        f"{kind}/{axis}": BIAS[3 * k + i]
        for k, kind in enumerate(("gyro", "accelerometer"))
        for i, axis in enumerate("xyz")
    }
    told = dataclasses.replace(
        log, signals={name: values + added.get(name, 0.0) for name, values in log.signals.items()}
    )
    return condition(log, subject), condition(told, subject)


def test_trace_is_what_the_bias_does_to_the_residual(thrown):
    true, told = thrown
    if not np.isfinite(true.log.vector("gyro")).all():
        pytest.skip("this log has no sensor")
    trace = effect("imu_bias").trace(told, "imu", BIAS[None])
    known = (
        np.isfinite(told.residual["motion"])
        & np.isfinite(true.residual["motion"])
        & told.valid[:, None]
    )
    left = (told.residual["motion"] - true.residual["motion"])[known]
    assert known.sum() > 500
    assert np.sqrt(np.mean(left**2)) > 0.1
    np.testing.assert_allclose(trace["motion"][0][known], left, atol=0.02 * np.abs(left).max())


def test_nulls_leave_nothing(thrown):
    one = effect("imu_bias")
    for rows in one.trace(thrown[0], "imu", one.nulls[None]).values():
        assert np.abs(rows).max() < 1e-9


def test_a_fixed_base_has_none(robot_files):
    assert effect("imu_bias").locations(load_subject(robot_files["arm"])) == ()


def test_gyro_and_accelerometer_tell_their_biases():
    design = load_design()
    subject = subject_of(design)
    values = np.stack([np.zeros(6), np.array([0.1, 0.2, 0.3, 9.81, 0.0, 0.0])])
    chain = Chain(
        machine_of(design), (effect("imu_bias").alteration("imu", values, subject),), 2, 0.005
    )
    rate, force = chain.imu(np.ones((2, 3)), np.tile([0.0, 0.0, 9.81], (2, 1)))
    np.testing.assert_allclose(rate, [[1, 1, 1], [1.1, 1.2, 1.3]])
    np.testing.assert_allclose(force, [[0, 0, 9.81], [9.81, 0, 9.81]], atol=1e-12)


def test_a_policy_is_told_a_tilted_gravity():
    """An accelerometer that reads one g more along x takes down to lie halfway between -x and
    -z.
    """
    values = np.array([0.0, 0.0, 0.0, 9.81, 0.0, 0.0])
    design = load_design()
    task = load_task("walk").changed(start=Start(tilt=0.0))
    alterations = (effect("imu_bias").alteration("imu", values, subject_of(design)),)
    environment = Environment(
        design, task, simulations=2, seed=1, threads=1, alterations=alterations
    )
    told = environment.reset()["policy"]
    columns = [
        i for i, name in enumerate(environment.observation_columns["policy"]) if "gravity" in name
    ]
    np.testing.assert_allclose(
        told[:, columns], np.tile([-np.sqrt(0.5), 0, -np.sqrt(0.5)], (2, 1)), atol=1e-6
    )
