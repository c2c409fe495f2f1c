import numpy as np
import pytest

from hyperleg_design.evaluation.effect_size import cliffs_delta, hedges_g

FIRST, SECOND = np.array([3.0, 4.0, 6.0]), np.array([1.0, 2.0, 2.0, 5.0])


def test_g_is_cohens_d_with_the_correction_for_few_values():
    pooled = np.sqrt((2 * FIRST.var(ddof=1) + 3 * SECOND.var(ddof=1)) / 5)
    d = (FIRST.mean() - SECOND.mean()) / pooled
    assert hedges_g(FIRST, SECOND) == pytest.approx(d * (1 - 3 / (4 * 7 - 9)))


def test_g_changes_sign_with_the_groups_and_not_with_unit_or_origin():
    g = hedges_g(FIRST, SECOND)
    assert hedges_g(SECOND, FIRST) == pytest.approx(-g)
    assert hedges_g(1000 * FIRST + 7, 1000 * SECOND + 7) == pytest.approx(g)


@pytest.mark.parametrize(("first", "second"), [([1.0], SECOND), ([2.0, 2.0], [1.0, 1.0])])
def test_g_needs_two_values_and_a_spread(first, second):
    assert np.isnan(hedges_g(first, second))


def test_delta_counts_pairs():
    greater = sum(a > b for a in FIRST for b in SECOND)
    less = sum(a < b for a in FIRST for b in SECOND)
    assert cliffs_delta(FIRST, SECOND) == pytest.approx((greater - less) / 12)
    assert cliffs_delta([2, 3], [0, 1]) == 1.0
    assert cliffs_delta([1, 1], [1]) == 0.0
