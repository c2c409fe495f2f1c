import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.sampling import (
    columns_of,
    held_rows,
    noise,
    quantum,
    sampling_of,
    saturation,
)


def test_even_clock():
    found = sampling_of(np.arange(1001) * 0.004)
    assert found.rate == pytest.approx(250)
    assert found.duration == pytest.approx(4)
    assert found.jitter == pytest.approx(0, abs=1e-9)
    assert found.dropouts == 0


def test_jitter_and_dropouts():
    rng = np.random.default_rng(1)
    steps = 0.01 * (1 + rng.normal(0, 0.1, 5000))
    steps[[100, 2000]] = 0.51
    found = sampling_of(np.concatenate([[0], np.cumsum(steps)]))
    assert found.jitter == pytest.approx(0.1, rel=0.1)
    assert found.dropouts == pytest.approx(1.0 / found.duration, rel=0.02)
    assert found.longest == pytest.approx(0.51)


def test_quantum_and_noise():
    rng = np.random.default_rng(1)
    t = np.arange(20000) * 0.005
    smooth = np.sin(2 * t)
    assert quantum(smooth) == 0
    step = 2 * np.pi / 4096
    rounded = np.round(smooth / step) * step
    assert quantum(rounded) == pytest.approx(step, rel=1e-6)
    assert quantum(rounded.astype("f4").astype(float)) == pytest.approx(step, rel=1e-3)
    assert noise(smooth + rng.normal(0, 0.01, len(t))) == pytest.approx(0.01, rel=0.05)
    assert noise(smooth) < 1e-5


def test_saturation():
    t = np.arange(4000) * 0.005
    wave = 3 * np.sin(7 * t)
    assert saturation(wave) == 0
    assert saturation(np.round(wave / 0.01) * 0.01) == 0
    clipped = np.clip(wave, -2, 10)
    assert saturation(clipped) == pytest.approx(np.mean(wave < -2), abs=0.01)
    assert saturation(np.clip(wave, -2, 2)) == pytest.approx(np.mean(np.abs(wave) > 2), abs=0.01)
    rest = np.concatenate([np.zeros(500), np.linspace(0, 5, 500), np.full(500, 5.0)])
    assert saturation(rest) == 0


def test_held_values():
    values = np.repeat(np.random.default_rng(0).normal(size=200), 4)
    assert held_rows(values) == 4
    assert held_rows(values[::4]) == 1
    assert held_rows(np.zeros(100)) == 1


def test_columns_at_rates_of_their_own():
    t = np.arange(2000) * 0.005
    slow = np.where(np.arange(2000) % 4 == 0, np.sin(t), np.nan)
    lost = np.where((t > 2) & (t < 3), np.nan, np.sin(t))
    signals = {
        "position/a": np.sin(t),
        "position/b": slow,
        "position/c": lost,
        "position/d": np.ones(2000),
        "position/e": np.full(2000, np.nan),
    }
    a, b, c, d, e = columns_of(Log("run", t, signals))
    assert (a.rate, a.missing) == (pytest.approx(200), 0)
    assert (b.rate, b.missing) == (pytest.approx(50), 0)
    assert c.missing == pytest.approx(0.1, abs=0.001)
    assert d.constant
    assert e.missing == 1
