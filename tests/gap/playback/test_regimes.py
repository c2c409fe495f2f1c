"""What a joint does at each tick, on waves whose regimes are known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from hyperleg_design.gap.playback.regimes import REVERSAL, STILL, regimes_of

STEP = 0.005


def signals(time, position, velocity):
    return SimpleNamespace(
        time=time,
        step=STEP,
        voltage=None,
        touching=None,
        position=position,
        velocity=velocity,
        subject=SimpleNamespace(joint_from_motor=np.array([[2.0]])),
    )


def wave():
    time = np.arange(0, 4, STEP)
    return time, np.sin(np.pi * time)[:, None], (np.pi * np.cos(np.pi * time))[:, None]


def test_each_tick_stands_still_or_moves_one_way():
    time, position, velocity = wave()
    regimes = regimes_of(signals(time, position, velocity), "joint", ("j",), None)
    count = sum(regimes[name].astype(int) for name in ("still", "forward", "backward"))
    assert np.all(count == 1)
    assert np.all(np.abs(velocity[regimes["still"]]) < STILL)
    moving = ~regimes["still"]
    assert abs(regimes["slow"][moving].mean() - 0.5) < 0.005
    assert np.all(regimes["slow"][moving] != regimes["fast"][moving])


def test_reversals_are_around_the_changes_of_direction():
    time, position, velocity = wave()
    found = regimes_of(signals(time, position, velocity), "joint", ("j",), None)["reversal"]
    distance = np.abs(time[:, None] - np.array([0.5, 1.5, 2.5, 3.5])).min(1)
    assert np.all(found[distance < REVERSAL / 2 - 2 * STEP, 0])
    assert not np.any(found[distance > REVERSAL / 2 + 2 * STEP, 0])


def test_loads_and_postures_are_split_in_halves_column_by_column():
    time, position, _ = wave()
    both = np.concatenate([position, 10 + position], 1)
    regimes = regimes_of(signals(time, both, 0 * both), "joint", ("a", "b"), both)
    for name in ("light load", "low posture"):
        np.testing.assert_allclose(regimes[name].mean(0), 0.5, atol=0.01)


def test_a_battery_counts_only_where_it_changes():
    time, position, velocity = wave()
    known = signals(time, position, velocity)
    known.voltage = np.full(len(time), 24.0)
    assert "low voltage" not in regimes_of(known, "joint", ("j",), None)
    known.voltage = np.linspace(24, 20, len(time))
    found = regimes_of(known, "joint", ("j",), None)
    assert found["low voltage"].shape == (len(time), 1)
    assert found["low voltage"][-1, 0]
    assert found["high voltage"][0, 0]


def test_a_motor_turns_as_its_joint_and_a_foot_neither_turns_nor_reverses():
    time, position, velocity = wave()
    made = signals(time, position, velocity)
    forward = regimes_of(made, "motor", ("m",), None)["forward"]
    np.testing.assert_array_equal(forward, 2 * velocity >= STILL)
    assert not regimes_of(made, "foot", ("f",), None)
