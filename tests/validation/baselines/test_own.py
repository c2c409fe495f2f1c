import numpy as np
import pytest

from hyperleg_design.validation.baselines.own import closed_loop_of, fit_own


def test_closed_loop_response_is_that_of_a_simulation(rig):
    one = rig.signals[0]
    values = np.zeros(rig.drives.count)
    loop = closed_loop_of(one, rig.drives, values)
    held = loop.response(np.ones((len(loop.damping), 1, 1)))[-1, 0, 0]
    posture = one.position[-1, 0]
    assert held == pytest.approx(1 / (6 + 0.5 * 9.81 * 0.1 * np.cos(posture)), rel=0.05)


def test_own_fit_finds_what_was_put_in(rig):
    found = fit_own(rig.signals[:2], rig.drives)
    assert rig.held_out(found.values) < 0.2 * rig.held_out(0 * found.values)
    assert found.values[:3] == pytest.approx(rig.truth[:3], rel=0.3)
    assert abs(found.values[3]) < 0.01
    assert found.values[4] < 0.003
