"""What motors can give is what the envelope of sizing says."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation.drives.limits import Limits, limited
from hyperleg_design.sizing.envelope import clip_torque, motor_envelope


def test_limits_clip_as_the_envelope_does(design):
    envelope = motor_envelope(design)
    rng = np.random.default_rng(0)
    motors = len(envelope.peak_torque)
    torque, speed = (
        rng.uniform(-3, 3, (400, motors)) * envelope.peak_torque,
        rng.uniform(-2, 2, (400, motors)) * envelope.no_load_speed,
    )
    limits = Limits(envelope.no_load_speed, envelope.stall_torque, envelope.peak_torque)
    np.testing.assert_allclose(
        limits.clip(torque, speed), clip_torque(envelope, torque, speed), rtol=1e-12
    )


def test_limits_that_nobody_knows_do_not_limit():
    free = np.full(2, np.inf)
    torque = np.array([[1e6, -1e6]])
    np.testing.assert_array_equal(
        Limits(free, free, free).clip(torque, np.array([[5.0, -3.0]])), torque
    )
    np.testing.assert_array_equal(
        Limits(free, free, np.array([3.0, 4.0])).clip(torque, np.zeros((1, 2))), [[3.0, -4.0]]
    )


def test_the_line_of_a_weak_battery_has_less_torque_at_all_speeds():
    """Stall torque 10 Nm and no-load speed 5 rad/s, at four fifths of the voltage."""
    speed = np.array([0.0, 2.0, 4.0, -2.0])
    given = limited(np.full(4, 100.0), speed, 9.0, 10.0, 5.0, voltage=0.8)
    assert given == pytest.approx([8.0, 4.0, 0.0, 9.0])


def test_torques_that_jump_within_a_time_are_limited_before_they_are_averaged():
    rng = np.random.default_rng(3)
    torque, jump, speed = rng.uniform(-12, 12, (3, 500))
    line = speed, 9.0, 10.0, 5.0, 0.9
    halves = limited(np.stack([torque - jump, torque + jump]), *line)
    found = limited(torque, *line, jump)
    np.testing.assert_allclose(found, halves.mean(0), atol=1e-12)
    np.testing.assert_array_equal(limited(torque, *line, 0 * jump), limited(torque, *line))
    assert not np.allclose(found, limited(torque, *line), atol=1)
