"""Gains beside a hypothesis from parts that are kept, against all columns at once."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from causes import unbounded
from scipy.sparse import csr_array

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.assembly import evidence_of
from hyperleg_design.gap.inference.channels.scale_fit import first_scales
from hyperleg_design.gap.inference.channels.scales import Scales
from hyperleg_design.gap.inference.effect_traces import NotJudged, Starts, traces_of
from hyperleg_design.gap.inference.hypotheses.hypothesis import reduced, shifted, solve
from hyperleg_design.gap.inference.hypotheses.proposals import LARGEST, Proposer
from hyperleg_design.gap.inference.hypotheses.stack import Stack
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from tests.gap.inference.channels.test_channel import made

RULES = InferenceRules()
SCALES = Scales(np.array([0.7, 1.9, 1.2, 0.4]), np.log(0.8), np.log(0.5), np.log(3.0))


@pytest.mark.parametrize("constant", [False, True])
@pytest.mark.parametrize("alone", [False, True])
def test_gains_are_those_of_all_columns_at_once(constant, alone):
    rng = np.random.default_rng(5)
    channels = [made(rng)[0] for _ in range(2)]
    size = len(channels[0].samples)
    weight = rng.uniform(0.5, 2.0, size)
    evidence = SimpleNamespace(channels=channels, weight=weight)
    tested = 2 * len(channels[0].places[0])
    linear, starts = rng.standard_normal((2, size)), rng.standard_normal((3, tested))
    traces = {
        ("coulomb_friction", "knee", False): [unbounded("coulomb_friction", "knee", linear)],
        ("command_delay", "robot", False): Starts(np.arange(3.0)[:, None], csr_array(starts)),
        ("payload", "foot", False): NotJudged("payload", "foot", "no motion"),
    }
    acting = unbounded(
        "spring",
        "knee",
        rng.standard_normal((2, size)),
        rng.standard_normal(size) if constant else None,
    )
    causes = [] if alone else [acting]
    scales = (SCALES, SCALES)
    found = Proposer(evidence, RULES, traces).proposals(causes, scales)
    assert len(found) == 4
    assert [one.gain for one in found] == sorted((one.gain for one in found), reverse=True)

    def gain(columns, low, high):
        stack = Stack.of(causes, evidence)
        count, last = len(stack.low), stack.constant_last
        padded = np.pad(columns, ((0, 0), (0, size - columns.shape[1])))
        rows = [stack.rows[:count], padded * weight, stack.rows[count:]]
        products = shifted(reduced(evidence, scales, np.concatenate(rows)), last)
        free = np.full(count, np.inf)
        low, high = np.r_[-free, low], np.r_[free, high]
        return solve(products, low, high, np.zeros(len(low), bool), RULES).gain

    start = gain(np.zeros((0, size)), np.zeros(0), np.zeros(0)) if causes else 0.0
    for one in found:
        if one.effect == "coulomb_friction":
            expected = gain(linear, np.full(2, -np.inf), np.full(2, np.inf))
        else:
            expected = gain(starts[one.variant : one.variant + 1], np.zeros(1), np.full(1, LARGEST))
        assert one.gain == pytest.approx(expected - start, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_the_starts_that_gain_most_are_among_those_solved(seed):
    rng = np.random.default_rng(seed)
    channels = [made(rng)[0] for _ in range(2)]
    size = len(channels[0].samples)
    weight = rng.uniform(0.5, 2.0, size)
    evidence = SimpleNamespace(channels=channels, weight=weight)
    starts = rng.standard_normal((12, size)) + rng.standard_normal(size)
    traces = {("command_delay", "robot", True): Starts(np.arange(12.0)[:, None], csr_array(starts))}
    acting = unbounded("spring", "knee", rng.standard_normal((2, size)))
    found = Proposer(evidence, RULES, traces).proposals([acting], (SCALES, SCALES))

    def gain(rows):
        products = reduced(evidence, (SCALES, SCALES), np.concatenate([acting.columns, rows]))
        low, high = np.r_[-np.inf, -np.inf, np.zeros(len(rows))], np.full(2 + len(rows), np.inf)
        high[2:] = LARGEST
        return solve(products, low, high, np.zeros(len(low), bool), RULES).gain

    acting = replace(acting, compact=csr_array(Stack.of([acting], evidence).rows))
    alone = gain(np.zeros((0, size)))
    every = np.array([gain(one[None] * weight) for one in starts]) - alone
    best = np.argsort(-every)[: RULES.search.starts]
    solved = {one.variant: one.gain for one in found}
    for start in best:
        if every[start] > RULES.search.least:
            assert solved[start] == pytest.approx(every[start], rel=1e-6, abs=1e-6)


def test_a_start_that_scales_torques_is_charged_for_it_as_a_cause_is(search):
    effect, motor = "transmission_ratio", "m_front"
    places = [(effect, motor)]
    evidence = search.evidence
    proposer = Proposer(evidence, search.rules, traces_of(evidence, places, 1))
    name = (effect, motor, False)
    starts = proposer.traces[name]
    for start, (scaled,) in zip(starts.values, proposer.scaling(name), strict=True):
        for size in (0.5, 1.0, 3.0):
            scale = 1 + size * (start[0] - 1)
            assert scaled.log(np.array([size])) == pytest.approx(scaled.number * np.log(scale))


def test_a_start_that_scales_no_torque_is_charged_nothing(search):
    name = ("command_delay", "robot", False)
    proposer = Proposer(
        search.evidence, search.rules, {name: Starts(np.ones((3, 1)), csr_array(np.ones((3, 4))))}
    )
    assert proposer.scaling(name) == [(), (), ()]


def promised(signals, name, link, values, beside=0.0):
    """Proposer of an effect at a link whose trace at some values is the residual, or is added to
    what there is, of a model that is hardly wrong otherwise.
    """
    trace = EFFECTS[name].trace(signals, link, np.array([values]))
    residual = {
        kind: beside * rows + trace[kind][0] if kind in trace else rows
        for kind, rows in signals.residual.items()
    }
    evidence = evidence_of([replace(signals, residual=residual)], [], RULES)
    proposer = Proposer(evidence, RULES, traces_of(evidence, [(name, link)], 1))
    scales = (replace(first_scales(one, RULES), standing=np.log(0.1)) for one in evidence.channels)
    return proposer.proposals((), tuple(scales))


@pytest.mark.parametrize("name", ["payload", "link_com"])
@pytest.mark.parametrize("values", [[1.2, 0.08, -0.06, 0.1, 0.0], [1.2, -0.05, 0.07, 0.02, 0.0]])
def test_the_best_start_is_near_what_is_there_wherever_it_lies(name, values, robot_files, runs):
    log, link = runs["arm"], "forearm"
    arm = condition(log, load_subject(robot_files["arm"], [log]))
    truth = values if name == "payload" else values[1:4]
    best = promised(arm, name, link, truth)[0].values
    there, found = EFFECTS[name].trace(arm, link, np.array([truth, best]))["motion"]
    assert np.square(there - found).mean() < 0.05 * np.square(there).mean()


def test_a_payload_that_hangs_there_is_found(robot_files, runs):
    log = runs["arm"]
    arm = condition(log, load_subject(robot_files["arm"], [log]))
    values = [2.0, 0.05, -0.02, 0.15, 0.0]
    best = promised(arm, "payload", "wrist_1_link", values, beside=1.0)[0].values
    assert best[0] == pytest.approx(2.0, rel=0.15)
    np.testing.assert_allclose(best[1:], values[1:], atol=0.05)


def test_a_payload_on_a_floating_base_is_found(biped_runs):
    """No joint feels it directly; the ground must give more."""
    log = biped_runs["standing"]
    standing = condition(log, load_subject(None, [log]))
    base = EFFECTS["payload"].locations(standing.subject)[0]
    best = promised(standing, "payload", base, [3.0, 0.06, -0.04, 0.1, 0.0])[0].values
    assert best[0] == pytest.approx(3.0, rel=0.05)
    np.testing.assert_allclose(best[1:3], [0.06, -0.04], atol=0.02)
