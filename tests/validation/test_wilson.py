"""Wilson's interval of a share."""

from __future__ import annotations

import pytest

from hyperleg_design.validation.wilson import wilson


def test_wilson_interval():
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-3)
    assert wilson(18, 20) == pytest.approx((0.699, 0.972), abs=1e-3)


def test_of_no_case_nothing_is_known_and_impossible_counts_are_refused():
    assert wilson(0, 0) == (0.0, 1.0)
    with pytest.raises(ValueError, match="must"):
        wilson(3, 2)
