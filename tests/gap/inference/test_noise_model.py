import dataclasses

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.noise_model import expected, of_load
from hyperleg_design.gap.inference.rules import NoiseRules
from hyperleg_design.gap.signals.filtering import filtered_log


@pytest.fixture(scope="module")
def one(robot_files):
    signals = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]
    return filtered_log(signals)


@pytest.fixture(scope="module")
def jittering(robot_files):
    return filtered_log(diagnosed.conditioned(robot_files["servos"], diagnosed.stamped_badly(0))[0])


def noise_of(one, floors, row):
    band, _, _ = one.labels(row)
    return {
        b: float(np.sqrt(np.mean(floors[row][band == b] ** 2))) for b in np.unique(band).tolist()
    }


def test_white_torque_noise_is_told_from_the_log_itself(one):
    nothing = NoiseRules(torque=0, friction=0, turning=0, leak=0)
    rng = np.random.default_rng(0)
    level = 0.3
    noisy = dataclasses.replace(
        one.signals,
        residual={"motion": level * rng.normal(size=one.signals.residual["motion"].shape)},
    )
    noisy_sieve = filtered_log(noisy)
    floors = expected(noisy_sieve, nothing)
    band, _, _ = noisy_sieve.labels(0)
    values = noisy_sieve.sample(0, noisy.residual["motion"][:, 0][None])[0]
    for b in np.unique(band).tolist()[1:]:
        real = np.sqrt(np.mean(values[band == b] ** 2))
        # interpolation onto even ticks is allowed for, and noise of accelerations comes on top
        assert 0.9 * real < noise_of(noisy_sieve, floors, 0)[b] < 1.6 * real


def test_what_rings_at_high_frequencies_is_no_noise_at_low_ones(one):
    nothing = NoiseRules(torque=0, friction=0, turning=0, leak=0)
    rng = np.random.default_rng(1)
    quiet = 0.05 * rng.normal(size=one.signals.residual["motion"].shape)
    rung = np.zeros_like(quiet)
    for frequency in np.linspace(25, 45, 400):  # a dense ringing above all bands
        rung += 0.03 * np.sin(
            2 * np.pi * frequency * one.signals.time[:, None] + rng.uniform(0, 2 * np.pi)
        )
    floors = []
    for residual in (quiet, quiet + rung):
        noisy = filtered_log(dataclasses.replace(one.signals, residual={"motion": residual}))
        floors.append(noise_of(noisy, expected(noisy, nothing), 0))
    low = sorted(floors[0])[1:3]
    assert all(floors[1][b] < 1.6 * floors[0][b] for b in low)


def test_a_worse_known_torque_raises_the_floor(one):
    rules = NoiseRules()
    low = expected(one, rules)
    high = expected(one, dataclasses.replace(rules, torque=10 * rules.torque))
    for a, b in zip(low, high, strict=True):
        assert np.all(a > 0)
        assert np.all(b >= a)
    assert high[0].mean() > 1.2 * low[0].mean()


def test_positions_stamped_early_or_late_are_noisier_where_joints_are_fast(jittering):
    signals, rules = jittering.signals, NoiseRules()
    even = filtered_log(
        dataclasses.replace(signals, velocity=np.ones_like(signals.velocity))
    )  # no tick faster than any other
    for row, (told, before) in enumerate(
        zip(expected(jittering, rules), expected(even, rules), strict=True)
    ):
        top = jittering.labels(row)[0] == jittering.labels(row)[0].max()
        shown = (
            jittering.sample(row, signals.residual["motion"][:, jittering.rows[row].column][None])[
                0
            ][top]
            ** 2
        )
        after, flat = (
            np.corrcoef(np.log(shown), np.log(floors[top]))[0, 1] for floors in (told, before)
        )
        assert after > flat + 0.1


def test_noise_of_one_joint_is_in_the_balances_of_those_that_it_shakes(jittering):
    signals, floors = jittering.signals, []
    for times in (1.0, 10.0):
        noisier = dataclasses.replace(signals, noise=signals.noise * np.array([1.0, times]))
        floors.append(expected(dataclasses.replace(jittering, signals=noisier), NoiseRules()))
    hip = next(i for i, row in enumerate(jittering.rows) if row.name == "hip")
    assert floors[1][hip].max() > 2 * floors[0][hip].max()


def test_noise_of_the_needed_torque_is_told_from_that_of_the_drives(one):
    row = next(i for i, r in enumerate(one.rows) if r.residual_name == "motion")
    joint, quiet = one.rows[row].column, of_load(one, row)
    noise = 0.3 * np.random.default_rng(3).standard_normal(len(one.signals.time))
    made = one.sample(row, noise[None])[0]
    needed, residual = one.signals.rigid.copy(), one.signals.residual["motion"].copy()
    residual[:, joint] -= noise
    of_drives = dataclasses.replace(one.signals, residual={"motion": residual})
    needed[:, joint] += noise
    of_forces = dataclasses.replace(of_drives, rigid=needed)
    told = [
        of_load(dataclasses.replace(one, signals=signals), row)
        for signals in (of_forces, of_drives)
    ]
    for band in np.unique(one.labels(row)[0]).tolist()[1:]:
        mine = one.labels(row)[0] == band
        added = np.mean(made[mine] ** 2)
        # interpolation onto even ticks is allowed for
        assert np.all((0.9 * added < told[0][mine]) & (told[0][mine] < 1.7 * added))
        assert np.all(told[1][mine] < 0.1 * added + quiet[mine])


def test_limits_that_limit_nothing_make_no_noise_of_drives(robot_files):
    (signals,) = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("limited", 0))
    endless = np.full(len(signals.subject.motors), 1e4)
    placeholders = dataclasses.replace(signals.subject, torque_limit=endless, stall_torque=endless)
    floors = []
    for subject in (signals.subject, placeholders):
        filtered = filtered_log(dataclasses.replace(signals, subject=subject))
        drives = [row for row, place in enumerate(filtered.rows) if place.residual_name == "drive"]
        assert drives
        floors.append(np.array([expected(filtered, NoiseRules())[row] for row in drives]))
    assert (floors[1] < 2 * floors[0]).all()
