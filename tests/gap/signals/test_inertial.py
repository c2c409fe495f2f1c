"""Residuals of an IMU, on a base that sways as formulas say: what its sensors feel is derived here,
by nothing of the package.
"""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hyperleg_design.gap.effects import WEIGHED, effect
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

GYRO_OFF, FELT_OFF = np.array([0.03, -0.05, 0.0]), np.array([0.3, 0.0, -0.4])


@pytest.fixture(scope="module")
def subject():
    return load_subject("hyperleg")


@pytest.fixture(scope="module")
def swaying(subject):
    """A base that turns by yaw psi(t), then pitch theta(t), and moves; its joints stand still."""
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata

    time = np.arange(0, 8, 0.005)
    yaw, yaw_rate = 0.4 * np.sin(time), 0.4 * np.cos(time)
    pitch, pitch_rate = 0.2 * np.sin(2 * time), 0.4 * np.cos(2 * time)
    zero, one = np.zeros_like(time), np.ones_like(time)
    about_z = np.array(
        [[np.cos(yaw), -np.sin(yaw), zero], [np.sin(yaw), np.cos(yaw), zero], [zero, zero, one]]
    )
    about_y = np.array(
        [
            [np.cos(pitch), zero, np.sin(pitch)],
            [zero, one, zero],
            [-np.sin(pitch), zero, np.cos(pitch)],
        ]
    )
    rotation = np.einsum("ijt,jkt->tik", about_z, about_y)
    spin = np.stack([-yaw_rate * np.sin(pitch), pitch_rate, yaw_rate * np.cos(pitch)], -1)
    turn = np.gradient(spin, time, axis=0, edge_order=2)
    velocity = np.stack(
        [0.3 * np.sin(3 * time), 0.2 * np.cos(2 * time), 0.1 * np.sin(5 * time)], -1
    )
    acceleration = np.stack(
        [0.9 * np.cos(3 * time), -0.4 * np.sin(2 * time), 0.5 * np.cos(5 * time)], -1
    )
    arm = subject.imu_position
    felt = (
        np.einsum("tji,tj->ti", rotation, acceleration + np.array([0, 0, 9.81]))
        + np.cross(turn, arm)
        + np.cross(spin, np.cross(spin, arm))
    )
    half = yaw / 2, pitch / 2
    quaternion = np.stack(
        [
            np.cos(half[0]) * np.cos(half[1]),
            -np.sin(half[0]) * np.sin(half[1]),
            np.cos(half[0]) * np.sin(half[1]),
            np.sin(half[0]) * np.cos(half[1]),
        ],
        -1,
    )
    rng = np.random.default_rng(1)
    channels = {
        "gyro": (spin @ subject.imu_rotation, "xyz", 2e-3),
        "accelerometer": (felt @ subject.imu_rotation, "xyz", 0.03),
        "base_orientation": (quaternion, "wxyz", 2e-4),
        "base_velocity": (velocity, "xyz", 3e-3),
    }
    signals = {
        f"{k}/{a}": v[:, i] + noise * rng.normal(size=len(time))
        for k, (v, axes, noise) in channels.items()
        for i, a in enumerate(axes)
    }
    for joint, angle in zip(
        subject.joints, 0.1 + 0.05 * np.arange(len(subject.joints)), strict=True
    ):
        signals[f"position/{joint}"] = angle + 1e-4 * rng.normal(size=len(time))
    signals |= {
        f"motor_torque/{motor}": 0.1 * rng.normal(size=len(time)) for motor in subject.motors
    }
    return Log("swaying", time, signals, Metadata(base="floating"))


def off(log, gyro=(0, 0, 0), felt=(0, 0, 0)):
    """A log whose IMU has errors."""
    added = {f"gyro/{a}": e for a, e in zip("xyz", gyro, strict=True)} | {
        f"accelerometer/{a}": e for a, e in zip("xyz", felt, strict=True)
    }
    return log.changed(signals={c: v + added.get(c, 0.0) for c, v in log.signals.items()})


def residuals(subject, log):
    """Of gyro and accelerometer at the ticks that count `(t, 3)` each."""
    signals = condition(log, subject)
    return {kind: signals.residual[kind][signals.valid] for kind in ("gyro", "accelerometer")}


