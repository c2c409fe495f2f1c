"""The ladder of ablations adds up, and finds the cause that is there."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.attribution import CAUSES, LADDER, WHOLE, attribute
from hyperleg_design.evaluation.statistics import DIFFERS, NOT_TOLD_APART


def groups(means, spread=0.05):
    rng = np.random.default_rng(0)
    return {
        name: [m + spread * rng.normal(size=10) for _ in range(5)]
        for name, m in zip(LADDER, means, strict=True)
    }


def test_steps_add_up_to_the_whole():
    shares = attribute(groups([1.0, 1.3, 1.7, 1.6]))
    assert [s.cause for s in shares] == [*CAUSES, WHOLE]
    assert sum(s.change.mean for s in shares[:-1]) == pytest.approx(shares[-1].change.mean)
    assert [round(s.change.mean, 1) for s in shares] == [0.3, 0.4, -0.1, 0.6]


def test_the_cause_that_is_there_is_the_one_that_differs():
    shares = attribute(groups([1.0, 1.0, 2.0, 2.0]))
    assert [s.change.verdict for s in shares] == [NOT_TOLD_APART, DIFFERS, NOT_TOLD_APART, DIFFERS]
    assert (shares[1].kept, shares[1].removed) == ("toe_locked", "toe_removed_matched")


def test_two_variants_give_what_they_can():
    found = groups([1.0, 1.0, 2.0, 2.0])
    shares = attribute({name: found[name] for name in ("toe", "toe_removed_matched")})
    assert [s.cause for s in shares] == [WHOLE]
    with pytest.raises(InputError, match="at least two"):
        attribute({"toe": found["toe"]})
