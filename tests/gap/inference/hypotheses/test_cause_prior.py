"""Priors of sets of causes."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.stats import norm

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.hypotheses.cause_prior import (
    beyond_usual,
    log_chance,
    log_prior,
    prior_odds,
    usual_error,
)
from hyperleg_design.gap.inference.hypotheses.hypothesis import EVERYWHERE, Candidate, Hypothesis
from hyperleg_design.gap.inference.rules import InferenceRules

RULES = InferenceRules()
EVIDENCE = SimpleNamespace(signals=[SimpleNamespace(subject=None)], usual={}, references=())


def prior(*sizes, location=EVERYWHERE, standing=False, evidence=EVIDENCE):
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
            csr_array((1, 4)),
            np.zeros(4),
            linear=True,
            standing=standing,
        )
        for joint, _ in zip(("hip", "knee", "ankle"), sizes, strict=False)
    )
    theta = RULES.posterior.interval * np.array(sizes, float)
    candidate = Candidate("coulomb_friction", location, causes)
    hypothesis = Hypothesis((candidate,), theta, np.eye(len(sizes)), (), 0.0, 0.0)
    return log_prior(hypothesis, evidence, RULES, {"coulomb_friction": 3})


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


def test_what_changed_since_the_references_is_rarer_than_what_a_model_lacks():
    beside = SimpleNamespace(**{**vars(EVIDENCE), "references": (None,)})
    rarer = np.log(RULES.cause.changed / RULES.cause.probability)
    assert prior(9.0, evidence=beside) - prior(9.0) == pytest.approx(rarer)
    standing = prior(9.0, standing=True, evidence=beside)
    assert standing == pytest.approx(prior(9.0, standing=True))


def test_what_stands_in_the_references_may_be_a_usual_error():
    """A small error that both sessions have is one, so that no change stands in its place."""
    usual = {("coulomb_friction", "hip", 0): 1.0}
    evidence = SimpleNamespace(**{**vars(EVIDENCE), "usual": usual, "references": ("a log",)})
    own = {"location": "hip", "evidence": evidence}
    free, small = prior(1.0, location="hip"), RULES.discrepancy.change * RULES.cause.usual
    assert prior(0.5 * small, standing=True, **own) == pytest.approx(free)
    assert prior(0.5 * small, **own) < free - np.log(2)


@pytest.mark.parametrize(
    ("references", "standing", "share"),
    [((), False, 1.0), (("a log",), True, 1.0), (("a log",), False, RULES.discrepancy.change)],
)
def test_a_change_is_no_fault_where_calibration_changes_as_much(references, standing, share):
    key = "coulomb_friction", "hip", 0
    evidence = SimpleNamespace(usual={key: 0.1}, references=references)
    usual = usual_error(evidence, RULES, key, standing)
    assert usual == pytest.approx(share * RULES.cause.usual * 0.1)
    one = np.ones(1)
    cause = SimpleNamespace(
        effect=key[0], location=key[1], standing=standing, nulls=0 * one, shape=np.zeros(1, bool)
    )
    for size in (0.5 * usual, usual, usual + 0.2):
        hypothesis = SimpleNamespace(
            causes=[cause], values=lambda _, s=size: s * one, deviation=lambda _: 0.1 * one
        )
        chance = norm.cdf((size - usual) / (RULES.posterior.interval * 0.1))
        assert np.exp(beyond_usual(hypothesis, 0, evidence, RULES)) == pytest.approx(chance)


def test_a_mass_that_changed_since_the_references_is_a_fault_of_any_size():
    key = "link_mass", "shank", 0
    evidence = SimpleNamespace(usual={key: 0.1}, references=("a log",))
    assert usual_error(evidence, RULES, key) == 0.0
    assert usual_error(evidence, RULES, key, standing=True) == pytest.approx(0.3)


def test_an_effect_that_no_calibration_error_is_like_is_a_fault_of_any_size():
    evidence = SimpleNamespace(usual={}, references=())
    assert usual_error(evidence, RULES, ("backlash", "hip", 0)) == 0.0


def cause(name, **changes):
    effect = EFFECTS[name]
    values = {
        "effect": name,
        "linear": effect.linear,
        "shape": np.array([p.shape for p in effect.parameters]),
        "low": np.array([p.low for p in effect.parameters]),
        "high": np.array([p.high for p in effect.parameters]),
        "usual": np.array([p.typical for p in effect.parameters]),
        "unseen": False,
        "declared": 0.0,
        "beyond": 0,
    }
    return SimpleNamespace(**{**values, **changes})


def test_each_free_parameter_costs_the_same():
    gains = cause("controller_gain")
    both = prior_odds(gains, np.array([0.8, 1.0]), RULES)
    one = prior_odds(
        cause("controller_gain", high=np.array([5.0, 1.0]), low=np.array([0.1, 1.0])),
        np.array([0.8, 1.0]),
        RULES,
    )
    assert one - both == pytest.approx(RULES.cause.parameter)


def test_rare_effects_are_less_probable_and_those_that_no_log_shows_by_itself_still_less():
    values = np.array([1.0, 0.0, 10.0])
    free = 3 * RULES.cause.parameter
    odds = prior_odds(cause("voltage_sag"), values, RULES)
    assert odds == pytest.approx(EFFECTS["voltage_sag"].rare - free)
    seen, unseen = (
        prior_odds(cause("transmission_ratio", unseen=u), np.array([1.1, 0.0]), RULES)
        for u in (False, True)
    )
    assert unseen - seen == EFFECTS["transmission_ratio"].unseen < 0


def test_friction_that_is_described_is_not_gone():
    described = cause("coulomb_friction", low=np.array([-2.0]))
    little, most = (prior_odds(described, np.array([v]), RULES) for v in (-0.5, -1.5))
    assert little - most == pytest.approx(RULES.cause.missing)
    bare = cause("coulomb_friction", low=np.array([0.0]))
    assert prior_odds(bare, np.array([0.5]), RULES) == pytest.approx(little)


@pytest.mark.parametrize("references", [(), (None,)])
def test_friction_of_another_kind_where_a_joint_rubs_more_is_no_further_change(references):
    evidence = SimpleNamespace(references=references)
    count = dict.fromkeys(("coulomb_friction", "stribeck_friction", "viscous_friction"), 3)

    def more(*names):
        names = [("coulomb_friction", "knee", False), *names]
        chances = [log_chance(some, evidence, RULES, count) for some in (names, names[:1])]
        return chances[0] - chances[1]

    here = more(("viscous_friction", "knee", False))
    assert here == pytest.approx(np.log(RULES.cause.again / 3))
    assert more(("viscous_friction", "hip", False)) < here - 1
    assert more(("viscous_friction", "knee", True)) < here - 1
