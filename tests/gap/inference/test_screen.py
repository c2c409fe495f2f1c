from types import SimpleNamespace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import screen as module
from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.screen import (
    Candidate,
    NotJudged,
    _unlike,
    at_rest,
    descend,
    lacking,
    linearise,
    places,
    screen,
)


@pytest.fixture(scope="module")
def ready(robot_files):
    return diagnosed.prepared(robot_files["coupled"], diagnosed.run("viscous", 0))


@pytest.fixture(scope="module")
def found(ready):
    subject = ready.base.samples.filtered_logs[0].signals.subject
    return screen(ready.base, Design(ready.base).fit(), places(subject))


def test_the_true_cause_leads(found):
    best = max((c for c in found if isinstance(c, Candidate)), key=lambda c: c.gain)
    assert best.name == ("viscous_friction", "knee")


def test_threads_change_nothing(ready, found):
    subject = ready.base.samples.filtered_logs[0].signals.subject
    again = screen(ready.base, Design(ready.base).fit(), places(subject), threads=3)
    gains = [[(c.name, c.gain) for c in run if isinstance(c, Candidate)] for run in (found, again)]
    assert gains[0] == gains[1]


def test_what_logs_lack_is_said(ready, found):
    told = {n.effect: n.reason for n in found if isinstance(n, NotJudged)}
    assert "lack" in told["command_delay"]
    signals = [s.signals for s in ready.base.samples.filtered_logs]
    assert (
        lacking(EFFECTS["controller_gain"], "knee", signals)
        if EFFECTS["controller_gain"].locations(signals[0].subject)
        else True
    )
    assert not lacking(EFFECTS["coulomb_friction"], "knee", signals)


def test_a_linearised_trace_is_the_trace(ready):
    samples = ready.base.samples
    effect = EFFECTS["encoder_offset"]
    cause = linearise(samples, effect, "knee", np.array([0.05]))
    exact = samples.columns(lambda s: effect.trace(s, "knee", np.array([[0.06]])), 1)[0]
    near = cause.constant + (0.06 - cause.nulls[0]) / cause.usual[0] * cause.columns[0]
    assert np.abs(near - exact).max() < 0.02 * np.abs(exact).max()


def test_descent_finds_a_parameter_that_is_not_linear(robot_files):
    from dataclasses import replace

    from hyperleg_design.gap.inference.preparation import prepare
    from hyperleg_design.gap.inference.thresholds import load_thresholds

    signals = diagnosed.conditioned(robot_files["coupled"], diagnosed.run("healthy", 0))[0]
    effect = EFFECTS["stribeck_friction"]
    values = np.array([1.0, 0.2])
    shifted = {
        "motion": signals.residual["motion"]
        + effect.trace(signals, "hip", values[None])["motion"][0]
    }
    ready = prepare([replace(signals, residual=shifted)], [], load_thresholds())
    result = descend(ready.base, effect, "hip", np.array([0.3, 0.1]), Design(ready.base).fit(), 12)
    assert result.cause.values == pytest.approx(values, rel=0.15)


def test_what_a_joint_holds_at_rest_speaks_for_its_breakaway_friction_alone():
    samples = SimpleNamespace(holds={"knee": 0.5})
    assert at_rest(samples, "stribeck_friction", "knee") > 10
    assert at_rest(samples, "stribeck_friction", "hip") == 0
    assert at_rest(samples, "coulomb_friction", "knee") == 0


def test_searches_begin_on_several_sides_where_there_is_a_choice():
    backlash, plain = EFFECTS["backlash"], EFFECTS["controller_gain"]
    starts = np.array(
        [
            [0.01, 0.0, 0.0, 0.0],
            [0.04, 0.0, 0.0, 0.0],
            [0.02, 1.0, 1.0, 0.0],
            [0.05, 1.0, 1.0, 0.0],
            [0.01, 1.0, 1.0, 1.0],
        ]
    )
    np.testing.assert_array_equal(_unlike(backlash, starts), starts[[0, 2, 4]])
    np.testing.assert_array_equal(_unlike(backlash, starts[:2]), starts[:2])
    gains = np.array([[0.8, 0.8], [1.25, 1.25], [0.8, 1.0]])
    np.testing.assert_array_equal(_unlike(plain, gains), gains[:2])


def test_traces_are_kept_while_they_are_few_and_change_no_answer(judged, monkeypatch):
    judge, wanted = (
        judged[0],
        [("viscous_friction", "knee"), ("coulomb_friction", "hip"), ("controller_gain", "knee")],
    )

    def gains():
        return [
            one.gain
            for one in screen(judge.base, judge.nothing.fit, wanted)
            if isinstance(one, Candidate)
        ]

    module._TRACED.clear()
    first = gains()
    assert module._TRACED[judge.base.samples].keys() == set(wanted)
    assert gains() == first
    monkeypatch.setattr(module, "KEPT", 0)
    module._TRACED.clear()
    assert gains() == first
    assert all(isinstance(one, NotJudged) for one in module._TRACED[judge.base.samples].values())
