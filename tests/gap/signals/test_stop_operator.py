import numpy as np
import pytest

from hyperleg_design.gap.signals.stop_operator import stop


def test_the_stop_operator_stays_between_its_ends_and_turns_over_on_its_way():
    way = 0.01
    position = np.concatenate([np.linspace(0, 0.1, 200), np.linspace(0.1, 0.0, 200)])
    found = stop(position, way)
    assert np.abs(found).max() <= 1
    assert found[150] == 1
    turned = position[200 + np.argmax(found[200:] <= -1 + 1e-9)]
    assert turned == pytest.approx(0.1 - 2 * way, abs=2e-3)
