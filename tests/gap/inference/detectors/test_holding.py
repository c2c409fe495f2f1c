import dataclasses

import numpy as np
import pytest
import robots
from diagnosed import conditioned

from hyperleg_design.gap.inference.base import Prior
from hyperleg_design.gap.inference.detectors.holding import (
    AFOOT,
    OF_LOAD,
    OPEN,
    _unsure,
    calibrated,
    held,
    noticed,
)
from hyperleg_design.gap.inference.nuisance import NuisanceParameter
from hyperleg_design.gap.inference.preparation import prepare
from hyperleg_design.gap.inference.thresholds import load_thresholds
from hyperleg_design.gap.pipeline.diagnose import diagnose_signals

SERVO = robots.PENDULUM.replace(
    '<motor name="servo" joint="swing" ctrlrange="-3 3"/>',
    '<position name="servo" joint="swing" kp="8" kv="0.3" forcerange="-3 3"/>',
)


@pytest.fixture(scope="module")
def servo(tmp_path_factory):
    path = tmp_path_factory.mktemp("servo") / "servo.xml"
    path.write_text(SERVO)
    return path


def ramps(time):
    """Slow moves to and fro with holds between."""
    corners = np.array([0.0, 0.5, 0.5, -0.4, -0.4, 0.1, 0.1, 0.6, 0.6])
    return np.array([np.interp(time, np.arange(len(corners)) * 1.2, corners)])


def log(friction=0.0, mass=0.5, rotor=0.0, target=ramps, **metadata):
    """A servo that ramps, with dry friction [Nm] and a further rotor [kg m^2] at its joint and a
    mass at its end [kg].
    """
    text = SERVO.replace('damping="0.02"', f'damping="0.02" frictionloss="{friction}"').replace(
        'mass="0.5"', f'mass="{mass}"'
    )
    text = text.replace('armature="0.003"', f'armature="{0.003 + rotor}"')
    found = robots.servo_run(text, target, 10.0, **metadata)
    rng = np.random.default_rng(3)
    noise = {"position": 2e-5, "velocity": 2e-3, "motor_torque": 5e-3}
    return found.changed(
        signals={
            c: v + rng.normal(0, noise.get(c.partition("/")[0], 0.0), len(v))
            for c, v in found.signals.items()
        }
    )


def test_a_joint_that_sticks_shows_its_friction_and_never_more(servo):
    for friction in (0.3, 0.6):
        shown = float(held(conditioned(servo, log(friction))[0])[0])
        assert 0.6 * friction < shown < 1.1 * friction


@pytest.mark.parametrize(
    ("rotor", "friction", "pace"),
    [(0.05, 0.2, 2.0), (0.15, 0.2, 1.3), (0.15, 0.4, 2.0), (0.15, 0.4, 1.3)],
)
def test_what_a_heavy_rotor_needs_to_set_off_is_not_held(servo, rotor, friction, pace):
    swung = log(
        friction,
        rotor=rotor,
        target=lambda t: (0.8 if pace < 2 else 0.6) * np.sign(np.sin(pace * t))[None],
    )
    assert float(held(conditioned(servo, swung)[0])[0]) < 1.1 * friction


def test_neither_a_load_nor_a_free_joint_is_taken_for_friction(servo):
    for healthy in (log(), log(mass=0.9)):
        signals = conditioned(servo, healthy)
        assert float(held(signals[0])[0]) < 0.05
        assert noticed(signals, ()) == {}


def test_what_held_before_is_no_news(servo):
    signals = conditioned(servo, log(0.5), log(0.5, session="before", role="reference"))
    assert list(noticed(signals[:1], ())) == ["swing"]
    assert noticed(signals[:1], signals[1:]) == {}


