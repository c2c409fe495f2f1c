"""The walk protocol on a planned walk that the sizing room has measured, and in simulation with
policies that cannot walk.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures, rollout
from hyperleg_design.evaluation.evaluate import evaluate
from hyperleg_design.evaluation.motion.steps import foot_contacts
from hyperleg_design.evaluation.policy import standing
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.evaluation.protocols.walk import measure_walk, walk_task
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.settings import Start
from hyperleg_design.simulation.stepping.partition import SMALLEST_SPLIT
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.terms.assist import Assist
from hyperleg_design.sizing.motions.walk import WalkPlan


class Scripted:
    """Policy that plays a sequence of actions `(steps, J)`, the same in all trials, and holds the
    last.
    """

    def __init__(self, actions: np.ndarray) -> None:
        self.actions, self.step = actions, 0

    def reset(self, trials: int) -> None:
        self.step = 0

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        row = self.actions[min(self.step, len(self.actions) - 1)]
        self.step += 1
        return np.broadcast_to(row, (len(observation), len(row)))


PLAN = WalkPlan()
SHORT = WalkProtocol(trials=4, time_limit=16.0)


@pytest.fixture(scope="module")
def measured(planned_trial):
    return measure_walk(planned_trial, WalkProtocol())


def test_power_and_cost_of_transport_are_those_of_the_sizing_room(measured, planned):
    found, _, _ = measured
    whole = planned.summary()
    assert found["steady_power"] == pytest.approx(whole["motor_side"], rel=1e-9)
    assert found["steady_joule_power"] == pytest.approx(whole["joule"], rel=1e-9)
    assert found["steady_mechanical_power"] == pytest.approx(whole["mechanical"], rel=1e-9)
    assert found["steady_positive_power"] - found["steady_negative_power"] == pytest.approx(
        whole["mechanical_absolute"], rel=1e-9
    )
    assert found["steady_battery_power"] == pytest.approx(whole["battery"], rel=1e-9)
    assert found["steady_cost_of_transport"] == pytest.approx(whole["cost_of_transport"], rel=1e-9)
    assert found["steady_battery_cost_of_transport"] == pytest.approx(
        whole["cost_of_transport_battery"], rel=1e-9
    )
    assert found["cost_of_transport"] == pytest.approx(
        whole["cost_of_transport"], rel=1e-3
    )  # its last stride is cut


def test_gait_is_the_planned_one(measured):
    found, _, _ = measured
    assert found["steady_speed"] == pytest.approx(PLAN.speed)
    assert found["time"] == pytest.approx(20 / PLAN.speed, abs=0.02)
    assert found["cadence"] == pytest.approx(1 / PLAN.step_time)
    assert found["step_length"] == pytest.approx(PLAN.speed * PLAN.step_time, rel=1e-6)
    assert found["double_support"] == pytest.approx(PLAN.double_support, abs=0.02)
    assert found["duty_factor"] == pytest.approx((1 + PLAN.double_support) / 2, abs=0.01)
    assert found["duty_factor"] > found["heel_off"] > 0.4
    assert (found["flight"], found["alternation"], found["heel_or_flat"]) == (0, 1, 1)
    assert found["heel_lead"] == pytest.approx(
        PLAN.foot_flat * PLAN.double_support * PLAN.step_time, abs=0.011
    )
    assert (found["arrived"], found["fell"], found["largest_tilt"], found["turned"]) == (1, 0, 0, 0)


def test_slip_is_the_sliding_speed_over_the_contact(measured):
    found, _, _ = measured
    contact = found["duty_factor"] * 2 * PLAN.step_time
    assert found["slip_per_step"] == pytest.approx(0.01 * contact, abs=1e-4)


def test_nothing_depends_on_place_and_heading(measured, turned_trial):
    found, _, _ = measure_walk(turned_trial, WalkProtocol())
    for name, value in measured[0].items():
        assert found[name] == pytest.approx(value, rel=1e-6, abs=1e-6, nan_ok=True), name


def test_right_leg_power_is_half_of_a_symmetric_walk(measured, planned):
    means = measured[2].means
    assert means["total"] == pytest.approx(planned.power.motor_side / 2, rel=2e-3)
    assert means["joule"] == pytest.approx(planned.power.joule / 2, rel=2e-3)
    assert sum(means[g] for g in ("hip", "knee", "ankle", "toe")) == pytest.approx(
        planned.power.mechanical / 2, rel=5e-3
    )


def test_every_measure_is_described_and_none_besides(measured):
    assert list(measured[0]) == list(measures.WALK)
    absent = {name for name, value in measured[0].items() if np.isnan(value)}
    assert absent == {"stop_absorbed_power", "stop_returned_power"}  # of stops nobody recorded


def test_a_fall_has_no_steady_state_but_is_there(planned_trial):
    fallen = dataclasses.replace(planned_trial, outcome=rollout.FELL)
    found, use, cycle = measure_walk(fallen, WalkProtocol())
    assert found["fell"] == 1
    assert found["arrived"] == 0
    assert np.isnan([found["time"], found["steady_power"], found["grf_peak"]]).all()
    assert found["power"] > 0
    assert use is None
    assert cycle is None


def test_a_diverged_trial_gives_no_number(planned_trial):
    found, _, _ = measure_walk(
        dataclasses.replace(planned_trial, outcome=rollout.DIVERGED), WalkProtocol()
    )
    assert found.pop("diverged") == 1
    assert list(found) == [name for name in measures.WALK if name != "diverged"]
    assert all(np.isnan(v) or v == 0 for v in found.values())


def test_too_few_strides_are_no_steady_state(planned_trial):
    found, _, _ = measure_walk(planned_trial, WalkProtocol(steady=Steady(begin=4.0, end=5.0)))
    assert np.isnan(found["steady_power"])


def test_standing_falls_and_falls_are_counted(design):
    """The default posture under the joint controller alone does not hold: an honest zero."""
    found = evaluate(standing(14), SHORT, design=design, task=load_task("walk"))
    assert found.outcomes == ["fell"] * 4
    assert found.values("fell").tolist() == [1] * 4
    assert np.all(found.values("distance") < 2)
    assert [t.samples * t.time_step < t.end_time < 10 for t in found.trials] == [True] * 4
    with pytest.raises(InputError, match="measure"):
        found.values("no_such")


def test_same_seed_same_bytes_whatever_the_threads(design):
    protocol = WalkProtocol(
        trials=SMALLEST_SPLIT, distance=1.0, time_limit=1.2, steady=Steady(begin=0.5)
    )  # so there are two chunks
    actions = Scripted(0.3 * np.random.default_rng(0).normal(size=(200, 14)))
    one, two = (
        evaluate(actions, protocol, design=design, task=load_task("walk"), threads=n)
        for n in (1, 2)
    )
    for name in measures.WALK:
        assert np.array_equal(one.values(name), two.values(name), equal_nan=True)
    assert all(
        np.array_equal(getattr(a, n), getattr(b, n))
        for a, b in zip(one.trials, two.trials, strict=True)
        for n in rollout.SIGNALS
    )
    other = evaluate(actions, protocol.changed(seed=1), design=design, task=load_task("walk"))
    assert not np.array_equal(one.values("distance"), other.values("distance"))


def test_the_task_is_the_policys_under_the_protocol():
    task = walk_task(load_task("walk"), WalkProtocol(speed=1.0, distance=10))
    assert (task.commands.test_speed, task.commands.test_share) == (1.0, 1.0)
    assert task.observations == load_task("walk").observations
    assert task.randomisation.push_speed == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda d: evaluate(standing(14), SHORT, design=d, task=load_task("goal")),
            "expects velocity commands",
        ),
        (lambda d: evaluate(standing(14), SHORT, design=d), "task: is needed"),
        (lambda d: evaluate(standing(14), SHORT), "design: is needed"),
        (
            lambda d: evaluate(standing(12), SHORT, design=d, task=load_task("walk")),
            "another robot",
        ),
        (
            lambda d: evaluate(
                standing(14), SHORT.changed(heading_gain=1.0), design=d, task=load_task("walk")
            ),
            "trained without turning",
        ),
    ],
)
def test_what_does_not_fit_is_refused(design, call, message):
    with pytest.raises(InputError, match=message):
        call(design)


@pytest.fixture(scope="module")
def march(design):
    """A robot in simulation that lifts its legs by turns once a second, held upright and pulled
    along by the assist, of which a single robot gets all.
    """
    protocol = WalkProtocol(
        speed=0.6,
        distance=3.0,
        time_limit=8.0,
        trials=1,
        start=Start(joint_position=0, tilt=0),
        steady=Steady(begin=0.5),
    )
    layout = layout_of(design)
    phase = (np.arange(1, 401)[:, None] * 0.02 + np.array([0.0, 0.5])) % 1.0
    lift = np.where(phase < 0.5, np.sin(2 * np.pi * phase), 0.0)
    actions = np.zeros((400, 14))
    for joint, share in (("hip_pitch", -1.6), ("knee", 2.2), ("ankle_pitch", -0.6)):
        actions[:, layout.joint_indices(joint)] = share * lift
    environment = Environment(design, walk_task(load_task("walk"), protocol), simulations=1)

    def help_along(made):
        made.assist = Assist()

    trials = rollout.record(
        Scripted(actions),
        environment,
        protocol.time_limit,
        before_step=help_along,
        arrived=lambda first, now: np.linalg.norm(now[:, :2] - first[:, :2], axis=-1) >= 3.0,
    )
    return trials, [measure_walk(trial, protocol) for trial in trials]


def test_simulated_steps_are_found_as_they_were_commanded(march):
    for trial, (found, _, _) in zip(*march, strict=True):
        assert trial.outcome == rollout.ARRIVED
        assert found["cadence"] == pytest.approx(2.0, rel=0.01)
        assert found["alternation"] == 1
        assert found["step_length"] * found["cadence"] == pytest.approx(
            found["steady_speed"], rel=0.02
        )
        assert found["time"] == pytest.approx(trial.end_time, abs=0.02)
        assert found["double_support"] + found["single_support"] + found["flight"] == pytest.approx(
            1
        )
        assert found["duty_factor"] == pytest.approx(
            (1 + found["double_support"] - found["flight"]) / 2, abs=0.01
        )


def test_simulated_impacts_bear_on_the_simulations_forces(march):
    trial, (found, _, _) = march[0][0], march[1][0]
    assert 0.5 < found["grf_peak_body_weights"] < 4
    assert found["grf_peak"] < found["grf_raw_peak"] <= trial.foot_load.max()
    mean = trial.foot_load.sum(-1).mean() / trial.layout.weight
    assert mean == pytest.approx(
        1.0, abs=0.05
    )  # the assist pulls forward and turns, it does not carry


def test_simulated_feet_drift_no_farther_than_they_slide(march):
    for found, _, _ in march[1]:
        assert 0 < found["foot_drift"] < found["slip_per_step"] <= found["largest_slip"]


def test_drift_is_how_far_a_flat_foot_was_carried(planned_trial):
    """Sliding at a speed while flat: the drift is speed times the time for which the foot is
    flat.
    """
    protocol = WalkProtocol()
    time = np.arange(planned_trial.samples) * planned_trial.time_step
    moved = planned_trial.base_position + np.column_stack([0.1 * time, 0 * time, 0 * time])
    plain, carried = (
        measure_walk(t, protocol)[0]["foot_drift"]
        for t in (planned_trial, dataclasses.replace(planned_trial, base_position=moved))
    )
    contacts = foot_contacts(planned_trial, protocol.events)
    flat = (contacts.heel & contacts.forefoot)[:168, 0].sum() * 0.005
    assert plain < 0.002
    assert carried == pytest.approx(0.1 * flat, abs=0.003)
