"""The walk protocol on robots other than HyperLeg: an open-loop trot of a quadruped, and a biped
that stands.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.measures import WALK
from hyperleg_design.evaluation.motion.power import power_constants
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.tasks import load_task

TROT = WalkProtocol(trials=1, distance=1.5, time_limit=8.0, steady=Steady(begin=0.4))


@dataclasses.dataclass
class Trot:
    """Feet on one diagonal swing together: hips to and fro, knees bent in swing."""

    period: float = 0.3
    step: int = 0

    def reset(self, trials: int) -> None:
        self.step = 0

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        time, action = 0.02 * self.step, np.zeros(12)
        self.step += 1
        for leg, behind in enumerate((0.0, 0.5, 0.5, 0.0)):
            share = (time / self.period + behind) % 1.0
            swings = share >= 0.5
            lift = 0.6 * np.sin((share - 0.5) * 2 * np.pi) if swings else 0.0
            sweep = 0.2 * (1 - 4 * (share - 0.5 if swings else share))
            action[3 * leg + 1] = (sweep if swings else -sweep) - 0.5 * lift
            action[3 * leg + 2] = lift
        return np.broadcast_to(min(1.0, 2 * time) * action / 0.3, (len(observation), 12))


@pytest.fixture(scope="module")
def trotted():
    return evaluate(
        Trot(), TROT, design=load_robot("mini_cheetah"), task=load_task("walk_any"), threads=1
    )


def test_a_trot_goes_somewhere_and_is_measured(trotted):
    found = trotted.measures[0]
    assert trotted.trials[0].outcome == "arrived"
    assert set(found) >= set(WALK)
    assert found["steady_speed"] > 0.2
    # four feet, each lifted once a period at most: one that only slides makes no step
    assert 2 / Trot.period < found["cadence"] < 4.2 / Trot.period
    assert found["double_support"] + found["single_support"] + found["flight"] < 1.0
    assert found["alternation"] > 0.9


def test_measures_of_what_the_robot_lacks_are_missing(trotted):
    found = trotted.measures[0]
    lacking = ("step_length", "heel_lead", "heel_off", "ankle_push_off_power", "right_knee_power")
    assert np.isnan([found[name] for name in lacking]).all()
    assert trotted.cycles == [None]


def test_power_of_all_twelve_motors_is_counted(trotted):
    (trial,) = trotted.trials
    heat = (power_constants(trial) * trial.motor_torque**2).sum(-1)
    mechanical = (trial.motor_torque * trial.motor_velocity).sum(-1)
    assert trotted.measures[0]["joule_power"] == pytest.approx(heat.mean())
    assert trotted.measures[0]["mechanical_power"] == pytest.approx(mechanical.mean())
    use = trotted.motors[0]
    assert use is not None
    assert use.motors == trial.layout.motors
    assert np.all(use.limit_share >= 0)


def test_feet_carry_the_weight_of_the_robot(trotted):
    (trial,) = trotted.trials
    assert trial.foot_load.shape == (trial.samples, 4)
    mean = trial.foot_load[trial.samples // 2 :].sum(-1).mean()
    assert mean == pytest.approx(trial.layout.weight, rel=0.05)


def test_a_biped_with_a_parallel_ankle_is_measured_like_hyperleg():
    protocol = WalkProtocol(trials=1, distance=0.5, time_limit=1.0, steady=Steady(begin=0.1))
    robot, task = load_robot("parallel_ankle"), load_task("walk_any")
    posture = task.changed(
        physics=dataclasses.replace(task.physics, posture_dependent=True),
    )
    found = evaluate(standing(12), protocol, design=robot, task=posture, threads=1)
    (trial,) = found.trials
    assert trial.outcome == "timed_out"
    assert trial.foot_load[-1].sum() == pytest.approx(trial.layout.weight, rel=0.2)


def test_the_shipped_quadruped_walks():
    protocol = WalkProtocol(trials=2, distance=4.0, time_limit=8.0, steady=Steady(begin=1.5))
    found = evaluate("walk_any-mini_cheetah-0", protocol, threads=1)
    assert [trial.outcome for trial in found.trials] == ["arrived", "arrived"]
    assert found.trained.kind == "specialist"
    assert found.measures[0]["flight"] < 0.3