def test_errors_that_rub_are_known_together(servo):
    errors = [
        NuisanceParameter("coulomb_friction", "swing", 0, 0.1),
        NuisanceParameter("stribeck_friction", "swing", 0, 0.2),
        NuisanceParameter("viscous_friction", "swing", 0, 1.0),
    ]
    prior = Prior(
        np.array([3.0, -0.5, 4.0]), np.array([[4.0, -1.9, 0.0], [-1.9, 1.0, 0.0], [0.0, 0.0, 1.0]])
    )
    variance = 0.04 + 0.04 - 2 * 0.1 * 0.2 * 1.9  # Nm^2: much less than of either alone
    assert calibrated(errors, prior, conditioned(servo, log()))[0] == pytest.approx(
        0.3 - 0.1 + OPEN * np.sqrt(variance)
    )


def test_calibrated_friction_is_known_at_rest_as_far_as_it_may_reach(servo):
    signals = conditioned(servo, log(0.5))
    errors = [NuisanceParameter("coulomb_friction", "swing", 0, 0.01)]
    for mean, deviation, holds in (
        (0.5, 0.02, False),
        (0.1, 0.02, True),
        (0.1, 0.2, False),
        (-0.5, 0.02, True),
    ):
        prior = Prior(np.array([mean / 0.01]), np.array([[(deviation / 0.01) ** 2]]))
        assert bool(noticed(signals, (), (), errors, prior)) == holds


def test_friction_that_references_show_while_they_move_is_known_at_rest(servo):
    """They never rest, so that nothing but their calibration tells it; the model has none."""
    moving = [log(0.25, target=robots.swift(s), session="before", role="reference") for s in (1, 2)]
    signals = conditioned(servo, log(0.25), log(0.55), *moving)
    assert max(float(held(s)[0]) for s in signals[2:]) < 0.1
    rules = load_thresholds(None)
    assert list(noticed(signals[:1], signals[2:])) == ["swing"]
    assert prepare(signals[:1], signals[2:], rules).base.samples.holds == {}
    more = prepare(signals[1:2], signals[2:], rules).base.samples.holds
    assert 0.1 < more["swing"] < 0.3
    assert diagnose_signals(signals[:1], signals[2:], threads=1).verdict == "none"


def test_a_joint_that_sticks_is_never_called_healthy(servo):
    found = diagnose_signals(conditioned(servo, log(0.6)), threads=1)
    assert found.verdict in ("explained", "ambiguous")
    assert found.causes[0].effect in ("coulomb_friction", "stribeck_friction")
    torque = found.causes[0].parameters["torque"]
    assert torque.low < 0.66
    assert torque.high > 0.5
    assert "it sticks" in found.mapping()["at_rest"][0]["says"]


def test_noise_of_a_slow_log_is_no_friction(servo):
    healthy, rng = log(), np.random.default_rng(4)
    rough = {
        c: v[::4] + (rng.normal(0, 0.2, len(v[::4])) if c.startswith("motor_torque") else 0.0)
        for c, v in healthy.signals.items()
    }
    signals = conditioned(servo, healthy.changed(time=healthy.time[::4], signals=rough))
    assert noticed(signals, ()) == {}
    assert float(held(signals[0])[0]) < 0.12


def test_loads_that_knock_or_stand_on_feet_are_known_less_well():
    ramp = np.linspace(0.0, 1.0, 101)
    range_of_ramp = 0.47  # half of what lies between the percentiles
    assert _unsure(ramp, floating=False) == pytest.approx(OF_LOAD * range_of_ramp)
    assert _unsure(ramp, floating=True) == pytest.approx(AFOOT * range_of_ramp)
    knocks = 5.0 * (np.arange(101) % 10 == 0)
    assert _unsure(ramp + knocks, floating=False) > _unsure(ramp, floating=False) + 0.5


def test_a_leg_on_its_feet_and_a_joint_among_knocks_hold_nothing(servo):
    """The same rests show friction as long as the load does not change more than what they are said
    to hold.
    """
    signals = conditioned(servo, log(0.6))[0]
    shown = float(held(signals)[0])
    rng = np.random.default_rng(5)
    knocked = dataclasses.replace(
        signals, rigid=signals.rigid + 4.0 * rng.standard_normal(signals.rigid.shape)
    )
    assert shown > 0.3
    assert float(held(knocked)[0]) < 0.2 * shown
