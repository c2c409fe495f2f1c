from __future__ import annotations

import numpy as np

from hyperleg_design.learning.design_sampler import DesignSampler
from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.design_observation import DesignRanges, Range
from hyperleg_design.simulation.design_spread import DesignSpread

SPREAD = DesignSpread(
    ranges=DesignRanges({"toe.mass": Range(0.05, 1.0, log=True), "thigh.length": Range(0.34, 0.4)}),
    pool=8,
)


def sampler(simulations: int = 24, seed: int = 0) -> DesignSampler:
    return DesignSampler(load_design("toe"), SPREAD, simulations, seed)


def test_at_first_all_designs_are_drawn_evenly() -> None:
    np.testing.assert_array_equal(np.bincount(sampler().assigned, minlength=8), np.full(8, 3))


def test_designs_with_which_the_policy_falls_are_drawn_more_often() -> None:
    drawn = sampler(32)
    for _ in range(50):
        drawn.note((drawn.assigned == 5).astype(float))
    drawn.redraw()
    counts = np.bincount(drawn.assigned, minlength=8)
    assert counts[5] == 18  # half of all, and an eighth of the other half
    assert counts.min() >= 2
    np.testing.assert_allclose(drawn.probability.sum(), 1)


def test_simulations_have_the_leaves_of_their_design() -> None:
    drawn = sampler()
    np.testing.assert_array_equal(drawn.design["toe.mass"], drawn.pool["toe.mass"][drawn.assigned])


def test_goes_on_from_its_state() -> None:
    drawn, other = sampler(seed=3), sampler(seed=3)
    drawn.note(np.arange(24) % 3 == 0)
    drawn.redraw()
    drawn.note(np.arange(24) % 5 == 0)
    other.put(drawn.state())
    for one in (drawn, other):
        one.redraw()
    np.testing.assert_array_equal(drawn.assigned, other.assigned)
    assert drawn.environment_seed == other.environment_seed != sampler(seed=3).environment_seed
