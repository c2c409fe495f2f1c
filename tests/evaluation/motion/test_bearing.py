"""Tilt, heading, stops and vibration of motions that are known."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.motion import bearing


def quaternion(axis, angle):
    return np.r_[np.cos(angle / 2), np.sin(angle / 2) * np.asarray(axis, float)]


@pytest.mark.parametrize("angle", [0.0, 0.3, -1.2])
def test_tilt_is_the_angle_of_lean_whatever_the_heading(angle):
    assert bearing.tilt(quaternion([1, 0, 0], angle)) == pytest.approx(abs(angle), abs=1e-7)
    assert bearing.tilt(quaternion([0, 1, 0], angle)) == pytest.approx(abs(angle), abs=1e-7)
    assert bearing.tilt(quaternion([0, 0, 1], angle)) == pytest.approx(0, abs=1e-7)


def test_heading_and_whole_turns():
    angles = np.linspace(0, 7.5, 200)
    heading = bearing.headings(np.array([quaternion([0, 0, 1], a) for a in angles]))
    assert heading == pytest.approx(np.column_stack([np.cos(angles), np.sin(angles)]))
    assert bearing.turned(heading) == pytest.approx(7.5)
    assert bearing.turned(heading[::-1]) == pytest.approx(-7.5)


def test_stops_count_time_at_either_end():
    position = np.zeros((100, 2))
    position[:25, 0], position[25:40, 0] = -1.0, 0.999
    assert bearing.stop_share(position, [-1, -1], [1, 1]) == pytest.approx([0.4, 0.0])


def test_vibration_hears_fast_motion_only():
    time = np.arange(2000) * 0.005
    velocity = np.column_stack(
        [3 * np.sin(2 * np.pi * 2 * time), 3 * np.sin(2 * np.pi * 40 * time)]
    )
    found = bearing.vibration(velocity, 0.005)
    assert found[0] < 0.02
    assert found[1] == pytest.approx(3 / np.sqrt(2), rel=0.02)


def test_a_stop_absorbs_and_returns() -> None:
    """A spring stop of 100 Nm/rad with a damper: a half swing into it and out again."""
    step = 1e-4
    time = np.arange(0, np.pi / 10, step)
    past = 0.05 * np.sin(10 * time)
    position, velocity = 1.0 + past, 0.5 * np.cos(10 * time)
    torque = -100 * past - 2 * velocity
    measures = bearing.stop_measures(
        np.c_[position, 0 * time],
        np.c_[velocity, 0 * time],
        np.c_[torque, 0 * time],
        [-1, -1],
        [1, 1],
    )
    assert measures["stop_overshoot"] == pytest.approx(0.05, rel=1e-6)
    lost = measures["stop_absorbed_power"] - measures["stop_returned_power"]
    assert lost == pytest.approx(2 * 0.5**2 / 2, rel=1e-3)  # damper: mean of d v^2
    assert measures["stop_returned_power"] > 0
    unknown = bearing.stop_measures(np.c_[position], np.c_[velocity], None, [-1], [2])
    assert unknown["stop_overshoot"] == 0
    assert np.isnan(unknown["stop_absorbed_power"])
