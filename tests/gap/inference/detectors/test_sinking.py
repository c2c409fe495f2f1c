"""Feet that sink, on a base whose weight goes round on them: loads and heights are formulas, by
nothing of the package.
"""

import numpy as np
import pytest

from hyperleg_design.gap.inference.detectors.sinking import (
    Bearing,
    _apart,
    _compliance,
    bearings,
    sinks,
)
from hyperleg_design.gap.inference.rules import GroundRules
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.ground import footings
from hyperleg_design.gap.signals.loading import load_subject

RULES = GroundRules()
MEAN, CHANGE = 60.0, 25.0
"""Load of a pad and its amplitude [N]."""


@pytest.fixture(scope="module")
def subject():
    return load_subject("hyperleg")


def standing(subject, compliance, *, tilt=0.0, steady=False, seed=1):
    """A log of a base that goes up and down as each of its pads gives, `compliance` [m/N], under
    loads that change, and leans besides.
    """
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata

    rng = np.random.default_rng(seed)
    time = np.arange(0, 8, 0.005)
    compliance = np.broadcast_to(compliance, len(subject.pads))
    wave = (0.0 if steady else 1.0) * np.sin(2 * np.pi * 0.5 * time + seed)
    stiffest = max(float(compliance.min()), 1e-12)
    height = 0.8 - CHANGE * compliance.min() * wave
    pitch = tilt * np.sin(2 * np.pi * 0.31 * time)
    zero = np.zeros_like(time)
    channels = {
        "gyro": (np.stack([zero, np.gradient(pitch, time), zero], -1), "xyz", 2e-3),
        "accelerometer": (np.tile([0, 0, 9.81], (len(time), 1)), "xyz", 0.03),
        "base_orientation": (
            np.stack([np.cos(pitch / 2), zero, np.sin(pitch / 2), zero], -1),
            "wxyz",
            1e-5,
        ),
        "base_velocity": (np.stack([zero, zero, np.gradient(height, time)], -1), "xyz", 2e-3),
        "base_position": (np.stack([zero, zero, height], -1), "xyz", 1e-4),
    }
    signals = {
        f"{k}/{a}": v[:, i] + noise * rng.normal(size=len(time))
        for k, (v, axes, noise) in channels.items()
        for i, a in enumerate(axes)
    }
    for pad, own in zip(subject.pads, compliance, strict=True):
        force = np.stack(
            [zero, zero, MEAN + CHANGE * stiffest / max(own, 1e-12) * wave], -1
        ) + 0.5 * rng.normal(size=(len(time), 3))
        signals |= {f"contact_force/{pad.name}_{a}": force[:, i] for i, a in enumerate("xyz")}
    for joint, rest in zip(subject.joints, subject.default, strict=True):
        signals[f"position/{joint}"] = rest + 1e-4 * rng.normal(size=len(time))
    signals |= {
        f"motor_torque/{motor}": 0.1 * rng.normal(size=len(time)) for motor in subject.motors
    }
    return Log("standing", time, signals, Metadata(base="floating"))


@pytest.fixture(scope="module")
def nominal(subject):
    """Compliance of the model's own ground under each pad about these loads [m/N]."""
    log = condition(standing(subject, 0.0), subject)
    return np.array(
        [
            pad.nominal_slope
            for foot in range(len(subject.feet))
            for pad in bearings(log, foot, RULES)
        ]
    )


def found(subject, *logs, references=()):
    return sinks(
        [condition(one, subject) for one in logs],
        [condition(one, subject) for one in references],
        RULES,
    )


def test_the_nominal_slope_is_that_of_the_models_law(subject, nominal):
    foot = footings(condition(standing(subject, 0.0), subject))[0]
    alone = np.zeros((2, foot.height.shape[1])) - 1.0
    alone[:, 0] = np.array([1.0, 1.001]) * 0.0005
    pressed = foot.law.force(alone, np.zeros_like(alone))
    assert len(nominal) == len(subject.pads)
    assert np.all((nominal > 0) & (nominal < 1e-4))
    assert nominal[0] == pytest.approx(
        5e-7 / float(np.diff(pressed)[0]), rel=0.5
    )  # a law that bends


