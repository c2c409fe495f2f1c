"""Which way joints slide."""

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.signals.limit_cycle import PRESLIDING
from hyperleg_design.gap.signals.sliding import (
    dry_friction,
    presliding,
    sliding,
    viscous_friction,
)


class Shown:
    """Stands for `Signals`, and may be a key as these."""

    def __init__(self, **values):
        vars(self).update(values)


def shown(position, noise=0.0, bandwidth=100.0):
    position = np.asarray(position, float)[:, None]
    return Shown(
        position=position,
        limit_cycle=None,
        step=0.005,
        noise=np.array([noise]),
        bandwidth=np.array([bandwidth]),
        subject=SimpleNamespace(joints=("swing",)),
    )


def test_sliding_is_the_sign_of_the_velocity_once_a_joint_has_moved():
    time = np.arange(2000) * 0.005
    found = sliding(shown(0.3 * np.sin(2 * time)))[:, 0]
    moving = np.abs(np.cos(2 * time)) > 0.1
    assert np.all(found[moving] == np.sign(np.cos(2 * time))[moving])


def test_sliding_sees_ramps_slower_than_the_noise_of_the_velocity():
    rng = np.random.default_rng(0)
    time = np.arange(4000) * 0.005
    ramp = np.where(time < 10, 2e-3 * time, 0.04 - 2e-3 * time)
    found = sliding(shown(ramp + rng.normal(0, 2e-4, time.size), noise=2e-4))[:, 0]
    late = (time > 2) & (np.abs(time - 10) > 2)
    assert np.mean(found[late] * np.where(time < 10, 1, -1)[late]) > 0.9


def test_sliding_is_kept_at_rest():
    time = np.arange(2000) * 0.005
    signals = shown(np.minimum(0.1 * time, 0.5))
    assert np.all(sliding(signals)[20:] == 1)


def test_presliding_grows_with_the_noise():
    assert presliding(shown(np.zeros(10)))[0] == PRESLIDING
    assert presliding(shown(np.zeros(10), noise=0.01))[0] > 5 * PRESLIDING


@pytest.mark.parametrize("friction", [0.9, 0.0])
@pytest.mark.parametrize("load", [0.0, 4.0])
def test_dry_friction_is_told_beside_a_rotor_and_a_load_that_the_model_lacks(friction, load):
    time = np.arange(4000) * 0.005
    position = 0.5 * np.sin(3 * time) + 0.2 * np.sin(7 * time)
    velocity = 1.5 * np.cos(3 * time) + 1.4 * np.cos(7 * time)
    acceleration = -4.5 * np.sin(3 * time) - 9.8 * np.sin(7 * time)
    signals = shown(position)
    signals.velocity, signals.acceleration = velocity[:, None], acceleration[:, None]
    signals.rigid = (2.0 * np.sin(position + 0.3) + 0.1 * acceleration)[:, None]
    signals.valid = np.ones(len(time), bool)
    signals.subject.coulomb = signals.subject.viscous = np.zeros(1)
    noise = np.random.default_rng(2).normal(0, 0.1, len(time))
    left = friction * np.sign(velocity) + 0.3 * acceleration + load * np.sin(position) + noise
    signals.resisting = left[:, None]
    assert dry_friction(signals)[0] == pytest.approx(friction, rel=0.05)
    assert viscous_friction(signals)[0] == pytest.approx(0.0, abs=0.08)
    signals = Shown(**vars(signals))
    signals.resisting = left[:, None] + 0.2 * friction * velocity[:, None]
    assert viscous_friction(signals)[0] == pytest.approx(0.2 * friction, abs=0.08)


def test_a_load_alone_is_no_dry_friction_and_the_friction_of_a_model_is_kept():
    time = np.arange(4000) * 0.005
    signals = shown(0.5 * np.sin(3 * time))
    signals.velocity = 1.5 * np.cos(3 * time)[:, None]
    signals.acceleration = -4.5 * np.sin(3 * time)[:, None]
    signals.rigid = np.zeros((len(time), 1))
    signals.valid = np.ones(len(time), bool)
    signals.resisting = 3.0 * np.cos(signals.position)
    signals.subject.coulomb = signals.subject.viscous = np.zeros(1)
    assert dry_friction(signals)[0] == viscous_friction(signals)[0] == 0.0
    signals = Shown(**vars(signals))
    signals.subject.coulomb = signals.subject.viscous = np.array([0.7])
    assert dry_friction(signals)[0] == viscous_friction(signals)[0] == 0.7
