import numpy as np
import pytest

from hyperleg_design.gap.signals.smoothing import bridged, estimate_noise, lateness, smooth


def chirp(time):
    phase, frequency = 2 * np.pi * (0.1 * time + 0.05 * time**2), 2 * np.pi * (0.1 + 0.1 * time)
    return (
        0.4 * np.sin(phase),
        0.4 * frequency * np.cos(phase),
        -0.4 * frequency**2 * np.sin(phase) + 0.4 * 0.2 * np.pi * np.cos(phase),
    )


@pytest.mark.parametrize(("rate", "worst"), [(50, 0.02), (100, 0.015), (200, 0.015)])
def test_quantised_positions_give_accelerations(rate, worst):
    rng = np.random.default_rng(0)
    time = np.arange(20 * rate) / rate
    sampled = time + rng.uniform(-0.2, 0.2, len(time)) / rate
    rounded = np.round(chirp(sampled)[0] / 1.5e-3) * 1.5e-3
    found = smooth(sampled, rounded[:, None], time)
    inner = slice(rate // 2, -rate // 2)
    for part, truth in zip((found.value, found.first, found.second), chirp(time), strict=True):
        assert np.sqrt(np.mean((part[inner, 0] - truth[inner]) ** 2)) < worst * np.std(truth[inner])


def test_nothing_is_late():
    time = np.arange(4000) / 200
    noisy = chirp(time)[0] + np.random.default_rng(1).normal(0, 1e-3, 4000)
    found, truth = smooth(time, noisy[:, None], time).second[200:-200, 0], chirp(time)[2][200:-200]
    jerk = np.gradient(truth, 0.005)
    delay = -np.sum((found - truth) * jerk) / np.sum(jerk**2)
    assert abs(delay) < 0.02 * 0.005


def test_noise_is_told_from_the_samples():
    time = np.arange(6000) / 200
    for level in (1e-4, 1e-3, 1e-2):
        noisy = chirp(time)[0] + np.random.default_rng(2).normal(0, level, 6000)
        assert estimate_noise(time, noisy, 0.005, 3).level == pytest.approx(level, rel=0.1)


def test_logged_velocity_helps_where_it_agrees_and_is_left_out_where_it_is_late():
    time = np.arange(4000) / 200
    rng = np.random.default_rng(3)
    position = np.round(chirp(time)[0] / 1.5e-3) * 1.5e-3
    truth = chirp(time)

    def error(rate):
        found = smooth(time, position[:, None], time, None if rate is None else rate[:, None])
        return np.sqrt(np.mean((found.second[200:-200, 0] - truth[2][200:-200]) ** 2))

    assert error(truth[1] + rng.normal(0, 0.005, 4000)) < error(None)
    assert error(chirp(time - 0.02)[1]) == pytest.approx(error(None), rel=1e-6)


def test_gaps_are_bridged_and_silent_channels_unknown():
    time = np.arange(2000) / 200
    value = np.stack([chirp(time)[0], np.full(2000, np.nan)], 1)
    value[800:830, 0] = np.nan
    found = smooth(time, value, time)
    assert np.isfinite(found.value[:, 0]).all()
    assert np.abs(found.value[:, 0] - chirp(time)[0]).max() < 0.02
    assert np.isnan(found.value[:, 1]).all()


def test_a_polynomial_stays_what_it_is():
    time = np.arange(500) * 0.01
    found = smooth(time, (1 + 2 * time - 0.5 * time**2)[:, None], time)
    np.testing.assert_allclose(found.second[:, 0], -1.0, atol=1e-3)
    np.testing.assert_allclose(found.first[:, 0], 2 - time, atol=1e-4)


def test_a_constant_channel_has_no_velocity():
    time = np.arange(500) * 0.01
    found = smooth(time, np.full((500, 1), 0.7), time)
    np.testing.assert_allclose(found.first, 0, atol=1e-9)
    np.testing.assert_allclose(found.value, 0.7, atol=1e-9)


def test_unknown_ticks_are_bridged_and_ends_held():
    assert bridged(np.array([np.nan, 1.0, np.nan, 3.0, np.nan])).tolist() == [
        1.0,
        1.0,
        2.0,
        3.0,
        3.0,
    ]
    whole = np.arange(4.0)
    assert bridged(whole) is whole


def test_a_late_velocity_is_taken_at_its_time():
    """As simulators step speeds before places: half a step late, which differs little enough to be
    believed.
    """
    time = np.arange(2000) * 0.005
    place, speed = (
        np.sin(3 * time) + 0.2 * np.sin(11 * time),
        3 * np.cos(3 * time) + 2.2 * np.cos(11 * time),
    )
    felt = -9 * np.sin(3 * time) - 24.2 * np.sin(11 * time)
    late = 3 * np.cos(3 * (time - 0.0025)) + 2.2 * np.cos(11 * (time - 0.0025))
    assert lateness(late - speed, felt) == pytest.approx(0.0025, rel=0.02)
    away = slice(100, -100)
    for rate in (speed, late):
        found = smooth(time, place[:, None], time, rate[:, None])
        assert np.abs(found.first[away, 0] - speed[away]).max() < 2e-3
        assert np.abs(found.second[away, 0] - felt[away]).max() < 0.1
