from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from pendulum import Wrong, steps

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.joints.friction import JointFriction
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.resting import sticking
from hyperleg_design.simulation.drives.machine import Machine


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


@pytest.mark.parametrize("name", ["coulomb_friction", "viscous_friction"])
def test_less_than_in_the_references_may_be_more_than_the_model_has_to_lose(name):
    subject, joint = load_subject("hyperleg"), "left_knee"
    bare = replace(
        subject, coulomb=np.zeros_like(subject.coulomb), viscous=np.zeros_like(subject.viscous)
    )
    friction = effect(name)
    assert np.array_equal(friction.change_bounds(joint, subject), friction.bounds(joint, subject))
    assert friction.bounds(joint, bare)[0, 0] == 0.0
    low, high = friction.change_bounds(joint, bare)
    assert low[0] == -high[0] < 0
