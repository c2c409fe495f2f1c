"""A weak battery in a simulation."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.effects import effect

SAG = effect("voltage_sag")


def test_limits_follow_the_voltage_of_a_design_whose_line_is_known():
    from types import SimpleNamespace

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    ticks = 400
    volts = np.where(np.arange(ticks) < 40, 48.0, 0.9 * 48.0)
    speed = np.full(ticks, 0.85 * subject.no_load_speed[0])
    velocity = np.zeros((ticks, 14))
    velocity[:, 0] = speed / subject.joint_from_motor[0, 0]
    asked = np.zeros((ticks, 14))
    asked[:, 0] = 5.0
    signals = SimpleNamespace(
        supplied=np.ones((1, 14)),
        jump=None,
        subject=subject,
        velocity=velocity,
        motor_speed=velocity @ subject.joint_from_motor,
        command=asked,
        measured=None,
        believed=asked,
        voltage=volts,
        residual={"motion": velocity},
    )
    found = SAG.trace(signals, "battery", np.array([[1.0, 0.0, 10.0]]))["motion"][0]
    stall = subject.stall_torque[0]
    before, after = 5.0, stall * 0.05
    assert subject.torque_limit[0] > before > after
    assert stall * 0.15 > before
    np.testing.assert_allclose(found[40:, 0], 25 * (before - after), rtol=1e-6)
    assert np.all(found[:40] == 0)
    assert np.all(found[:, 1:] == 0)
