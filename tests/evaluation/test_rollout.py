"""Recorded trials are what the simulation did."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.evaluation import rollout
from hyperleg_design.evaluation.motion.power import ledger, power_constants
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.rollout import record
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.settings import Limits, Physics, Randomisation, Start
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.terms.assist import Assist
from hyperleg_design.simulation.toe_swap import ANKLES, SHARE, Swap


@pytest.fixture
def environment(design):
    def made(simulations=3, **sections):
        return Environment(
            design,
            load_task("walk").changed(**{"physics": Physics(), **sections}),
            simulations=simulations,
        )

    return made


def test_heat_is_that_of_the_motors_as_simulated():
    """A swap that makes ankle motors larger lowers their heat at the same torque, and no other."""
    matched = load_design("toe_removed_matched")
    task = load_task("walk").changed(physics=Physics(), limits=Limits(duration=10))
    made = Environment(matched, task, simulations=2, alterations=Swap("toe_motor_to_ankle"))
    trial = record(standing(12), made, 0.2)[1]
    nominal = np.tile(motor_arrays(matched).power_constant[:6], 2)
    ratio = np.where([name in ANKLES for name in trial.layout.motors], 1 / SHARE, 1.0)
    np.testing.assert_allclose(power_constants(trial), nominal * ratio)
    joule = ledger(trial).mean_power().joule
    np.testing.assert_allclose(joule, nominal * ratio * (trial.motor_torque**2).mean(0), rtol=1e-9)
    plain = record(standing(12), Environment(matched, task, simulations=1), 0.2)[0]
    assert plain.power_constant is None


def test_signals_are_continuous_and_carry_the_weight(environment):
    made = environment(limits=Limits(duration=10))
    trials = record(standing(14), made, 0.5)
    for trial in trials:
        assert trial.samples == 100
        assert (trial.outcome, trial.end_time) == ("timed_out", 0.5)
        step = np.diff(trial.base_position, axis=0)
        assert step == pytest.approx(
            0.005 * trial.base_velocity[1:], abs=1e-9
        )  # semi-implicit Euler
        assert trial.foot_load[40:].sum(-1).mean() == pytest.approx(trial.layout.weight, rel=0.1)
        assert trial.mass == pytest.approx(32.0, abs=0.01)
        motor = np.sum(trial.motor_torque * trial.motor_velocity, -1)
        joint = np.sum(trial.driven_joint_torque * trial.joint_velocity, -1)
        assert motor == pytest.approx(joint, abs=1e-9)


def test_a_fall_keeps_the_samples_before_it(environment):
    made = environment()
    trials = record(standing(14), made, 5.0)
    for trial in trials:
        assert trial.outcome == rollout.FELL
        assert trial.end_time == pytest.approx(trial.samples * 0.005 + 0.02)
        assert trial.motor_torque[
            -1
        ].any()  # the fall's own step, which was started anew, is not in it
        assert np.all(trial.base_position[:, 2] > 0.55 - 0.05)


def test_arrival_ends_a_trial_and_not_the_others(environment):
    made = environment(limits=Limits(duration=10))
    trials = record(
        standing(14), made, 0.6, arrived=lambda first, now: np.array([True, False, True])
    )
    assert [t.outcome for t in trials] == ["arrived", "timed_out", "arrived"]
    assert [t.samples for t in trials] == [4, 120, 4]


def test_the_assist_is_taken_away(environment):
    made = environment()
    made.assist = Assist()
    helped = [t.samples for t in record(standing(14), made, 3.0)]
    assert made.assist is None
    assert helped == [t.samples for t in record(standing(14), environment(), 3.0)]


def test_a_diverged_trial_is_reported_with_its_state(environment, monkeypatch):
    from hyperleg_design.simulation.stepping.chunk import Chunk
    from hyperleg_design.simulation.stepping.step import Divergence
    from hyperleg_design.simulation.terms import terminations

    plain = Chunk._find_diverged

    def diverge(self, position, velocity):
        found = plain(self, position, velocity)
        if self.episode_step[1] == 5:
            found.append(
                Divergence(
                    1, 5, "speed without bounds", position[1], velocity[1], self.action[1].copy()
                )
            )
            self._start(np.array([1]))
        return found

    monkeypatch.setattr(Chunk, "_find_diverged", diverge)
    made = environment(start=Start(joint_position=0, tilt=0), limits=Limits(duration=10))
    trials = record(standing(14), made, 0.4)
    assert [t.outcome for t in trials] == ["timed_out", "diverged", "timed_out"]
    assert trials[1].samples == 16
    assert trials[1].divergence.reason == "speed without bounds"
    assert trials[1].divergence.position[2] == pytest.approx(
        trials[1].base_position[-1, 2], abs=0.01
    )
    assert trials[0].divergence is None
    assert terminations.ENDINGS[terminations.DIVERGED] == "diverged"


def test_a_policy_is_told_when_trials_begin(environment):
    class Told:
        """Policy that notes how many trials it was told of before each first step."""

        began = ()

        def reset(self, trials):
            self.began += (trials,)

        def __call__(self, observation):
            assert self.began
            return np.zeros((len(observation), 14))

    policy = Told()
    record(policy, environment(), 0.2)
    record(policy, environment(2), 0.2)
    assert policy.began == (3, 2)


FALLS = Start(tilt=0.5, joint_position=0.05)
"""Start in which some robots fall at once and others stand."""


def falling(**changes):
    """An environment in which some trials end long before others."""
    task = load_task("walk")
    settings = {
        "physics": Physics(),
        "limits": Limits(duration=10),
        "start": FALLS,
        "commands": dataclasses.replace(task.commands, interval=1000.0),
    }
    task = task.changed(**(settings | changes))
    return Environment(
        load_design("toe"), task, simulations=12, threads=1, common_random_numbers=True
    )


def test_trials_are_the_same_where_ended_ones_are_not_stepped_any_more(monkeypatch):
    both = []
    for draws in (False, True):
        monkeypatch.setattr(Environment, "draws_later", lambda self, duration, d=draws: d)
        both.append(record(standing(14), falling(), 0.6))
    assert {trial.outcome for trial in both[0]} == {"fell", "timed_out"}
    for frozen, stepped in zip(*both, strict=True):
        assert (frozen.outcome, frozen.end_time) == (stepped.outcome, stepped.end_time)
        for name in rollout.SIGNALS:
            assert getattr(frozen, name).tobytes() == getattr(stepped, name).tobytes()


def test_ended_trials_are_stepped_where_the_others_would_draw_other_numbers():
    assert not falling().draws_later(9.0)
    assert falling(randomisation=Randomisation(push_speed=0.5)).draws_later(9.0)
    assert falling(commands=load_task("walk").commands).draws_later(9.5)
    assert not falling(commands=load_task("walk").commands).draws_later(8.0)
    design, goal = load_design("toe"), load_task("goal")
    course = dataclasses.replace(goal.commands, course_share=1.0)
    for commands, expected in ((goal.commands, True), (course, False)):
        made = Environment(design, goal.changed(commands=commands), simulations=1)
        assert made.draws_later(1.0) is expected
    swapped = Environment(design, load_task("walk"), simulations=1, alterations=Swap("lock_toe"))
    assert swapped.draws_later(1.0)


def test_an_evaluation_needs_no_rewards_and_its_policy_sees_the_same():
    with_rewards, without = falling(), falling()
    without.rewarded = False
    seen = [with_rewards.reset()["policy"], without.reset()["policy"]]
    for _ in range(20):
        np.testing.assert_array_equal(*seen)
        steps = [made.step(np.zeros((12, 14))) for made in (with_rewards, without)]
        seen = [step.observations["policy"] for step in steps]
        np.testing.assert_array_equal(steps[0].ending, steps[1].ending)
    assert list(steps[1].observations) == ["policy"]
    assert np.any(steps[0].reward)
    assert not np.any(steps[1].reward)
