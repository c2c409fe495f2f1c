"""Intervals of shares lie inside 0 .. 1, whatever the shares are of."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.evaluation.measure_interval import measure_interval
from hyperleg_design.evaluation.measures import SHARES, T_TEST, WALK
from hyperleg_design.evaluation.statistics import estimate, share

GROUPS = [np.array([0.0, 0.01]), np.array([0.03, 0.05])]


@pytest.mark.parametrize("name", ["limit_share", "flight", "stop_share"])
def test_a_share_of_time_is_cut_to_0_and_1(name):
    free = estimate(GROUPS)
    assert free.low < 0
    interval = measure_interval(name, GROUPS)
    assert (interval.mean, interval.low, interval.high) == (free.mean, 0.0, free.high)
    above = measure_interval(name, [1 - group for group in GROUPS])
    assert above.high == 1.0


def test_outcomes_are_counted_and_other_measures_are_free():
    fell = [np.array([0.0, 1.0]), np.array([0.0, 0.0])]
    assert measure_interval("fell", fell) == share(fell)
    assert measure_interval("power", GROUPS) == estimate(GROUPS)
    assert np.isnan(measure_interval("limit_share", [np.array([np.nan])]).low)


def test_what_is_described_as_a_share_is_among_the_shares():
    described = {m.name for m in [*WALK.values(), *T_TEST.values()] if "share of" in m.meaning}
    assert described <= SHARES
