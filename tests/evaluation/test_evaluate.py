"""One call evaluates any policy under any protocol; many policies give the same in any number of
processes.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.evaluate import evaluate, evaluate_designs, evaluate_many
from hyperleg_design.evaluation.policy import load_policy, standing
from hyperleg_design.evaluation.protocol import (
    Protocol,
    Steady,
    TTestProtocol,
    WalkProtocol,
    load_protocol,
)
from hyperleg_design.evaluation.rollout import SIGNALS
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.settings import Randomisation, Start
from hyperleg_design.simulation.tasks import load_task

SHORT = WalkProtocol(trials=3, distance=2.0, time_limit=2.0, steady=Steady(begin=0.5))


def balance(design):
    """A policy that stands: ankles answer to the pelvis's lean and pitch rate."""
    ankles = layout_of(design).joint_indices("ankle_pitch")

    def act(observation):
        action = np.zeros((len(observation), 14))
        action[:, ankles] = (2.0 * observation[:, 3] + 0.6 * observation[:, 1] + 0.1)[:, None]
        return action

    return act


def test_the_task_chooses_the_protocol(design):
    assert isinstance(
        evaluate(standing(14), design=design, task=load_task("walk")).protocol, WalkProtocol
    )
    assert isinstance(
        evaluate(standing(14), design=design, task=load_task("goal")).protocol, TTestProtocol
    )
    with pytest.raises(InputError, match="expects a WalkProtocol"):
        evaluate(standing(14), Protocol(name="bare"), design=design, task=load_task("walk"))


def test_a_file_is_enough(make_onnx):
    found = evaluate(make_onnx(), SHORT)
    assert found.policy.endswith("/small")
    assert len(found.outcomes) == len(found.paths) == len(found.end_times) == 3
    for path in found.paths:
        assert path[0].tolist() == [0, 0]
        assert np.all(np.linalg.norm(path, axis=1) < 2)


def test_a_robot_that_stands_does_not_arrive_and_does_not_fall(design):
    protocol = SHORT.changed(time_limit=6.0, start=Start(joint_position=0, tilt=0))
    found = evaluate(balance(design), protocol, design=design, task=load_task("walk"))
    assert found.outcomes == ["timed_out"] * 3
    assert found.end_times == [6.0] * 3
    assert np.isnan(found.values("time")).all()
    assert np.all(found.values("distance") < 0.3)
    for trial in found.trials:
        assert trial.foot_load[-400:].sum(-1).mean() == pytest.approx(trial.layout.weight, rel=0.01)


def test_processes_change_nothing(make_onnx):
    files = [make_onnx(f"p{k}.onnx", bias=0.1 * k, seed=str(k)) for k in range(3)]
    seen = []
    alone = evaluate_many(
        files, SHORT, workers=1, progress=lambda one: seen.append(one.policy.split("/")[-1])
    )
    beside = evaluate_many(files, SHORT, workers=2)
    assert seen == ["p0", "p1", "p2"]
    assert [one.seed for one in beside] == [0, 1, 2]
    for a, b in zip(alone, beside, strict=True):
        assert a.measures[0].keys() == b.measures[0].keys()
        assert np.array_equal(
            [list(m.values()) for m in a.measures],
            [list(m.values()) for m in b.measures],
            equal_nan=True,
        )
        assert len(a.trials) == len(b.trials) == 1
        assert np.array_equal(a.trials[0].motor_torque, b.trials[0].motor_torque)


def test_each_policy_can_have_its_own_robot_and_keep_its_own_signals(make_onnx):
    files = [make_onnx(f"q{k}.onnx") for k in range(2)]
    heavy = {"pelvis.mass": 20.0}
    own, changed = evaluate_many(files, SHORT, workers=1, kept=[0, 2], overrides=[{}, heavy])
    assert (len(own.trials), len(changed.trials)) == (0, 2)
    assert changed.trials[0].mass == pytest.approx(32.0 + 20.0 - 15.46, abs=1e-6)
    assert not np.array_equal(own.values("distance"), changed.values("distance"))


def test_a_broken_file_stops_before_any_work(make_onnx, write):
    seen = []
    with pytest.raises(InputError, match="no whole ONNX file"):
        evaluate_many(
            [make_onnx(), write("broken.onnx", b"x")], SHORT, workers=1, progress=seen.append
        )
    assert seen == []
    with pytest.raises(InputError, match="workers"):
        evaluate_many([make_onnx()], SHORT, workers=0)


