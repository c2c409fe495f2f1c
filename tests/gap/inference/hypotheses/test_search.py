"""The search for causes against all sets of them, each fitted."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product
from types import SimpleNamespace

import diagnosed
import pytest

from hyperleg_design.gap.inference.effect_traces import NotJudged, traces_of
from hyperleg_design.gap.inference.hypotheses import search as looking
from hyperleg_design.gap.inference.hypotheses.hypothesis import EVERYWHERE, Candidate
from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.inference.rules import InferenceRules

VISCOUS, DRY = ("viscous_friction", "knee", False), ("coulomb_friction", "hip", False)


@pytest.fixture(scope="module")
def result(search):
    return search.settled(search.result().best)


def test_the_best_of_all_sets_of_causes_is_found(search, result):
    single = {
        name: [Candidate(name[0], name[1], (variant,)) for variant in traced]
        for name, traced in search.traces.items()
    }
    assert len(single) == 4

    def score(causes):
        scales = search.fits.null.scales
        for _ in range(2):  # the search goes on from fitted scales, too
            fit = search.fits.fit(causes, scales)
            scales = fit.scales
        return fit.score

    scores = {
        tuple(sorted(names)): max(map(score, product(*(single[name] for name in names))))
        for size in range(1, 4)
        for names in combinations(single, size)
    }
    best = max(scores, key=scores.__getitem__)
    assert result.best.names == best == tuple(sorted([VISCOUS, DRY]))
    assert result.best.score == pytest.approx(scores[best], abs=0.5)


def test_sizes_of_what_is_found_are_those_of_the_robot(result):
    found = {
        one.effect: (result.best.values(place)[0], result.best.deviation(place)[0])
        for place, one in enumerate(result.best.causes)
    }
    for effect, size in (("viscous_friction", 0.3), ("coulomb_friction", 0.8)):
        value, deviation = found[effect]
        assert value == pytest.approx(size, abs=3 * deviation + 0.05 * size)


def test_hypotheses_are_ranked_each_once_and_nothing_wrong_is_among_them(result):
    scores = [one.score for one in result.hypotheses]
    assert scores == sorted(scores, reverse=True)
    names = [one.names for one in result.hypotheses]
    assert len(set(names)) == len(names)
    assert () in names
    assert any(EVERYWHERE in {place for _, place, _ in one} for one in names)


def test_every_cause_that_is_found_is_worth_its_prior(search, result):
    best = result.best
    for place in range(len(best.candidates)):
        rest = best.candidates[:place] + best.candidates[place + 1 :]
        assert search.fits.fit(rest, best.scales).score < best.score


def test_no_number_of_threads_changes_the_answer(search, result):
    places = [name[:2] for name in search.traces]
    other = Search(search.evidence, search.rules, places, threads=3)
    other = other.settled(other.result().best)
    assert [one.names for one in other.hypotheses] == [one.names for one in result.hypotheses]
    assert [one.score for one in other.hypotheses] == [one.score for one in result.hypotheses]


def test_a_set_is_no_larger_than_the_rules_allow(search):
    rules = replace(search.rules, search=replace(search.rules.search, causes=1))
    places = [name[:2] for name in search.traces]
    found = Search(search.evidence, rules, places).result()
    assert max(len(one.candidates) for one in found.hypotheses) == 1
    assert found.best.names == (VISCOUS,)


def test_gains_of_all_joints_are_one_change(robot_files):
    """Of a nonlinear effect: several joints with one setting cost the prior of one cause."""
    evidence = diagnosed.evidence(
        robot_files["servos"],
        diagnosed.soft_servos(0),
        references=(diagnosed.soft_servos(1, share=1.0),),
    )
    places = [
        (effect, joint)
        for effect in ("controller_gain", "viscous_friction")
        for joint in ("hip", "knee")
    ]
    best = Search(evidence, InferenceRules(), places).result().best
    assert best.names == (("controller_gain", EVERYWHERE, False),)
    for place in range(2):
        assert best.values(place)[0] == pytest.approx(0.75, abs=0.03)


def test_a_search_that_begins_with_what_was_found_ends_there_sooner(search, result):
    places = [name[:2] for name in search.traces]
    again = Search(search.evidence, search.rules, places, traces=search.traces)
    begun = again.begun_like(result.best)
    assert begun.names == result.best.names
    assert begun.score == pytest.approx(result.best.score, abs=0.5)
    assert again.result(begun).best.names == result.best.names
    assert len(again.fitted) < len(search.fitted)


def test_what_the_logs_cannot_show_is_not_judged(search):
    places = [("thermal_derating", "m_front"), ("command_delay", "robot"), VISCOUS[:2]]
    traces = traces_of(search.evidence, places, 1)
    missing = [one for one in traces.values() if isinstance(one, NotJudged)]
    found = Search(search.evidence, search.rules, places).result()
    assert set(found.not_judged) == set(missing)
    assert missing
    assert found.best.names == (VISCOUS,)


def test_without_references_nothing_acts_in_them(search):
    assert all(not standing for *_, standing in search.traces)
    for traced in search.traces.values():
        for cause in traced:
            assert not cause.standing
            assert cause.columns.shape[1] == len(search.evidence.samples.value)


def test_a_cause_that_was_lowered_the_score_is_fitted_again_when_its_predicted_gain_grows(search):
    null = search.fits.null
    proposals = search.proposer.proposals((), null.scales)
    fits = ((one, search.best_start([one], null)) for one in proposals if not search._known([one]))
    proposal, fit = next(pair for pair in fits if pair[1] and pair[1].score < null.score)
    lacking = null.score - fit.score
    assert not search._worth_fitting([proposal], null)
    assert not search._worth_fitting([replace(proposal, gain=proposal.gain + 0.9 * lacking)], null)
    assert search._worth_fitting([replace(proposal, gain=proposal.gain + 1.1 * lacking)], null)
    better = replace(null, log_evidence=null.log_evidence + 1.1 * lacking)
    worse = replace(null, log_evidence=null.log_evidence - 1.1 * lacking)
    assert search._worth_fitting([proposal], better)
    assert not search._worth_fitting([proposal], worse)


def test_causes_that_act_together_are_looked_for_behind_a_torque_of_any_shape(robot_files):
    logs = [diagnosed.run("rubbing", seed, session="today") for seed in (0, 1)]
    evidence = diagnosed.evidence(robot_files["coupled"], *logs)
    effects = "coulomb_friction", "viscous_friction", "odd_torque"
    search = Search(evidence, InferenceRules(), [(effect, "hip") for effect in effects])
    torque = Candidate("odd_torque", "hip", (search.traces["odd_torque", "hip", False][0],))
    listed = search._without_unlisted(search.fits.fit([torque], search.fits.null.scales))
    assert {effect for effect, *_ in listed.names} == set(effects[:2])
    assert search._without_unlisted(listed) is listed


def test_two_causes_that_gain_only_beside_one_another_are_looked_for_together(
    search, result, monkeypatch
):
    best = result.best
    looked = Search.__new__(Search)
    vars(looked).update(vars(search))

    def extended(current, flexible=True):
        assert not flexible
        later = {best.names: [one], one.names: [both]}
        return later.get(current.names, [])

    def scored(hypothesis, more, gain):
        cause = SimpleNamespace(standing=False)
        candidates = (*hypothesis.candidates, Candidate(more, "hip", (cause,)))
        evidence = hypothesis.log_evidence + gain
        return replace(hypothesis, candidates=candidates, log_evidence=evidence)

    one = scored(best, "coulomb_friction", -1.0)
    both = scored(one, "viscous_friction", 3.0)
    current = scored(best, "odd_torque", 1.0)
    looked.extended, looked._known = extended, lambda _: best
    monkeypatch.setattr(looking, "relinearised", lambda _, hypothesis: hypothesis)
    looked.fitted = {}
    assert looked._without_unlisted(current) is both
    both = scored(one, "viscous_friction", 1.5)
    assert looked._without_unlisted(current) is current
