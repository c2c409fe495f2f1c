"""Priors of the scales of the discrepancy as densities."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from hyperleg_design.gap.inference.channels.scales import ABSENT, Scales, log_prior_of_scales
from hyperleg_design.gap.inference.rules import DiscrepancyRules

PRIOR = DiscrepancyRules()
SCALES = Scales(np.ones(1))
ROOT = np.sqrt(2 * np.pi)


def density(referenced: bool, changes: bool, **values: float) -> float:
    own = replace(SCALES, **values)
    return float(np.exp(log_prior_of_scales(own, PRIOR, referenced, changes)))


def integral(name: str, low: float, high: float, referenced: bool, changes: bool) -> float:
    found, _ = quad(
        lambda x: density(referenced, changes, **{name: x}), low, high, limit=200, epsabs=1e-10
    )
    return found


@pytest.mark.parametrize("odds", [0.02, 0.5, 0.9])
def test_the_standing_scale_without_references_has_one_whole_probability(odds):
    prior = replace(PRIOR, unlisted_probability=odds)
    found, _ = quad(
        lambda x: np.exp(log_prior_of_scales(replace(SCALES, standing=x), prior, False, False)),
        -15,
        15,
        limit=200,
    )
    assert found == pytest.approx(ROOT, rel=1e-6)


def test_the_standing_scale_without_references_is_a_mixture_of_healthy_and_unlisted():
    tail = np.log(PRIOR.unlisted) + 3 * PRIOR.unlisted_spread
    above = integral("standing", tail, 15, False, False) / ROOT
    assert above == pytest.approx(PRIOR.unlisted_probability * norm.sf(3), rel=1e-4)
    below = integral("standing", -15, np.log(PRIOR.standing), False, False) / ROOT
    assert below == pytest.approx((1 - PRIOR.unlisted_probability) / 2, rel=2e-2)


def test_something_unlisted_under_test_has_its_probability():
    healthy = density(True, False)
    assert healthy == density(True, False, new=ABSENT)
    unlisted = integral("new", ABSENT, 20, True, False) / ROOT
    odds = PRIOR.unlisted_probability
    expected = (
        odds / (1 - odds) * norm.sf((ABSENT - np.log(PRIOR.unlisted)) / PRIOR.unlisted_spread)
    )
    assert unlisted / healthy == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    ("name", "median", "spread"),
    [
        ("standing", PRIOR.referenced, PRIOR.referenced_spread),
        ("change", PRIOR.change, PRIOR.change_spread),
    ],
)
def test_scales_are_lognormal_with_references(name, median, spread):
    half = integral(name, -20, np.log(median), True, True)
    whole = integral(name, -20, 20, True, True)
    assert half / whole == pytest.approx(0.5, rel=1e-6)
    lower = integral(name, -20, np.log(median) - spread, True, True)
    assert lower / whole == pytest.approx(norm.cdf(-1), rel=1e-6)


def test_a_scale_that_nothing_tells_has_no_prior():
    for referenced in (False, True):
        assert density(referenced, False, change=-3.0) == density(referenced, False, change=2.0)
        assert density(referenced, True, change=-3.0) != density(referenced, True, change=2.0)
    assert density(False, True, new=0.0) == density(False, True, new=4.0)
