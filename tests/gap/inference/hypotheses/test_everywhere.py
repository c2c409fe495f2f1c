from dataclasses import replace

import diagnosed
import numpy as np

from hyperleg_design.gap.inference.effect_traces import places
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypotheses.everywhere import (
    at_all_places,
    without_gain_from_torques,
)
from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.inference.rules import InferenceRules


def test_a_cause_that_does_not_gain_by_scaling_torques_is_otherwise_the_same(search):
    (cause,) = search.traces["viscous_friction", "knee", False]
    assert without_gain_from_torques(cause) is cause
    scaling = replace(cause, factors=(Factor(0, np.ones((1, 3)), 50.0),))
    found = without_gain_from_torques(scaling)
    assert found.compact is cause.compact
    sizes = np.linspace(-0.3, 0.3, 7)[:, None]
    gains = np.array([[one.factors[0].log(size) for size in sizes] for one in (scaling, found)])
    assert np.abs(gains[0]).max() > 0.1
    assert (gains[1] <= 1e-12).all()


def test_of_nonlinear_effects_those_are_joined_that_gain_most_at_joints_and_drives(robot_files):
    evidence = diagnosed.evidence(robot_files["servos"], diagnosed.soft_servos(0))
    tried = ("controller_gain", "encoder_offset", "payload", "viscous_friction")
    subject = evidence.signals[0].subject
    looking = Search(evidence, InferenceRules(), places(subject, tried))
    null = looking.fits.null
    proposals = {}
    for proposal in looking.proposer.proposals((), null.scales):
        proposals.setdefault(proposal.name, []).append(proposal)
    joined = {candidate.effect for _, candidate in at_all_places(looking.fits, proposals, null)}
    assert {"controller_gain", "viscous_friction"} <= joined
    assert "payload" not in joined
    alone = replace(looking.rules, search=replace(looking.rules.search, bent=0))
    looking.fits.rules = alone
    assert {c.effect for _, c in at_all_places(looking.fits, proposals, null)} == {
        "viscous_friction"
    }
