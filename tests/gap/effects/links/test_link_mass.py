import numpy as np
import pytest

from hyperleg_design.gap.effects import effect


@pytest.mark.parametrize(("share", "odds"), [(0.1, 0.0), (-0.8, 0.0), (1.0, -1.0), (-1.8, -5.0)])
def test_much_more_than_a_links_own_mass_is_rather_something_that_hangs_there(share, odds):
    own = 2.0
    found = effect("link_mass").size_odds(np.array([share * own]), np.array([0.1 * own]), 0.0, 1)
    assert found == pytest.approx(odds)
