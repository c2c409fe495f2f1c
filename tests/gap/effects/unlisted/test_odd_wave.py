from dataclasses import replace

import numpy as np
from pendulum import Wrong

from hyperleg_design.gap.effects import WEIGHED

WAVE = WEIGHED["odd_wave"]


def with_torque(signals, torque):
    return replace(signals, residual={"motion": signals.residual["motion"] + torque[:, None]})


def test_it_finds_both_orders_of_a_ripple_in_proportion_to_the_load(pendulum):
    signals = pendulum(Wrong())
    angle, load = signals.position[:, 0], np.nan_to_num(signals.rigid[:, 0])
    bent = with_torque(signals, load * (0.1 * np.sin(9 * angle) + 0.05 * np.cos(23 * angle)))
    motor = WAVE.variants(bent, "swing")[0]
    assert motor[4] == 9.0
    assert abs(motor[5] - 23.0) <= 1  # the pendulum swings over a part of a turn


def test_it_finds_the_frequency_of_a_push(pendulum):
    signals = pendulum(Wrong())
    time = WAVE.variants(
        with_torque(signals, 0.2 * np.sin(2 * np.pi * 3.1 * signals.time)), "swing"
    )[1]
    span = signals.time[-1] - signals.time[0]
    assert abs(time[4] / (2 * np.pi) - 3.1) < 1 / span


def test_waves_of_the_motor_grow_with_the_load(pendulum):
    signals = pendulum(Wrong())
    values = np.array([0.0, 1.0, 0.0, 0.0, 5.0, 7.0, 0.0])
    (found,) = WAVE.trace(signals, "swing", values)["motion"]
    load = np.nan_to_num(signals.rigid[:, 0])
    wave = np.sin(5 * signals.position[:, 0])
    np.testing.assert_allclose(found[:, 0], load / np.sqrt(np.mean(load**2)) * wave, atol=1e-12)


def test_its_sentence_says_how_often_the_larger_wave_repeats():
    push = np.array([0.0, 0.1, 0.3, 0.4, 2 * np.pi * 9, 2 * np.pi * 2.3, 1.0])
    assert WAVE.describe(push) == "takes a torque that repeats with time, at 2.3 Hz"
    ripple = np.array([0.0, 1.0, 0.0, 0.2, 5.0, 7.0, 0.0])
    assert WAVE.describe(ripple).endswith("with the angle of its motor, 5 times a turn")
