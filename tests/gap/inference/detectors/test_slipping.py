"""Feet that slide, on a base that is pushed to and fro with its joints still: forces and ways are
formulas, by nothing of the package.
"""

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.slipping import slips
from hyperleg_design.gap.inference.rules import GroundRules
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject

RULES = GroundRules()
LOAD = 60.0
"""On each pad [N]."""


@pytest.fixture(scope="module")
def subject():
    return load_subject("hyperleg")


def pushed(subject, ratio, name="pushed", *, speed=0.06, by_foot=False, lacking=(), seed=1):
    """A log of a base that goes round in bursts, its pads pushed back with `ratio(speed, angle)`
    times their load [-].
    """
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata

    rng = np.random.default_rng(seed)
    time = np.arange(0, 8, 0.005)
    angle = 2 * np.pi * 0.23 * time + seed
    fast = speed * np.clip(np.sin(2 * np.pi * 0.4 * time), 0, None) ** 2
    velocity = np.stack([fast * np.cos(angle), fast * np.sin(angle), np.zeros_like(time)], -1)
    place = np.cumsum(velocity, 0) * 0.005
    channels = {
        "gyro": (np.zeros((len(time), 3)), "xyz", 2e-3),
        "accelerometer": (
            np.gradient(velocity, time, axis=0) + np.array([0, 0, 9.81]),
            "xyz",
            0.03,
        ),
        "base_orientation": (np.tile([1.0, 0, 0, 0], (len(time), 1)), "wxyz", 1e-5),
        "base_velocity": (velocity, "xyz", 2e-3),
        "base_position": (place + np.array([0, 0, 0.8]), "xyz", 2e-4),
    }
    signals = {
        f"{kind}/{axis}": values[:, i] + noise * rng.normal(size=len(time))
        for kind, (values, axes, noise) in channels.items()
        if kind not in lacking
        for i, axis in enumerate(axes)
    }
    share = ratio(fast, angle)
    push = np.stack([-share * np.cos(angle), -share * np.sin(angle), np.ones_like(time)], -1) * LOAD
    for foot, name_of_foot in enumerate(subject.feet):
        own = [p.name for p in subject.pads if p.foot == foot]
        for pad in (name_of_foot,) if by_foot else own:
            force = (len(own) if by_foot else 1) * push
            signals |= {
                f"contact_force/{pad}_{a}": force[:, i] + 0.5 * rng.normal(size=len(time))
                for i, a in enumerate("xyz")
            }
    for joint, rest in zip(subject.joints, subject.default, strict=True):
        signals[f"position/{joint}"] = rest + 1e-4 * rng.normal(size=len(time))
    signals |= {
        f"motor_torque/{motor}": 0.1 * rng.normal(size=len(time)) for motor in subject.motors
    }
    return Log(name, time, signals, Metadata(base="floating"))


def dry(coefficient):
    """Sticking below 5 mm/s, sliding above."""
    return lambda speed, angle: coefficient * np.minimum(speed / 0.005, 1.0)


def test_what_moves_at_one_speed_alone_may_creep(subject):
    """A tangential force that grows with the speed, of a base that is hardly ever faster than its
    contacts must be: one ratio, and no slip.
    """

    def creeping(speed, angle):
        return 0.23 * speed / 0.018

    slow = condition(pushed(subject, creeping, speed=0.018), subject)
    assert slips([slow], (), RULES) == ()
    assert slips([condition(pushed(subject, dry(0.23)), subject)], (), RULES)


def pyramid(coefficient):
    """Friction as in a simulator whose cone is a pyramid with edges along x and y."""
    return lambda speed, angle: (
        dry(coefficient)(speed, angle) / (np.abs(np.cos(angle)) + np.abs(np.sin(angle)))
    )


def found(subject, *logs, references=()):
    return slips(
        [condition(one, subject) for one in logs],
        [condition(one, subject) for one in references],
        RULES,
    )


@pytest.mark.parametrize("by_foot", [False, True])
@pytest.mark.parametrize("coefficient", [0.4, 0.65, 1.5])
def test_feet_that_slide_tell_their_ground(subject, coefficient, by_foot):
    told = found(subject, pushed(subject, dry(coefficient), by_foot=by_foot))
    assert {one.foot for one in told} == set(subject.feet)
    for one in told:
        scale = one.parameters["scale"]
        assert scale.low < coefficient < scale.high
        assert scale.value == pytest.approx(coefficient, rel=0.02)
        assert one.closed > 0.9
        assert "times its load" in one.sentence


def test_a_ground_as_it_should_be_is_no_finding(subject):
    assert found(subject, pushed(subject, dry(1.0))) == ()
    assert found(subject, pushed(subject, dry(0.9))) == ()


def test_the_pyramid_of_a_simulator_is_no_slippery_ground(subject):
    assert found(subject, pushed(subject, pyramid(1.0))) == ()


def test_a_slippery_pyramid_is_told_by_its_edges_through_the_noise_of_its_forces(subject):
    """Of small loads the ratio is noise, and across the edges of the pyramid it is another one."""
    slippery = pyramid(0.15)

    def noisy(speed, angle):
        noise = np.random.default_rng(4).standard_normal(len(speed))
        return slippery(speed, angle) * (1 + 0.08 * noise)

    slid = found(subject, pushed(subject, noisy))
    assert {foot.foot for foot in slid} == set(subject.feet)
    for foot in slid:
        scale = foot.parameters["scale"]
        assert scale.low < 0.15 < scale.high


def test_what_creeps_in_proportion_to_its_force_does_not_slide(subject):
    assert found(subject, pushed(subject, lambda speed, angle: 8.0 * speed)) == ()


def test_a_foot_that_stands_says_nothing(subject):
    assert found(subject, pushed(subject, dry(0.4), speed=0.01)) == ()


def test_a_ground_that_the_healthy_robot_slid_on_is_no_news(subject):
    log, same, better = (pushed(subject, dry(c), seed=s) for c, s in ((0.5, 1), (0.5, 2), (0.8, 3)))
    assert found(subject, log, references=[same]) == ()
    told = found(subject, log, references=[better])
    assert told[0].parameters["scale"].value == pytest.approx(0.5 / 0.8, rel=0.03)


def test_two_logs_foretell_each_other(subject):
    told = found(subject, pushed(subject, dry(0.5), seed=1), pushed(subject, dry(0.5), seed=2))
    assert all(one.closed > 0.9 for one in told)
    assert len(told) == len(subject.feet)
    assert (
        found(subject, pushed(subject, dry(0.3), seed=1), pushed(subject, dry(0.6), seed=2)) == ()
    )


def test_without_the_bases_velocity_nothing_is_said(subject):
    assert (
        found(subject, pushed(subject, dry(0.4), lacking=("base_velocity", "base_position"))) == ()
    )
