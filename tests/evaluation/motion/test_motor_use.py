"""Use of motors: edges of the envelope, RMS and heat of torques that are known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation.motion.motor_use import at_limit, motor_use
from hyperleg_design.sizing.envelope import clip_torque, motor_envelope


def test_clipped_torques_are_at_the_limit_and_others_are_not(design):
    envelope = motor_envelope(design)
    rng = np.random.default_rng(0)
    speed = rng.uniform(-1.2, 1.2, (500, 7)) * envelope.no_load_speed
    wanted = rng.uniform(-2, 2, (500, 7)) * envelope.peak_torque
    given = clip_torque(envelope, wanted, speed)
    assert np.array_equal(at_limit(envelope, given, speed), given != wanted)
    assert np.any(given != wanted)


def test_constant_torque_heats_as_the_formula_says(planned_trial):
    torque = np.full((2000, 14), 0.57)
    trial = dataclasses.replace(
        planned_trial, motor_torque=torque, motor_velocity=np.zeros((2000, 14))
    )
    use = motor_use(trial, 1000, 2000)
    assert use.rms_torque == pytest.approx(np.full(14, 0.57))
    ankle = use.continuous_use[4]
    assert ankle == pytest.approx(1.0, rel=1e-6)  # RI60 is rated 0.57 Nm
    assert use.thermal_peak[4] == pytest.approx(
        1 - np.exp(-10 / 3), rel=1e-9
    )  # heated since the start, not since the window
    assert use.thermal_peak_printed[4] == pytest.approx((1 - np.exp(-10 / 3)) ** 2, rel=1e-9)
    assert use.limit_share.tolist() == [0] * 14


def test_peaks_are_magnitudes_within_the_window(planned_trial):
    torque, speed = np.zeros((100, 14)), np.zeros((100, 14))
    torque[10, 2], torque[60, 2], speed[60, 9] = 4.0, -3.0, -120.0
    trial = dataclasses.replace(planned_trial, motor_torque=torque, motor_velocity=speed)
    use = motor_use(trial, 50, 100)
    assert use.peak_torque[2] == 3
    assert use.peak_speed[9] == 120
