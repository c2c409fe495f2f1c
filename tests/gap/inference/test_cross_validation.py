"""Cross-validation over blocks against the conditional normal distribution."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from causes import unbounded

from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.cross_validation import healthy_share, predicted
from hyperleg_design.gap.inference.hypotheses.hypothesis import Candidate, Hypothesis
from hyperleg_design.gap.inference.rules import InferenceRules
from tests.gap.inference.channels.test_channel import SCALES, dense, made

RULES = InferenceRules()
PARTS, FOLDS, COUNT = 12, 4, 24


def evidence(sessions: int, rng: np.random.Generator) -> Evidence:
    """Of one channel; the first session is under test."""
    channel, _ = made(rng, sessions=sessions, count=COUNT)
    size = len(channel.samples)
    part = np.arange(size) * PARTS // size
    samples = SimpleNamespace(
        value=np.zeros(size),
        part=part,
        fold=np.arange(PARTS) % FOLDS,
        folds=FOLDS,
        weight=rng.uniform(0.5, 2.0, size),
    )
    tests = SimpleNamespace(value=np.zeros(len(channel.under_test)))
    return Evidence((channel,), samples, tests, (), (), {}, (1.0,), (0.0,))


def scales_of(channel) -> Scales:
    return replace(SCALES, noise=SCALES.noise[: len(channel.numbers)])


def nothing(evidence: Evidence) -> Hypothesis:
    scales = tuple(scales_of(one) for one in evidence.channels)
    return Hypothesis((), np.zeros(0), np.zeros((0, 0)), scales, 0.0, 0.0)


def one_cause(evidence: Evidence, columns: np.ndarray, constant: np.ndarray | None) -> Hypothesis:
    """Unbounded; its own estimate does not matter, only its scales do."""
    k = len(columns)
    cause = unbounded("payload", "foot", columns, constant)
    candidates = (Candidate("payload", "foot", (cause,)),)
    return replace(nothing(evidence), candidates=candidates, theta=np.full(k, np.nan))


def with_residual(evidence: Evidence, added: np.ndarray) -> Evidence:
    """Evidence to whose residual something is added, weighted as it `(S,)`."""
    return replace(evidence, channels=tuple(one.without(-added) for one in evidence.channels))


@pytest.mark.parametrize("sessions", [1, 3])
def test_without_causes_each_block_is_predicted_by_all_others(sessions):
    known = evidence(sessions, np.random.default_rng(sessions))
    (channel,), weight = known.channels, known.samples.weight
    covariance = dense(channel, scales_of(channel))
    value = np.concatenate([one[-1] for one in channel.whitened])
    fold = known.samples.fold[known.samples.part]
    tested = np.arange(len(value)) < len(known.tests.value)
    found = predicted(known, nothing(known), RULES)
    assert not found.trace.any()
    for held in range(FOLDS):
        own, rest = (fold == held) & tested, (fold != held) | ~tested
        solved = np.linalg.solve(covariance[np.ix_(rest, rest)], value[rest])
        mean = covariance[np.ix_(own, rest)] @ solved
        np.testing.assert_allclose(found.noise[own], (value[own] - mean) / weight[own], atol=1e-9)
        share = healthy_share(channel, scales_of(channel), RULES)
        assert 0 < share < 1 or sessions == 1
        np.testing.assert_allclose(found.unlisted[own], (1 - share) * mean / weight[own], atol=1e-9)
    assert not found.before[~tested].any()


@pytest.mark.parametrize("sessions", [1, 3])
@pytest.mark.parametrize("nonlinear", [False, True])
def test_no_block_has_a_say_in_its_own_prediction(sessions, nonlinear):
    rng = np.random.default_rng(10)
    known = evidence(sessions, rng)
    count = len(known.samples.value)
    columns, constant = rng.standard_normal((2, count)), 2.0 * rng.standard_normal(count)
    fold = known.samples.fold[known.samples.part]
    tested = np.arange(count) < len(known.tests.value)
    hypothesis = one_cause(known, columns, constant if nonlinear else None)
    before = predicted(known, hypothesis, RULES)
    for held in range(FOLDS):
        mine = (fold == held) & tested
        added = np.where(mine, 30.0 * rng.standard_normal(count), 0.0)
        after = predicted(with_residual(known, added), hypothesis, RULES)
        np.testing.assert_allclose(after.trace[mine], before.trace[mine], rtol=1e-9)
        np.testing.assert_allclose(after.unlisted[mine], before.unlisted[mine], rtol=1e-9)
        moved = (added / known.samples.weight)[mine]
        np.testing.assert_allclose((after.before - before.before)[mine], moved, atol=1e-9)
        others = tested & ~mine
        assert np.abs(after.trace - before.trace)[others].max() > 1e-3


def test_a_strong_cause_is_foretold_and_taken_off():
    rng = np.random.default_rng(3)
    known = evidence(1, rng)
    count = len(known.samples.value)
    columns = rng.standard_normal((2, count))
    size = np.array([300.0, -200.0])
    trace = size @ columns
    strong = with_residual(known, trace * known.samples.weight)
    found = predicted(strong, one_cause(strong, columns, None), RULES)
    np.testing.assert_allclose(found.trace, trace, atol=0.02 * np.abs(trace).max())
    spread = np.sqrt(np.mean(found.after**2)) / np.sqrt(np.mean(trace**2))
    assert spread < 0.02
    np.testing.assert_array_equal(found.after, found.before - found.trace)
    np.testing.assert_array_equal(found.noise, found.after - found.unlisted)


def test_the_trace_of_an_effect_that_is_not_listed_is_unlisted():
    rng = np.random.default_rng(5)
    known = evidence(3, rng)
    columns = rng.standard_normal((1, len(known.samples.value)))
    hypothesis = one_cause(known, columns, None)
    odd = unbounded("leaning_vertical", "robot", columns)
    candidates = (Candidate("leaning_vertical", "robot", (odd,)),)
    listed = predicted(known, hypothesis, RULES)
    found = predicted(known, replace(hypothesis, candidates=candidates), RULES)
    assert not found.trace.any()
    np.testing.assert_allclose(found.before, listed.before, atol=1e-12)
    np.testing.assert_allclose(found.noise, listed.noise, atol=1e-12)
    np.testing.assert_allclose(found.unlisted, listed.unlisted + listed.trace, atol=1e-12)


def test_a_cause_that_references_show_too_is_part_of_what_was_known():
    rng = np.random.default_rng(4)
    known = evidence(3, rng)
    count = len(known.samples.value)
    columns = rng.standard_normal((1, count))
    hypothesis = one_cause(known, columns, None)
    (candidate,) = hypothesis.candidates
    standing = Candidate("payload", "foot", (replace(candidate.causes[0], standing=True),))
    found = predicted(known, hypothesis, RULES)
    known_before = predicted(known, replace(hypothesis, candidates=(standing,)), RULES)
    assert not known_before.trace.any()
    assert found.trace.any()
    np.testing.assert_allclose(known_before.before, found.after, atol=1e-12)
    np.testing.assert_allclose(known_before.unlisted, found.unlisted, atol=1e-12)


def test_the_share_of_a_healthy_robot_falls_with_the_discrepancy():
    rng = np.random.default_rng(5)
    for sessions, name in ((3, "new"), (1, "standing")):
        channel, _ = made(rng, sessions=sessions)
        shares = [
            healthy_share(channel, replace(SCALES, **{name: size}), RULES)
            for size in np.linspace(0.0, 5.0, 30)
        ]
        assert shares[0] == 1.0
        assert (np.diff(shares) <= 0).all()
        assert 0 < shares[-1] < 0.02