@pytest.mark.parametrize("softer", [2.5, 6.0])
def test_feet_that_sink_tell_how_much(subject, nominal, softer):
    told = found(subject, standing(subject, softer * nominal))
    assert {one.foot for one in told} == set(subject.feet)
    for one in told:
        scale = one.parameters["scale"]
        assert scale.value == pytest.approx(softer, rel=0.05)
        assert scale.low < softer < scale.high
        assert one.closed > 0.8
        assert "times as much as it should" in one.sentence


@pytest.mark.parametrize("softer", [0.0, 0.3, 1.0, 1.4])
def test_a_ground_as_it_should_be_or_stiffer_is_no_finding(subject, nominal, softer):
    assert found(subject, standing(subject, softer * nominal)) == ()


def test_a_load_that_does_not_change_says_nothing(subject, nominal):
    assert found(subject, standing(subject, 5 * nominal, steady=True)) == ()


def test_a_base_that_leans_besides_hides_nothing(subject, nominal):
    told = found(subject, standing(subject, 4 * nominal, tilt=0.003))
    assert [one.parameters["scale"].value for one in told] == pytest.approx([4.0, 4.0], rel=0.15)


def test_against_references_less_is_told_and_what_they_show_is_no_news(subject, nominal):
    logs = [standing(subject, 1.5 * nominal, seed=s) for s in (1, 2)]
    assert found(subject, *logs) == ()
    told = found(subject, *logs, references=[standing(subject, 0.5 * nominal, seed=3)])
    assert [one.parameters["scale"].value for one in told] == pytest.approx([3.0, 3.0], rel=0.1)
    assert (
        found(
            subject,
            standing(subject, 4 * nominal),
            references=[standing(subject, 4 * nominal, seed=3)],
        )
        == ()
    )


def test_two_logs_foretell_each_other(subject, nominal):
    assert all(
        one.closed > 0.8
        for one in found(subject, *(standing(subject, 4 * nominal, seed=s) for s in (1, 2)))
    )


def test_a_foot_with_one_pad_tells_by_stretches_of_its_log():
    """As the ball of a quadruped's leg, which is one pad in each log."""
    rng, time = np.random.default_rng(2), np.arange(0, 8, 0.005)
    load = MEAN + CHANGE * np.sin(2 * np.pi * 0.7 * time)
    height = 0.02 - 2e-5 * load + 2e-4 * rng.normal(size=len(time))
    sink = -np.gradient(height, time)
    pad = Bearing(load, height, sink, -1e-5 * load)
    assert _compliance([pad], RULES) is None
    stretches = _apart([pad], RULES)
    assert len(stretches) == RULES.contacts
    np.testing.assert_array_equal(np.concatenate([one.load for one in stretches]), load)
    scale, error = _compliance(stretches, RULES)
    assert scale == pytest.approx(2.0, abs=4 * error)
    assert error < 0.1
    still = np.where(time < 4, MEAN, load)
    assert len(_apart([Bearing(still, height, sink, -1e-5 * still)], RULES)) == RULES.contacts / 2
    assert _apart([pad] * RULES.contacts, RULES) == [pad] * RULES.contacts


def test_a_damped_ground_that_lags_behind_its_load_is_as_soft_as_it_is():
    """Slowly loaded at first, then in steps faster than the ground can follow."""
    rng, time = np.random.default_rng(3), np.arange(0, 12, 0.005)
    slow = MEAN + CHANGE * np.sin(2 * np.pi * 0.5 * time)
    steps = MEAN + CHANGE * np.sign(np.sin(2 * np.pi * 4 * time))
    load, compliance, lag = np.where(time < 8, slow, steps), 4e-5, 0.08
    height = np.empty_like(load)
    height[0] = -compliance * load[0]
    for i in range(1, len(load)):  # lag h' = -(h + compliance F)
        height[i] = height[i - 1] - 0.005 / lag * (height[i - 1] + compliance * load[i])
    sink = -np.gradient(height, time)
    height += 2e-4 * rng.normal(size=len(time))
    pad = Bearing(load, height, sink, -1e-5 * load)
    plain = load - load.mean()
    assert -(plain @ height) / (plain @ plain) < 0.9 * compliance
    scale, error = _compliance(_apart([pad], RULES), RULES)
    assert scale == pytest.approx(4.0, rel=0.05)
    assert error < 0.2
