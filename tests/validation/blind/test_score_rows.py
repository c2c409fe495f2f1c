import numpy as np
import pytest

from hyperleg_design.validation.blind.score_rows import calibration_error, wilson


def test_calibration():
    probability, right = (
        np.array([0.9] * 10 + [0.5] * 10),
        np.array([1] * 9 + [0] + [1] * 2 + [0] * 8),
    )
    assert calibration_error(probability, right) == pytest.approx(0.5 * 0 + 0.5 * 0.3)


def test_wilson_interval():
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-3)
    assert wilson(18, 20) == pytest.approx((0.699, 0.972), abs=1e-3)