def test_a_good_sensor_leaves_noise_alone(swaying, subject):
    left = residuals(subject, swaying)
    assert np.abs(left["gyro"].mean(0)).max() < 3e-4
    assert np.abs(left["accelerometer"].mean(0)).max() < 0.01
    assert left["gyro"].std(0) == pytest.approx(2e-3, rel=0.5)


def test_constant_errors_are_what_is_left(swaying, subject):
    left = residuals(subject, off(swaying, GYRO_OFF, FELT_OFF))
    np.testing.assert_allclose(left["gyro"].mean(0), GYRO_OFF, atol=3e-4)
    np.testing.assert_allclose(left["accelerometer"].mean(0), FELT_OFF, atol=0.01)


def test_the_sensors_own_axes_are_told(swaying, subject):
    """A sensor that is turned by a quarter tells the same motion in other columns, and its error in
    its own.
    """
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    log = swaying
    turned = {
        f"{kind}/{a}": (log.vector(kind) @ quarter)[:, i]
        for kind in ("gyro", "accelerometer")
        for i, a in enumerate("xyz")
    }
    moved = dataclasses.replace(subject, imu_rotation=subject.imu_rotation @ quarter)
    log = off(log.changed(signals={**log.signals, **turned}), GYRO_OFF)
    np.testing.assert_allclose(residuals(moved, log)["gyro"].mean(0), GYRO_OFF, atol=3e-4)


def rotated(log, kind, rotation):
    """A log whose vectors of a kind are turned, tick by tick or all alike."""
    values = np.einsum("...ij,...j->...i", rotation, log.vector(kind))
    return log.changed(
        signals={**log.signals, **{f"{kind}/{a}": v for a, v in zip("xyz", values.T, strict=True)}}
    )


def world_from_base(time):
    """Rotation of the swaying base `(t, 3, 3)`."""
    angles = np.stack([0.4 * np.sin(time), 0.2 * np.sin(2 * time)], -1)
    return Rotation.from_euler("ZY", angles).as_matrix()


TURN = np.array([0.03, -0.05, 0.0])


def test_a_vertical_that_leans_and_a_sensor_that_is_turned_leave_their_traces(swaying, subject):
    base = world_from_base(swaying.time)
    sensor = base @ subject.imu_rotation
    before = condition(swaying, subject)
    turn = Rotation.from_rotvec(TURN).as_matrix()

    def misfit(log, trace):
        told = condition(log, subject)
        change = told.residual["accelerometer"] - before.residual["accelerometer"]
        return np.abs((trace - change)[told.valid]).max()

    leaning = rotated(swaying, "accelerometer", sensor.swapaxes(1, 2) @ turn @ sensor)
    across = WEIGHED["leaning_vertical"].trace(before, "robot", np.eye(2))["accelerometer"]
    change = condition(leaning, subject).residual["accelerometer"]
    change = (change - before.residual["accelerometer"])[before.valid].ravel()
    columns = across[:, before.valid].reshape(2, -1).T
    angles, *_ = np.linalg.lstsq(columns, change, rcond=None)
    assert np.linalg.norm(angles) == pytest.approx(np.linalg.norm(TURN), rel=0.02)
    assert np.abs(columns @ angles - change).max() < 0.15  # accelerations turn with gravity
    turned = rotated(swaying, "accelerometer", turn.T)
    trace = WEIGHED["turned_imu"].trace(before, "imu", TURN[None])["accelerometer"][0]
    assert misfit(turned, trace) < 0.03 < 0.5 < np.abs(trace).max()


def test_errors_leave_the_trace_of_the_effect(swaying, subject):
    signals = condition(swaying, subject)
    values = np.array([*GYRO_OFF, *FELT_OFF])
    trace = effect("imu_bias").trace(signals, "imu", values[None])
    np.testing.assert_allclose(trace["gyro"][0, 100], GYRO_OFF)
    np.testing.assert_allclose(trace["accelerometer"][0, 100], FELT_OFF)


@pytest.mark.parametrize(
    ("lacking", "left"),
    [
        ("base_orientation", set()),
        ("gyro", {"accelerometer"}),
        ("base_velocity", {"gyro"}),
        ("accelerometer", {"gyro"}),
    ],
)
def test_a_sensor_that_nothing_tells_of_has_no_residual(swaying, subject, lacking, left):
    less = swaying.changed(
        signals={c: v for c, v in swaying.signals.items() if not c.startswith(f"{lacking}/")}
    )
    assert condition(less, subject).residual.keys() & {"gyro", "accelerometer"} == left
