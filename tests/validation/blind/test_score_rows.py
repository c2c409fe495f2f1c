import numpy as np
import pytest

from hyperleg_design.validation.blind.score_rows import calibration_error


def test_calibration():
    probability, right = (
        np.array([0.9] * 10 + [0.5] * 10),
        np.array([1] * 9 + [0] + [1] * 2 + [0] * 8),
    )
    assert calibration_error(probability, right) == pytest.approx(0.5 * 0 + 0.5 * 0.3)
