"""Constant errors of an IMU, on a base that sways as formulas say: what its sensors feel is derived
here, by nothing of the package.
"""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hyperleg_design.gap.inference.detectors.imu_offset import imu_offset
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


def still_base(log, subject):
    """The same log of a base that does not move."""
    felt = np.array([0.0, 0.0, 9.81]) @ subject.imu_rotation
    rest = {
        "gyro": (0, 0, 0),
        "accelerometer": felt,
        "base_orientation": (1, 0, 0, 0),
        "base_velocity": (0, 0, 0),
    }
    rng, signals = np.random.default_rng(2), dict(log.signals)
    for kind, values in rest.items():
        axes = "wxyz" if kind == "base_orientation" else "xyz"
        for axis, value in zip(axes, values, strict=True):
            signals[f"{kind}/{axis}"] = value + 1e-3 * rng.normal(size=len(log.time))
    return log.changed(signals=signals)


def off(log, gyro=(0, 0, 0), felt=(0, 0, 0)):
    """A log whose IMU has errors."""
    added = {f"gyro/{a}": e for a, e in zip("xyz", gyro, strict=True)} | {
        f"accelerometer/{a}": e for a, e in zip("xyz", felt, strict=True)
    }
    return log.changed(signals={c: v + added.get(c, 0.0) for c, v in log.signals.items()})


def found(subject, *logs, references=()):
    return imu_offset(
        [condition(one, subject) for one in logs], [condition(one, subject) for one in references]
    )


def test_a_good_sensor_has_none(swaying, subject):
    assert found(subject, swaying) is None


def test_both_errors_are_found_with_their_intervals(swaying, subject):
    one = found(subject, off(swaying, GYRO_OFF, FELT_OFF))
    for kind, error in (("gyro", GYRO_OFF), ("accelerometer", FELT_OFF)):
        for axis, true in zip("xyz", error, strict=True):
            value = one.parameters[f"{kind}_{axis}"]
            assert value.value == pytest.approx(true, abs=0.002 if kind == "gyro" else 0.02)
            assert value.low <= value.value <= value.high
    assert one.kind == "gyro"
    assert one.size == pytest.approx(np.linalg.norm(GYRO_OFF), rel=0.05)
    assert one.closed > 0.9


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
    one = imu_offset(
        [condition(off(log.changed(signals={**log.signals, **turned}), GYRO_OFF), moved)]
    )
    assert [one.parameters[f"gyro_{a}"].value for a in "xyz"] == pytest.approx(GYRO_OFF, abs=0.002)


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


def test_a_vertical_that_leans_is_not_blamed_on_the_accelerometer(swaying, subject):
    """Nor is a sensor that is turned against the base."""
    tilt = Rotation.from_rotvec([0.03, -0.05, 0.0]).as_matrix()
    base = world_from_base(swaying.time)
    sensor = base @ subject.imu_rotation
    for rotation in (sensor.swapaxes(1, 2) @ tilt @ sensor, tilt):
        told = found(subject, rotated(swaying, "accelerometer", rotation))
        assert told.leans == pytest.approx(np.hypot(0.03, 0.05), rel=0.1)
        assert "leans by 0.05" in told.sentence
    slight = Rotation.from_rotvec([0.006, 0.0, 0.0]).as_matrix()
    assert found(subject, rotated(swaying, "accelerometer", slight)) is None


def test_what_stays_in_the_sensor_while_the_base_turns_is_no_leaning_vertical(swaying, subject):
    told = found(subject, off(swaying, felt=(0.5, 0.3, 0.0)))
    assert told.leans == 0
    assert told.kind == "accelerometer"
    # of a base that stands still, both feel the same
    still = still_base(swaying, subject)
    assert found(subject, off(still, felt=(0.5, 0.3, 0.0))).leans == pytest.approx(
        np.hypot(0.5, 0.3) / 9.81, rel=0.1
    )
    assert found(subject, off(still, felt=(0.5, 0.3, 0.4))).leans == 0


def test_a_log_of_two_seconds_is_enough(swaying, subject):
    short = swaying.changed(
        time=swaying.time[:400], signals={c: v[:400] for c, v in swaying.signals.items()}
    )
    one = found(subject, off(short, felt=(0.5, 0.0, 0.0)))
    assert one.parameters["accelerometer_x"].value == pytest.approx(0.5, abs=0.02)
    assert found(subject, short) is None


def test_errors_as_usual_and_those_of_references_are_no_news(swaying, subject):
    log = swaying
    assert found(subject, off(log, gyro=(0.002, 0, 0), felt=(0.03, 0, 0.03))) is None
    assert found(subject, off(log, GYRO_OFF), references=[off(log, GYRO_OFF)]) is None
    assert found(subject, off(log, GYRO_OFF), references=[log]) is not None


@pytest.mark.parametrize("lacking", ["base_orientation", "gyro"])
def test_without_both_nothing_is_said(swaying, subject, lacking):
    log = off(swaying, GYRO_OFF)
    less = log.changed(
        signals={c: v for c, v in log.signals.items() if not c.startswith(f"{lacking}/")}
    )
    assert found(subject, less) is None


def test_an_error_is_a_finding_from_three_usual_ones_on(swaying, subject):
    """Of 0.003 rad/s and 0.05 m/s^2, by which calibrated sensors differ from session to session."""
    assert found(subject, off(swaying, gyro=(0.007, 0, 0), felt=(0, 0, 0.11))) is None
    assert found(subject, off(swaying, gyro=(0.012, 0, 0))).kind == "gyro"
    assert found(subject, off(swaying, felt=(0, 0, 0.2))).kind == "accelerometer"
    both = found(
        subject, off(swaying, gyro=(0.012, 0, 0)), references=[off(swaying, (0.006, 0, 0))]
    )
    assert both is None
