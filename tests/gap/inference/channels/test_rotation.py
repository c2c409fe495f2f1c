import numpy as np

from hyperleg_design.gap.inference.channels.rotation import rotated


def columns(scale):
    rng = np.random.default_rng(3)
    return [scale[:, None] * rng.normal(size=(len(scale), 40)) for _ in range(2)]


def test_a_rotation_changes_no_covariance_and_keeps_kinds_of_columns_apart():
    white = columns(np.ones(7))
    turned, known, steady = rotated(white, 1, 3, 1e-6)
    assert (known, steady) == (1, 3)
    for before, after in zip(white, turned, strict=True):
        np.testing.assert_array_equal(after[-1], before[-1])
        for part in (slice(1), slice(1, 3), slice(3, -1)):
            np.testing.assert_allclose(after[part].T @ after[part], before[part].T @ before[part])


def test_directions_that_no_sample_shows_are_left_out_but_one():
    white = columns(np.array([1.0, 1e-6, 1.0, 1e-6, 1e-6, 1.0]))
    turned, known, steady = rotated(white, 0, 2, 1e-6)
    assert (known, steady) == (0, 1)
    assert len(turned[0]) == 1 + 1 + 1
    nothing = [0 * one for one in white]
    turned, known, steady = rotated(nothing, 1, 2, 1e-6)
    assert (len(turned[0]), known, steady) == (2, 0, 0)
