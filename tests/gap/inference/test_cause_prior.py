"""Priors of sets of causes."""

from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.cause_prior import log_prior
from hyperleg_design.gap.inference.fit import Cause
from hyperleg_design.gap.inference.hypothesis import EVERYWHERE, Candidate, Hypothesis
from hyperleg_design.gap.inference.rules import InferenceRules

RULES = InferenceRules()
EVIDENCE = SimpleNamespace(signals=[SimpleNamespace(subject=None)], usual={}, references=())


def prior(*sizes, location=EVERYWHERE):
    """Of friction of joints, sizes in deviations of their estimates."""
    one = np.ones(1)
    causes = tuple(
        Cause(
            "coulomb_friction",
            joint,
            0 * one,
            0 * one,
            one,
            -1e3 * one,
            1e3 * one,
            np.zeros(1, bool),
            np.zeros((1, 4)),
            np.zeros(4),
            linear=True,
        )
        for joint, _ in zip(("hip", "knee", "ankle"), sizes, strict=False)
    )
    theta = RULES.posterior.interval * np.array(sizes, float)
    candidate = Candidate("coulomb_friction", location, causes)
    hypothesis = Hypothesis((candidate,), theta, np.eye(len(sizes)), (), 0.0, 0.0)
    return log_prior(hypothesis, EVIDENCE, RULES, {"coulomb_friction": 3})


def test_an_effect_everywhere_acts_the_same_way_everywhere():
    assert prior(9.0, 9.0, 9.0) == pytest.approx(prior(-9.0, -9.0, -9.0))
    assert prior(9.0, 9.0, -9.0) < prior(9.0, 9.0, 9.0) - 30


@pytest.mark.parametrize("sizes", [(1.0, 0.5), (2.0, -0.3, 0.1)])
def test_it_is_as_likely_as_that_its_sizes_have_one_sign(sizes):
    drawn = np.random.default_rng(1).normal(sizes, 1.0, (400_000, len(sizes)))
    alike = np.mean((drawn > 0).all(1) | (drawn < 0).all(1))
    clear = prior(*(9.0 for _ in sizes))
    assert prior(*sizes) - clear == pytest.approx(np.log(alike), abs=0.02)


def test_one_place_has_no_other_to_be_like():
    assert prior(1.0, location="hip") == pytest.approx(prior(-1.0, location="hip"))
