"""The log of the quadruped: each column where its name says, with noise on what is measured."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.validation.newcomers import quadruped_log as log

ROWS = 4000
EXACT = ("position_target", "position", "velocity", "motor_torque_command")
NOISE = {
    "motor_torque": log.TORQUE_NOISE,
    "base_position": log.PLACE_NOISE,
    "base_velocity": log.MOVE_NOISE,
    "gyro": log.GYRO_NOISE,
    "accelerometer": log.FORCE_NOISE,
    "contact_force": log.CELL_NOISE,
}
BEGIN = {
    "position_target": 1,
    "position": 13,
    "velocity": 25,
    "motor_torque_command": 37,
    "motor_torque": 49,
    "base_position": 61,
    "base_velocity": 68,
    "gyro": 71,
    "accelerometer": 74,
    "contact_force": 77,
}
"""First column of each signal in the table that the docstring describes."""


@pytest.fixture(scope="module")
def recording():
    table = np.tile(np.arange(89.0), (ROWS, 1))
    table[:, 0] = np.arange(ROWS) * 0.005
    table[:, 64:68] = [0.6, 0.0, 0.8, 0.0]
    gains = np.arange(12.0)
    return log.logged(table, np.random.default_rng(0), "a", gains + 1, gains + 2)


@pytest.mark.parametrize("kind", [*EXACT, *NOISE])
def test_columns_are_those_of_their_names(recording, kind):
    columns = [v for name, v in recording.signals.items() if name.split("/")[0] == kind]
    assert len(columns) == (
        3 if kind in ("base_position", "base_velocity", "gyro", "accelerometer") else 12
    )
    for k, values in enumerate(columns):
        noise = NOISE.get(kind, 0.0)
        assert np.mean(values) == pytest.approx(BEGIN[kind] + k, abs=5 * noise / np.sqrt(ROWS))
        assert np.std(values) == pytest.approx(noise, rel=0.1)


def test_the_orientation_is_a_unit_quaternion_near_the_true_one(recording):
    turn = np.stack([recording.signals[f"base_orientation/{a}"] for a in "wxyz"], -1)
    np.testing.assert_allclose(np.linalg.norm(turn, axis=1), 1.0)
    angle = 2 * np.arccos(np.clip(turn @ [0.6, 0.0, 0.8, 0.0], -1, 1))
    # three axes, each turned by the noise
    assert np.sqrt(np.mean(angle**2)) == pytest.approx(np.sqrt(3) * log.TURN_NOISE, rel=0.1)


def test_gains_and_names_are_declared(recording):
    gains = recording.metadata["gains"]
    assert gains[log.JOINTS[3]] == [4.0, 5.0]
    assert recording.metadata["base"] == "floating"
    assert f"contact_force/{log.FEET[1]}_z" in recording.signals
    assert f"motor_torque/{log.JOINTS[0].removesuffix('_joint')}" in recording.signals
