"""What is off with every robot: a few per cent, and the same robot for one random state."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.validation.blind.plants import nuisance
from hyperleg_design.validation.blind.robots.catalogue import ROBOTS, chain

FACTORS = ("mass", "inertia", "rotor", "coulomb", "viscous", "torque")


@pytest.fixture(scope="module")
def arm():
    return chain("arm")


def test_nothing_is_off_a_perfect_robot(arm):
    perfect = nuisance.perfect(arm)
    for built, nominal in zip(nuisance.built(arm, perfect).links, arm.links, strict=True):
        assert built.mass == nominal.mass
        np.testing.assert_array_equal(built.com, nominal.com)
        np.testing.assert_array_equal(built.inertia, nominal.inertia)
    assert (perfect.delay, perfect.lag) == (0.0, 0.0)


@pytest.mark.parametrize("name", ROBOTS)
def test_deviations_have_the_robots_sizes_and_stay_small(name):
    robot = chain(name)
    n, m = robot.joint_from_motor.shape
    for seed in range(20):
        off = nuisance.of_robot(robot, np.random.default_rng(seed))
        assert off.mass.shape == off.coulomb.shape == off.offset.shape == (n,)
        assert off.rotor.shape == off.torque.shape == off.resonance.shape == (m,)
        for factor in FACTORS:
            assert np.all(
                np.abs(getattr(off, factor) - 1) <= 0.16 + 1e-12
            )  # two of the widest deviations
        assert np.all(off.breakaway > 1)  # sticking holds more than sliding
        assert np.all(off.resonance > 0)
        assert min(off.lag, off.delay) >= 0


def test_one_random_state_is_one_robot(arm):
    first, second, other = (
        dataclasses.asdict(nuisance.of_robot(arm, np.random.default_rng(s))) for s in (1, 1, 2)
    )
    for key, value in first.items():
        np.testing.assert_array_equal(value, second[key])
    assert np.all(first["mass"] != other["mass"])


def test_another_day_changes_friction_and_keeps_the_body(arm):
    rng = np.random.default_rng(3)
    robot = nuisance.of_robot(arm, rng)
    day = nuisance.of_day(arm, robot, rng)
    for kept in ("mass", "com", "inertia", "rotor", "resonance"):
        np.testing.assert_array_equal(getattr(day, kept), getattr(robot, kept))
    for drawn in ("coulomb", "viscous", "offset"):
        assert np.all(getattr(day, drawn) != getattr(robot, drawn))


def test_the_built_robot_has_the_mass_that_is_drawn(arm):
    off = nuisance.of_robot(arm, np.random.default_rng(4))
    total = sum(link.mass for link in nuisance.built(arm, off).links)
    assert total == pytest.approx(off.mass @ [link.mass for link in arm.links])
