from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import shaping
from hyperleg_design.gap.inference.decide import decide
from hyperleg_design.gap.inference.judge import Judge
from hyperleg_design.gap.inference.screen import linearise, places
from hyperleg_design.gap.inference.thresholds import load_thresholds


@pytest.fixture(scope="module")
def rules():
    return load_thresholds()


@pytest.fixture(scope="module")
def cubic(robot_files, rules):
    return Judge(
        diagnosed.prepared(
            robot_files["coupled"], *(diagnosed.run("cubic", s, session="a") for s in (0, 1))
        ).base,
        rules,
        1,
    )


def everywhere(judge):
    return np.arange(2 * len(judge.base.samples.rows)) < len(judge.base.samples.rows)


def test_a_hardening_spring_is_seen_beside_no_cause(cubic, rules):
    found = shaping.beside(cubic, cubic.nothing, everywhere(cubic))
    assert shaping.tells(rules, cubic.nothing, found)
    assert list(found) == sorted(found, key=lambda one: -one[1])
    assert shaping.instead(cubic, cubic.nothing, everywhere(cubic), 0.0) == ()


def test_a_shape_that_predicts_more_replaces_a_cause_that_stood_for_it(cubic):
    spring = linearise(cubic.base.samples, EFFECTS["joint_spring"], "hip", np.zeros(2))
    model = cubic.model([spring])
    assert model.gain > 0
    found = shaping.instead(cubic, model, everywhere(cubic), model.gain)
    assert found
    assert all(gain >= shaping.PASSES * cubic.thresholds.beyond_evident for _, gain, _, _ in found)


def test_no_shape_replaces_the_true_cause(robot_files, rules):
    ready = diagnosed.prepared(
        robot_files["coupled"], *(diagnosed.run("viscous", s, session="a") for s in (0, 1))
    )
    subject = ready.base.samples.filtered_logs[0].signals.subject
    judge, found = decide(
        ready.base, rules, places(subject, ("viscous_friction", "coulomb_friction"))
    )
    assert found.model.names == (("viscous_friction", "knee"),)
    assert shaping.instead(judge, found.model, found.rows, found.model.gain) == ()
    assert not shaping.tells(rules, found.model, shaping.beside(judge, found.model, found.rows))


def test_a_shape_that_is_less_than_models_of_a_cause_get_wrong_tells_nothing(cubic, rules):
    found = shaping.beside(cubic, cubic.nothing, everywhere(cubic))
    assert not found[0].faint
    assert not shaping.tells(rules, cubic.nothing, [found[0]._replace(faint=True), *found[1:]])
    large = linearise(cubic.base.samples, EFFECTS["joint_spring"], "hip", np.zeros(2))
    model = cubic.model([large])
    huge = replace(model, held=replace(model.held, bare=1e6 * model.held.bare))
    assert any(not t.faint for t in shaping.beside(cubic, model, everywhere(cubic)))
    assert all(t.faint for t in shaping.beside(cubic, huge, everywhere(cubic)))
