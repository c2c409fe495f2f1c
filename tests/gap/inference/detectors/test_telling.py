from dataclasses import replace

import numpy as np
import pytest
import robots
from diagnosed import conditioned, run

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.detectors import telling


@pytest.fixture(scope="module")
def signals(robot_files):
    return conditioned(robot_files["coupled"], run("healthy", 0))


def warmed(signals, *degrees):
    count = len(signals[0].subject.motors)
    celsius = np.broadcast_to(
        np.resize(degrees, count).astype(float), (len(signals[0].time), count)
    )
    return [replace(one, temperature=celsius[: len(one.time)]) for one in signals]


def test_a_motor_that_is_much_warmer_than_others_rather_loses_torque_by_it(signals):
    subject = signals[0].subject
    assert len(subject.motors) >= 2, robots
    first = subject.motors[0]
    hot = np.full(len(subject.motors), 30.0)
    hot[0] = 75.0
    assert telling.odds("thermal_derating", first, warmed(signals, *hot)) == telling.WARM
    assert telling.odds("thermal_derating", subject.motors[1], warmed(signals, *hot)) == 0
    assert telling.odds("torque_constant", first, warmed(signals, *hot)) == 0


def test_cool_motors_and_those_of_a_warm_robot_and_unknown_ones_tell_nothing(signals):
    first = signals[0].subject.motors[0]
    for known in (warmed(signals, 40.0), warmed(signals, 75.0), warmed(signals, np.nan), signals):
        assert telling.odds("thermal_derating", first, known) == 0


def test_no_effect_but_two_has_odds_here(signals):
    subject = signals[0].subject
    for name, effect in EFFECTS.items():
        for place in effect.locations(subject):
            assert telling.odds(name, place, signals) == 0
