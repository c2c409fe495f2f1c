import dataclasses

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.filtering import sieve
from hyperleg_design.gap.floor import expected
from hyperleg_design.gap.thresholds import load_thresholds


@pytest.fixture(scope="module")
def one(robot_files):
    signals = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]
    return sieve(signals)


def noise_of(one, floors, row):
    band, _, _ = one.labels(row)
    return {b: float(np.sqrt(np.mean(floors[row][band == b] ** 2))) for b in np.unique(band).tolist()}


def test_white_torque_noise_is_told_from_the_log_itself(one):
    nothing = dataclasses.replace(load_thresholds(), floor_torque=0, floor_friction=0, floor_turning=0, floor_leak=0)
    rng = np.random.default_rng(0)
    level = 0.3
    noisy = dataclasses.replace(one.signals, residual={"motion": level * rng.normal(size=one.signals.residual["motion"].shape)})
    noisy_sieve = sieve(noisy)
    floors = expected(noisy_sieve, nothing)
    band, _, _ = noisy_sieve.labels(0)
    values = noisy_sieve.sample(0, noisy.residual["motion"][:, 0][None])[0]
    for b in np.unique(band).tolist()[1:]:
        real = np.sqrt(np.mean(values[band == b] ** 2))
        # interpolation onto even ticks is allowed for, and noise of accelerations comes on top
        assert 0.9 * real < noise_of(noisy_sieve, floors, 0)[b] < 1.6 * real


def test_a_worse_known_torque_raises_the_floor(one):
    rules = load_thresholds()
    low = expected(one, rules)
    high = expected(one, dataclasses.replace(rules, floor_torque=10 * rules.floor_torque))
    for a, b in zip(low, high, strict=True):
        assert np.all(a > 0)
        assert np.all(b >= a)
    assert high[0].mean() > 1.2 * low[0].mean()
