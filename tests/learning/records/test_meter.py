from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.learning.records.meter import Meter
from hyperleg_design.robot.design import Design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task


def test_means_over_an_iteration_are_those_of_its_steps(hyperleg: Design) -> None:
    environment = Environment(hyperleg, load_task("walk"), simulations=12, threads=1)
    environment.reset()
    meter, rng = Meter(environment), np.random.default_rng(0)
    rewards, falls, speeds, ends = [], 0, [], 0
    for _ in range(150):
        step = environment.step(rng.normal(size=(12, 14)))
        meter.note(step)
        rewards.append(step.reward.mean())
        falls, ends = falls + int(step.terminated.sum()), ends + len(step.ended)
        speeds.append(environment.chunks[0].motion.walking_velocity[:, 0].mean())
    found = meter.read()
    assert falls > 5
    assert found["reward"] == pytest.approx(np.mean(rewards) / 0.02)
    assert sum(found["terms"].values()) == pytest.approx(found["reward"])
    assert found["falls"] == pytest.approx(falls / (150 * 12 * 0.02 / 60))
    assert found["episode"] == pytest.approx(150 * 12 / ends)
    assert found["speed"] == pytest.approx(np.mean(speeds))
    assert found["power"] == pytest.approx(found["terms"]["power"] / -1e-4)
    assert found["share"] == pytest.approx(found["terms"]["linear_velocity"] / 2.5)


def test_running_means_survive(hyperleg: Design) -> None:
    environment = Environment(hyperleg, load_task("goal"), simulations=4, threads=1)
    environment.reset()
    meters = [Meter(environment), Meter(environment)]
    for _ in range(3):
        meters[0].note(environment.step(np.zeros((4, 14))))
    meters[0].read()
    meters[1].put(meters[0].state())
    step = environment.step(np.zeros((4, 14)))
    for meter in meters:
        meter.note(step)
    assert str(meters[0].read()) == str(meters[1].read())  # some are nan


def test_share_of_the_speed_cap_is_the_speed_of_getting_closer(hyperleg: Design) -> None:
    environment = Environment(hyperleg, load_task("goal"), simulations=4, threads=1)
    environment.reset()
    meter = Meter(environment)
    for chunk in environment.chunks:  # all robots thrown ahead, toward waypoints that lie ahead
        chunk.drive.qvel[:, :2] = 1.2 * chunk.motion.heading
    first = environment.chunks[0].commander.best.copy()
    for _ in range(10):
        meter.note(environment.step(np.zeros((4, 14))))
    closer = (first - environment.chunks[0].commander.best).mean()
    assert closer > 0.05
    assert meter.read()["share"] == pytest.approx(closer / (10 * 0.02) / 1.4, rel=1e-6)
