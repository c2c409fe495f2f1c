from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.inference.gap_size import GapSize
from hyperleg_design.gap.inference.rules import InferenceRules

COUNT = 40


def size(
    before, after, noise, residuals=("motion", "motion"), shown=None, hinge=(True, True), odd=None
):
    """Of channels of the same number of samples, whose squares are given; causes show in all, or in
    those that are `shown`, and something unlisted acts in those that are `odd`.
    """
    number = len(residuals) * COUNT
    channels = tuple(
        SimpleNamespace(
            residual=kind, name=f"joint_{i}", under_test=np.arange(i * COUNT, (i + 1) * COUNT)
        )
        for i, kind in enumerate(residuals)
    )
    samples = SimpleNamespace(share=np.ones(number), floor=np.full(number, 0.25))
    tests = SimpleNamespace(value=np.zeros(number), block=np.arange(number) % 8)
    subject = SimpleNamespace(
        joints=("joint_0", "joint_1"),
        motors=("joint_0", "joint_1"),
        joint_from_motor=np.eye(2),
        tree=SimpleNamespace(hinge=np.array(hinge)),
    )
    signals = (SimpleNamespace(subject=subject),)
    evidence = SimpleNamespace(
        signals=signals,
        channels=channels,
        samples=samples,
        tests=tests,
        weight=np.full(number, 4.0),
    )
    spread = lambda squares: np.repeat(np.sqrt(squares), COUNT) / 4.0  # noqa: E731
    trace = np.repeat(np.ones(len(residuals)) if shown is None else np.array(shown, float), COUNT)
    held = SimpleNamespace(
        before=spread(before), after=spread(after), noise=spread(noise), trace=trace
    )
    sizes = (np.array(one, float) for one in (before, after, noise))
    others = np.zeros(len(residuals), bool) if odd is None else np.array(odd)
    return GapSize(evidence, held, *sizes, others, InferenceRules())


def test_the_share_closed_is_that_of_the_root_mean_squares_beyond_noise():
    found = size([25.0, 1.0], [9.0, 1.0], [1.0, 1.0])
    assert found.counts.tolist() == [True, False]
    assert found.closed == pytest.approx((5 - 3) / (5 - 1))
    assert found.expected == pytest.approx(0.25)  # floors of 0.25
    assert found.unit == "Nm"


def test_no_gap_is_closed_where_there_is_none_and_never_more_than_all():
    assert size([1.0, 1.0], [1.0, 1.0], [1.0, 1.0]).closed == 0.0
    assert size([25.0, 25.0], [0.5, 0.5], [1.0, 1.0]).closed == 1.0


def test_causes_that_make_it_worse_close_less_than_nothing():
    assert size([4.0, 4.0], [9.0, 9.0], [1.0, 1.0]).closed == pytest.approx(-1.0)


def test_the_gap_of_causes_is_that_of_the_channels_in_which_they_show():
    squares = [25.0, 400.0], [1.0, 400.0], [1.0, 1.0]
    assert size(*squares, shown=[True, False]).counts.tolist() == [True, False]
    assert size(*squares, shown=[True, False]).closed == 1.0
    assert size(*squares, shown=[False, False]).counts.tolist() == [False, True]
    assert size(*squares, shown=[False, False]).closed == 0.0


def test_what_something_unlisted_leaves_elsewhere_counts_as_well():
    squares = [25.0, 400.0], [1.0, 400.0], [1.0, 1.0]
    found = size(*squares, shown=[True, False], odd=[False, True])
    assert found.counts.tolist() == [False, True]
    assert found.closed == 0.0
    smaller = size([25.0, 9.0], [1.0, 9.0], [1.0, 1.0], shown=[True, False], odd=[False, True])
    assert smaller.counts.tolist() == [True, True]
    assert smaller.closed == pytest.approx((np.sqrt(17) - np.sqrt(5)) / (np.sqrt(17) - 1))


def test_only_channels_in_the_unit_of_the_largest_excess_count():
    found = size([9.0, 25.0, 16.0], [1.0, 1.0, 1.0], [1.0] * 3, ("motion", "transmission", "drive"))
    assert found.counts.tolist() == [False, True, False]
    assert found.unit == "rad/s"


def test_the_unit_is_that_of_the_joints_that_count():
    large, small = [25.0, 1.0], [1.0, 1.0]
    for hinge, unit in ((False, True), "N"), ((True, False), "Nm"):
        assert size(large, small, small, hinge=hinge).unit == unit
    assert size([25.0, 25.0], small, small, hinge=(False, True)).unit == "N, Nm"
    assert size(large, small, small, ("transmission",) * 2, hinge=(False, True)).unit == "m/s"


def test_draws_of_equal_blocks_all_close_what_the_logs_close():
    found = size([25.0, 25.0], [9.0, 9.0], [1.0, 1.0])
    assert found.drawn(0) == pytest.approx(np.full(400, found.closed))
    np.testing.assert_array_equal(found.drawn(1), found.drawn(1))


def test_a_cause_closes_what_would_stay_open_without_it_where_it_closes_most():
    """Two causes at two joints, of which one leaves 30 times the residual of the other."""
    found = size([900.0, 4.0], [1.0, 1.0], [1.0, 1.0])
    first, second = np.repeat([1.0, 0.0], COUNT), np.repeat([0.0, 1.0], COUNT)
    left = (found.held.before - found.held.after) * (first + second)
    found.held.trace = left
    assert found.counts.tolist() == [True, False]
    assert found.closed_by(left * first, standing=False) == pytest.approx(1.0)
    assert found.closed_by(left * second, standing=False) == pytest.approx(1.0)
    half = left / 2  # the other half is closed by another cause at the same joints
    assert found.closed_by(half, standing=False) == pytest.approx((15.5 - 1) / (30 - 1))
    assert found.closed_by(half, standing=True) == pytest.approx(1.0)


def test_a_cause_that_makes_it_worse_everywhere_closes_less_than_nothing():
    found = size([16.0, 16.0], [16.0, 25.0], [1.0, 1.0])
    found.held.trace = (found.held.before - found.held.after) * np.ones(2 * COUNT)
    assert found.closed_by(found.held.trace, standing=False) == pytest.approx((4 - 5) / (4 - 1))
