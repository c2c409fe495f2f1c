import numpy as np
import pytest

from hyperleg_design.gap.playback.windows import whole_log
from hyperleg_design.validation.baselines.population import predicted, squared_error


@pytest.mark.slow
def test_truth_closes_the_gap(rig):
    nothing = np.zeros(rig.drives.count)
    assert rig.held_out(rig.truth) < 0.2 * rig.held_out(nothing)


@pytest.mark.slow
def test_rows_of_a_population_do_not_touch_each_other(rig):
    one = rig.signals[0]
    several = np.stack([np.zeros(rig.drives.count), rig.truth, 0.3 * rig.drives.high])
    together = predicted(one, rig.drives, several)
    assert np.allclose(together[1], predicted(one, rig.drives, several[1:2])[0], atol=1e-12)
    errors = squared_error(one, together)
    assert errors[1] < errors[0] < errors[2]


def test_a_diverged_simulation_costs_infinitely_much(rig):
    lost = np.full((1, *rig.signals[0].position[whole_log(rig.signals[0]).ticks[0]].shape), np.nan)
    assert squared_error(rig.signals[0], lost) == np.inf


def test_delay_moves_the_prediction_by_that_time(rig):
    one = rig.signals[0]
    late = np.zeros((2, rig.drives.count))
    late[1, -1] = 0.02
    before, after = predicted(one, rig.drives, late)[:, :, 0]
    ticks = round(0.02 / one.step)
    assert np.abs(after[ticks:] - before[:-ticks]).max() < 0.1 * np.abs(after - before).max()
