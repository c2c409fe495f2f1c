"""The log of a robot on its feet: what an estimator and the drives tell, on one clock."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.validation.blind import walking_record
from hyperleg_design.validation.blind.plants.walking import pad_names
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.walking_record import walking_log

QUIET = Recorder(
    jitter=0.0, clock=0.0, dropped=0.0, position_noise=0.0, velocity_noise=0.0, torque_noise=0.0
)
ROWS, STEP = 400, 5e-3


@pytest.fixture(scope="module")
def run():
    """A robot, its plant, and a run in which every signal is a line in time of its own slope."""
    robot, model = chain("hyperleg"), mujoco_model(load_design("hyperleg"))
    time = np.arange(0, ROWS * STEP, 1e-3)
    n, m = robot.joint_from_motor.shape

    def lines(columns, begin=0.0):
        return begin + time[:, None] * np.arange(1, columns + 1)

    turn = np.stack([np.cos(time), np.sin(time), 0 * time, 0 * time], -1)
    trace = SimpleNamespace(
        time=time,
        targets=np.tile(np.arange(ROWS)[:, None], n),
        encoder=lines(n),
        speed=lines(n, 1.0),
        command=lines(m, 2.0),
        drive_torque=lines(m, 3.0),
        gyro=lines(3),
        accelerometer=lines(3),
        base=np.concatenate([lines(3), turn, lines(3)], -1),
        contact=lines(len(pad_names(model)) * 3).reshape(len(time), -1, 3),
    )
    return robot, SimpleNamespace(model=model), trace


def log_of(run, recorder, seed=0):
    robot, plant, trace = run
    return walking_log(plant, trace, robot, recorder, np.random.default_rng(seed), "a", {})


def test_columns_are_what_happened_at_their_time(run, monkeypatch):
    monkeypatch.setattr(walking_record, "FORCE_NOISE", 0.0)
    monkeypatch.setattr(walking_record, "ESTIMATE", (0.0, 0.0, 0.0))
    monkeypatch.setattr(walking_record, "INERTIAL", (0.0, 0.0))
    robot, plant, _ = run
    log = log_of(run, QUIET)
    time = log.time
    np.testing.assert_allclose(time, np.arange(ROWS) * STEP)
    begin = {"position": 0, "velocity": 1, "gyro": 0, "base_position": 0, "base_velocity": 0}
    for kind, value in (begin | {"motor_torque_command": 2, "motor_torque": 3}).items():
        names = robot.motors if "torque" in kind else robot.joints
        for k, name in enumerate(
            "xyz" if kind in ("gyro", "base_position", "base_velocity") else names
        ):
            expected = value + (k + 1) * time
            np.testing.assert_allclose(log.column(f"{kind}/{name}"), expected, atol=1e-9)
    for k, pad in enumerate(pad_names(plant.model)):
        for axis, name in enumerate("xyz"):
            values = log.column(f"contact_force/{pad}_{name}")
            np.testing.assert_allclose(values, (3 * k + axis + 1) * time, atol=1e-9)
    np.testing.assert_allclose(log.column("base_orientation/w"), np.cos(time), atol=1e-6)
    np.testing.assert_allclose(log.column("base_orientation/x"), np.sin(time), atol=1e-6)


def test_orientations_have_unit_length_and_the_noise_is_there(run):
    log = log_of(run, QUIET)
    length = sum(log.column(f"base_orientation/{a}") ** 2 for a in "wxyz")
    np.testing.assert_allclose(length, 1.0)
    error = log.column("gyro/x") - log.time
    assert np.std(error) == pytest.approx(walking_record.INERTIAL[0], rel=0.15)


def test_metadata_name_the_robot_and_its_gains(run):
    robot = run[0]
    metadata = log_of(run, Recorder()).metadata
    assert (metadata.base, metadata.robot) == ("floating", robot.robot)
    for k, joint in enumerate(robot.joints):
        assert tuple(metadata.gains[joint]) == (robot.stiffness[k], robot.damping[k])
