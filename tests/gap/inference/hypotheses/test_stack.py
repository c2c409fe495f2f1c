"""Stacks of causes that grow, against stacks of all causes at once."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from causes import unbounded

from hyperleg_design.gap.inference.hypotheses.stack import Stack
from tests.gap.inference.channels.test_channel import SCALES, made


@pytest.mark.parametrize("bent", [(), (0,), (2,), (0, 1), (0, 1, 2)])
def test_a_stack_that_grows_is_the_stack_of_all_causes(bent):
    rng = np.random.default_rng(3)
    channel, _ = made(rng)
    size = len(channel.samples)
    evidence = SimpleNamespace(channels=(channel,), weight=rng.uniform(0.5, 2.0, size))
    causes = [
        unbounded(
            "spring",
            f"joint_{place}",
            rng.standard_normal((1 + place, size)),
            rng.standard_normal(size) if place in bent else None,
        )
        for place in range(3)
    ]
    whole = Stack.of(causes, evidence)
    for first in range(3):
        grown = Stack.of(causes[:first], evidence).extended(causes[first:], evidence)
        assert grown.constant_last is whole.constant_last is bool(bent)
        np.testing.assert_allclose(grown.rows, whole.rows, atol=1e-12)
        np.testing.assert_allclose(
            grown.crossing.reduced([channel], [SCALES]),
            whole.crossing.reduced([channel], [SCALES]),
            rtol=1e-10,
            atol=1e-10,
        )


def test_held_causes_keep_their_values():
    rng = np.random.default_rng(4)
    channel, _ = made(rng)
    size = len(channel.samples)
    evidence = SimpleNamespace(channels=(channel,), weight=np.ones(size))
    causes = [unbounded("spring", name, rng.standard_normal((2, size))) for name in "ab"]
    held = Stack.of(causes, evidence).held([(slice(2, 4), causes[1])])
    assert held.low[2:].tolist() == held.high[2:].tolist() == causes[1].phi.tolist()
    assert np.isinf(held.low[:2]).all()