def test_alterations_change_what_is_measured_and_none_changes_no_bit(make_onnx):
    from hyperleg_design.simulation.drives.two_mass import Belt

    files = [make_onnx("a.onnx", bias=0.1), make_onnx("b.onnx", bias=0.2)]
    brief = SHORT.changed(trials=2)
    plain = evaluate_many(files, brief, workers=1)
    same = evaluate_many(files, brief, workers=1, alterations=lambda design: ())
    loose = (Belt("left_hip_pitch", compliance=5.0, play=0.5),)
    altered, beside = (evaluate_many(files, brief, workers=w, alterations=loose) for w in (1, 2))
    for one, other in ((plain, same), (altered, beside)):
        for a, b in zip(one, other, strict=True):
            assert all(np.array_equal(x, y) for x, y in zip(a.paths, b.paths, strict=True))
    assert not any(
        np.array_equal(a.paths[0], b.paths[0]) for a, b in zip(plain, altered, strict=True)
    )


def same(a, b):
    """Whether two evaluations hold the same numbers to the last digit."""
    assert a.outcomes == b.outcomes
    assert a.end_times == b.end_times
    for one, other in zip(a.trials, b.trials, strict=True):
        assert one.mass == other.mass
        for name in SIGNALS:
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    for one, other in zip(a.measures, b.measures, strict=True):
        assert list(one) == list(other)
        np.testing.assert_array_equal(list(one.values()), list(other.values()))
    for one, other in zip(a.motors, b.motors, strict=True):
        if one is not None or other is not None:
            np.testing.assert_array_equal(one.continuous_use, other.continuous_use)


@pytest.mark.parametrize(
    ("policy", "task"),
    [
        ("walk_upright-toe-1", "walk"),
        pytest.param("t_test_free-toe-0", "t_test", marks=pytest.mark.slow),
    ],
)
def test_a_batch_of_designs_gives_the_numbers_of_each_alone(policy, task):
    policy = load_policy(policy)
    designs = policy.design.with_values(
        {
            "toe.mass": np.array([0.27, 1.0, 0.1]),
            "transmission.scale.knee": np.array([1.0, 0.7, 1.4]),
            "shank.length": np.array([0.37, 0.37, 0.4]),
            "contact.friction": np.array([1.0, 0.8, 1.0]),
            "contact.pad_radius": policy.design.contact.pad_radius * np.array([1.0, 1.2, 1.0]),
            "joints.knee.default_deg": policy.design.joints.knee.default_deg + np.array([0, 2, 0]),
            "actuators.ankle.motor": np.array(["RI60", "RI70", "RI60"]),
        },
    )
    short = {"trials": 2, "time_limit": 10.5}
    if task == "walk":
        short |= {"time_limit": 4.0, "distance": 2.5, "steady": Steady(begin=1.0)}
    protocol = load_protocol(task).changed(**short)
    together = evaluate_designs(policy, designs, protocol, threads=2)
    for i, one in enumerate(together):
        same(one, evaluate(policy, protocol, design=designs.take(i), threads=1))
    assert len({one.trials[0].mass for one in together}) == 3


def test_trials_in_several_parts_are_those_of_each_design_alone(design):
    """From 32 simulations on, a design's trials are in two parts with random numbers each."""
    designs = design.with_values({"toe.mass": np.array([0.2, 0.4])})
    protocol = SHORT.changed(
        trials=33,
        time_limit=0.5,
        distance=0.6,
        steady=Steady(begin=0.3),
        randomisation=Randomisation(mass=0.1, gains=0.1),
    )
    together = evaluate_designs(standing(14), designs, protocol, task=load_task("walk"))
    for i, one in enumerate(together):
        alone = evaluate(standing(14), protocol, design=designs.take(i), task=load_task("walk"))
        same(one, alone)
    starts = [trial.joint_position[0] for trial in together[0].trials]
    assert len(np.unique(starts, axis=0)) == 33


def test_a_batch_goes_to_the_function_for_batches(design):
    designs = design.with_values({"toe.mass": np.array([0.2, 0.4])})
    with pytest.raises(InputError, match="use evaluate_designs"):
        evaluate(standing(14), SHORT, design=designs, task=load_task("walk"))


def test_designs_that_cannot_stand_are_named(design):
    designs = design.with_values({"thigh.length": np.array([0.37, 0.05, 0.37, 0.06])})
    with pytest.raises(InputError, match="lower than a fall") as caught:
        evaluate_designs(standing(14), designs, SHORT, task=load_task("walk"))
    assert caught.value.bad.tolist() == [False, True, False, True]
