import numpy as np
import pytest

from hyperleg_design.gap.effects import effect


@pytest.mark.parametrize(
    ("mass", "declared", "beyond", "odds"),
    [
        (1.0, 0.0, 1, 0.0),
        (1.0, 0.0, 0, 2.0),
        (1.0, 0.0, 2, -3.0),
        (-1.0, 0.0, 1, -8.0),
        (-1.0, 2.0, 1, 0.0),
    ],
)
def test_loads_hang_at_the_ends_and_weigh_something(mass, declared, beyond, odds):
    values = np.array([mass, 0.0, 0.0, 0.0, 0.0])
    assert effect("payload").size_odds(values, np.ones(5), declared, beyond) == odds
