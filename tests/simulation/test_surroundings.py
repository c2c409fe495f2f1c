"""Slopes, uneven floors and weak motors act as mechanics says."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.mjcf import FLOOR
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.settings import Randomisation, Start
from hyperleg_design.simulation.surroundings import (
    CELL,
    EDGE,
    FLAT,
    Slope,
    TorqueConstants,
    UnevenFloor,
)
from hyperleg_design.simulation.tasks import load_task


@pytest.fixture
def standing(hyperleg):
    """An environment in which robots face along x."""

    def made(*alterations):
        task = load_task("walk_free")
        start = Start(joint_position=0.0, tilt=0.0, yaw=0.0)
        environment = Environment(
            hyperleg,
            task.changed(start=start),
            simulations=2,
            threads=1,
            alterations=alterations or None,
        )
        environment.reset()
        return environment

    return made


def test_uphill_a_falling_robot_falls_back_along_x(hyperleg):
    model = simulation_model(hyperleg, alterations=(Slope(5.0),))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[2] += 2.0
    for _ in range(10):
        mujoco.mj_step(model, data)
    angle, time = np.deg2rad(5.0), 10 * model.opt.timestep
    expected = -9.81 * time * np.array([np.sin(angle), 0.0, np.cos(angle)])
    np.testing.assert_allclose(data.qvel[:3], expected, atol=1e-6)


def test_on_a_slope_the_robot_is_told_the_true_vertical(standing):
    environment = standing(Slope(5.0))
    for _ in range(5):
        step = environment.step(np.zeros((2, 14)))
    names = environment.observation_columns["policy"]
    gravity = step.observations["policy"][:, [names.index(f"gravity.{i}") for i in range(3)]]
    motion = environment.chunks[0].motion
    down = -np.array([np.sin(np.deg2rad(5.0)), 0.0, np.cos(np.deg2rad(5.0))])
    expected = [rotation.T @ down for rotation in motion.rotation]
    np.testing.assert_allclose(gravity, expected, atol=1e-6)


def test_no_slope_is_the_flat_floor(standing):
    flat, sloped = standing(), standing(Slope(0.0))
    for _ in range(5):
        a, b = (e.step(np.zeros((2, 14))).observations["policy"] for e in (flat, sloped))
    np.testing.assert_allclose(a, b, atol=1e-5)


def test_an_uneven_floor_is_flat_at_the_start_and_as_high_as_asked(hyperleg):
    floor = UnevenFloor(0.04, seed=3)
    model = simulation_model(hyperleg, alterations=(floor,))
    assert model.geom(FLOOR).type == mujoco.mjtGeom.mjGEOM_HFIELD
    heights = model.hfield_data.reshape(floor.heights().shape)
    np.testing.assert_allclose(heights, floor.heights(), atol=1e-6)
    assert (heights.min(), heights.max()) == (0.0, 1.0)
    top = model.geom(FLOOR).pos[2] + 0.04 * heights
    assert np.ptp(top) == pytest.approx(0.04)
    assert (top == pytest.approx(0.0)) is False
    assert np.sum(np.isclose(top, 0.0, atol=1e-9)) >= (2 * int(FLAT / CELL) + 1) ** 2
    assert model.hfield_size[0][:2] == pytest.approx([EDGE / 2, EDGE / 2])


def test_a_robot_stands_on_the_flat_part_of_an_uneven_floor(standing):
    """As long as it stays there its feet carry its weight, and it does not fall through."""
    environment = standing(UnevenFloor(0.05))
    for _ in range(20):
        step = environment.step(np.zeros((2, 14)))
    assert not step.terminated.any()
    load = environment.chunks[0].sensors[..., 0::6].sum(-1).mean(0)
    assert load == pytest.approx(environment.layout.weight, rel=0.2)


def test_a_task_states_the_floor_and_the_seed_draws_it(hyperleg):
    task = load_task("walk_free")
    uneven = task.changed(randomisation=Randomisation(uneven_floor=0.03))
    floors = []
    for seed in (1, 1, 2):
        environment = Environment(hyperleg, uneven, simulations=2, seed=seed, threads=1)
        assert environment.model.hfield_size[0, 2] == pytest.approx(0.03)
        floors.append(environment.model.hfield_data.copy())
        environment.close()
    np.testing.assert_array_equal(floors[0], floors[1])
    assert np.abs(floors[0] - floors[2]).max() > 0.5


def test_weak_motors_give_less_than_their_drives_believe(standing):
    torque = {}
    for factor in (1.0, 0.9):
        environment = standing(TorqueConstants(factor))
        environment.step(np.zeros((2, 14)))
        torque[factor] = environment.chunks[0].motor_torque[0].copy()
    np.testing.assert_allclose(torque[0.9], 0.9 * torque[1.0], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Slope(60.0), "degrees"),
        (lambda: UnevenFloor(0.0), "height"),
        (lambda: TorqueConstants(0.0), "factor"),
    ],
)
def test_senseless_surroundings_are_refused(make, word):
    with pytest.raises(InputError, match=word):
        make()
