"""The line of joints that chatter, on signals that are made up of known lines."""

from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.gap.signals.swing import Swing, band, rms, sharp, unfolded

STEP = 0.005
TIME = np.arange(2000) * STEP


def line(frequency, size, phase=0.0):
    return size * np.cos(2 * np.pi * frequency * TIME + phase)


def test_speed_over_swing_tells_which_frequency_a_rate_has_folded():
    assert unfolded(30.0, 100.0, 2 * np.pi * 62) == pytest.approx(70.0)
    assert unfolded(30.0, 100.0, 2 * np.pi * 29) == pytest.approx(30.0)
    assert unfolded(30.0, 100.0, 2 * np.pi * 48) is None


def test_a_band_is_the_amplitude_and_phase_of_its_line_and_leaves_others_out():
    values = np.stack([line(60, 0.3, 0.4) + line(8, 2.0), line(60, 0.1, -1.0) + line(90, 1.0)], -1)
    middle = band(values, STEP, 60.0)[200:-200]
    wave = np.exp(2j * np.pi * 60 * TIME)[200:-200, None]
    assert middle / wave == pytest.approx(
        np.broadcast_to([0.3 * np.exp(0.4j), 0.1 * np.exp(-1j)], middle.shape), abs=2e-3
    )
    assert rms(middle) == pytest.approx([0.3, 0.1], rel=1e-2)


def test_play_is_told_from_a_spring_by_the_third_harmonic_of_the_motor(robot_files):
    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject(robot_files["coupled"])
    count = len(subject.joints)
    angle = np.exp(2j * np.pi * 20 * TIME)[:, None] * np.ones(count)
    motors = range(len(subject.motors))
    sine = Swing(20.0, 20.0, angle, 0.01 * angle**3, False)
    assert not any(sharp(sine, subject, m) for m in motors)
    triangle = replace(sine, third=angle**3 / 9)
    assert all(sharp(triangle, subject, m) for m in motors)
    assert not any(sharp(replace(sine, third=-(angle**3) / 9), subject, m) for m in motors), (
        "rounded off at its turns, not knocked"
    )
    assert not any(sharp(replace(sine, third=angle / 9), subject, m) for m in motors), (
        "a line of its own"
    )
    assert all(
        sharp(replace(sine, third=np.conj(angle**3) / 9, folded=True), subject, m) for m in motors
    )
