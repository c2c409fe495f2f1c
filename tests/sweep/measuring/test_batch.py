"""Batches of designs against their designs one by one."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.robot.load import load_robot
from hyperleg_design.sweep.measuring.batch import Batch

MASSES, GEARS = np.array([2.0, 3.0, 2.5]), np.array([5.0, 9.0, 7.0])
VALUES = {"shank.mass": MASSES, "actuators.knee.gear": GEARS}


@pytest.fixture(scope="module")
def base():
    return load_robot("hyperleg")


@pytest.fixture(scope="module")
def batch(base):
    return Batch(base.with_values(VALUES, "batch"))


@pytest.mark.parametrize("place", range(3))
def test_a_design_is_the_same_in_a_batch_and_alone(base, batch, place):
    alone = Batch(base.with_values({k: float(v[place]) for k, v in VALUES.items()}, "one"))
    assert (batch.size, alone.size) == (3, 1)
    np.testing.assert_allclose(batch.walking[place], np.squeeze(alone.walking), rtol=1e-12)
    for both in zip(batch.below_hip(), alone.below_hip(), strict=True):
        many, one = (np.asarray(x) for x in both)
        many = np.broadcast_to(many, (3, *np.squeeze(one).shape))[place]
        np.testing.assert_allclose(many, np.squeeze(one), rtol=1e-12)
    for name, body in batch.inertials.items():
        mass = np.broadcast_to(body.mass, 3)[place]
        assert mass == pytest.approx(float(np.squeeze(alone.inertials[name].mass)))


def test_what_lies_below_the_hip_gives_the_power_of_its_motors(batch):
    matrix, peak = batch.below_hip()
    assert matrix.shape[-2:] == (4, 4)
    assert np.shape(peak)[-1] == 4
    # motors above do not move these joints: their columns of M are zero there
    assert not np.any(batch.walking[..., batch.start :, : batch.start])
    np.testing.assert_array_equal(matrix, batch.walking[..., 3:, 3:])


def test_of_a_tree_the_whole_limb_counts():
    tree = Batch(load_robot("mini_cheetah"))
    matrix, peak = tree.below_hip()
    np.testing.assert_array_equal(matrix, tree.walking)
    np.testing.assert_array_equal(peak, tree.envelope.peak_torque)
    assert tree.size == 1
