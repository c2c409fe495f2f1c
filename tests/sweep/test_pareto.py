import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from hyperleg_design.sweep.pareto import nondominated

# few different values, so that ties, nan and infinities happen often
VALUES = st.sampled_from([0.0, 1.0, 2.0, 3.0, -1.0, 0.5, np.inf, -np.inf, np.nan])


def brute_force(values, better):
    cost = values * [1.0 if b == "low" else -1.0 for b in better]
    keep = np.zeros(len(cost), bool)
    for i, point in enumerate(cost):
        if np.isnan(point).any():
            continue
        dominated = any(
            not np.isnan(o).any() and np.all(o <= point) and np.any(o < point) for o in cost
        )
        keep[i] = not dominated
    return keep


@given(
    data=st.data(),
    values=arrays(
        float, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=12), elements=VALUES
    ),
)
@settings(max_examples=200, deadline=None)
def test_equals_brute_force(data, values):
    better = data.draw(
        st.lists(
            st.sampled_from(["low", "high"]), min_size=values.shape[1], max_size=values.shape[1]
        )
    )
    np.testing.assert_array_equal(nondominated(values, better), brute_force(values, better))


@pytest.mark.parametrize("objectives", [1, 2, 3, 5])
def test_equals_brute_force_over_several_blocks(objectives):
    values = np.random.default_rng(objectives).normal(size=(1500, objectives)).round(1)
    better = ["low", "high", "low", "high", "low"][:objectives]
    cost = values * [1.0 if b == "low" else -1.0 for b in better]
    no_worse = np.all(cost[None] <= cost[:, None], -1) & np.any(cost[None] < cost[:, None], -1)
    np.testing.assert_array_equal(nondominated(values, better), ~no_worse.any(1))


def test_equal_points_all_stay_and_order_does_not_matter():
    values = np.array([[1.0, 1.0], [1.0, 1.0], [2.0, 0.0], [2.0, 1.0]])
    np.testing.assert_array_equal(nondominated(values, ["low", "low"]), [True, True, True, False])
    shuffle = np.random.default_rng(0).permutation(4)
    np.testing.assert_array_equal(
        nondominated(values[shuffle], ["low", "low"]), nondominated(values, ["low", "low"])[shuffle]
    )


def test_nothing_has_no_front():
    assert nondominated(np.empty((0, 2)), ["low", "high"]).shape == (0,)
    assert not nondominated(np.full((3, 2), np.nan), ["low", "high"]).any()


MISUSE = [
    (np.zeros(3), ["low"]),
    (np.zeros((3, 2)), ["low"]),
    (np.zeros((3, 1)), ["best"]),
    (np.zeros((3, 0)), []),
]


@pytest.mark.parametrize(("values", "better"), MISUSE)
def test_misuse_is_refused(values, better):
    with pytest.raises(ValueError, match="expects"):
        nondominated(values, better)
