from types import SimpleNamespace

import numpy as np
import pytest
from pendulum import Wrong, steps

from hyperleg_design.gap.effects.friction import PRESLIDING, JointFriction, presliding, sliding
from hyperleg_design.gap.signals.filtering import sticking
from hyperleg_design.simulation.alteration import Machine


class Shown:
    """Stands for `Signals`, and may be a key as these."""

    def __init__(self, **values):
        vars(self).update(values)


def shown(position, noise=0.0, bandwidth=100.0):
    position = np.asarray(position, float)[:, None]
    return Shown(
        position=position,
        chatter=None,
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


def test_holds_of_a_sticking_pendulum_rest(pendulum):
    signals = pendulum(Wrong(coulomb=0.5), target=steps)
    held = (signals.time > 2.8) & (signals.time < 3.8)
    assert sticking(signals)[held].all()


def test_friction_in_a_simulation_is_a_damping_that_gives_its_torque():
    one = np.ones(1)
    machine = Machine(
        ("a",),
        ("a",),
        np.eye(1),
        np.eye(1),
        one,
        one,
        0.1 * one,
        np.inf * one,
        np.inf * one,
        np.inf * one,
        0 * one,
        np.inf * one,
    )
    friction = JointFriction(
        "a", coulomb=np.array([1.0, 0.0]), viscous=0.5, breakaway=2.0, speed=0.1
    )
    assert friction.live is not None
    live = friction.live(friction, machine, 2, 0.001)
    tick = SimpleNamespace(velocity=np.array([[0.1], [-0.1]]), joint_torque=np.zeros((2, 1)))
    given = live.joint_damping(tick) * tick.velocity
    fall = 2.0 * np.exp(-1)
    assert given[:, 0] == pytest.approx([1 + fall + 0.05, -fall - 0.05], rel=1e-6)
