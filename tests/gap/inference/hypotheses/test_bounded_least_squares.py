import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hyperleg_design.gap.inference.hypotheses.bounded_least_squares import within_bounds


@given(st.integers(1, 8), st.integers(0, 10**6))
def test_least_squares_within_bounds_are_the_least(count, seed):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((count, count)) * 10 ** rng.uniform(-2, 2, count)
    matrix, right = (
        root.T @ root + 1e-2 * np.eye(count),
        10 * rng.standard_normal(count) * np.linalg.norm(root, axis=0),
    )
    low = np.where(rng.random(count) < 0.2, -np.inf, -rng.random(count))
    high = np.where(rng.random(count) < 0.2, low, rng.random(count))
    high = np.where(np.isfinite(high), high, 0.0)
    phi = within_bounds(matrix, right, low, high)
    assert ((phi >= low) & (phi <= high)).all()
    slope, small = matrix @ phi - right, 1e-6 * (np.abs(matrix) @ np.abs(phi) + np.abs(right))
    assert (slope[phi > low] <= small[phi > low]).all(), "what could be less would make it better"
    assert (slope[phi < high] >= -small[phi < high]).all(), (
        "what could be more would make it better"
    )
