from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation.alteration import Alteration, Live
from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.state import read_motion
from hyperleg_design.simulation.stepping.sensing import sensed


@pytest.fixture
def state():
    rng = np.random.default_rng(0)
    position, velocity = rng.normal(size=(4, 21)), rng.normal(size=(4, 20))
    position[:, 3:7] /= np.linalg.norm(position[:, 3:7], axis=-1, keepdims=True)
    return position, velocity


@pytest.fixture
def motion(state):
    return read_motion(*state)


class Shifted(Alteration):
    """Encoders of the second simulation are off."""


class _Shifted(Live):
    def measured(self, position, velocity):
        position[1] += 0.1
        return position, velocity


Shifted.live = _Shifted


def chain(design, alteration):
    return Chain(machine_of(design), (alteration,), 4, 0.005)


def test_without_alterations_nothing_is_sensed_apart_from_the_truth(motion) -> None:
    assert sensed(None, motion) is None


def test_alterations_that_change_nothing_leave_the_truth(motion, design) -> None:
    found = sensed(chain(design, Alteration()), motion)
    np.testing.assert_array_equal(found.joint_position, motion.joint_position)
    np.testing.assert_array_equal(found.angular_velocity, motion.angular_velocity)
    np.testing.assert_allclose(found.gravity, motion.gravity, atol=1e-12)


def test_rows_are_those_of_the_simulations_they_are_asked_for(state, design) -> None:
    ids = np.array([1, 3])
    part = read_motion(*(values[ids] for values in state))
    change = sensed(chain(design, Shifted()), part, ids=ids).joint_position - part.joint_position
    np.testing.assert_allclose(change[0], 0.1)
    np.testing.assert_array_equal(change[1], 0.0)


def test_gravity_is_against_the_vertical_that_alterations_give(motion, design) -> None:
    vertical = np.array([0.6, 0.0, 0.8])
    found = sensed(chain(design, Alteration()), motion, vertical)
    expected = -np.einsum("i,nij->nj", vertical, motion.rotation)
    np.testing.assert_allclose(found.gravity, expected, atol=1e-12)
