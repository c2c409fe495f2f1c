from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.rig_build import Reach, build_rig
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.rig_case import (
    ATTEMPTS,
    CALMED,
    _referred,
    _sized,
    calm,
    size_at,
)
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.wrong import SIZES


def test_size_is_found_between_the_tried_ones():
    size, reached = size_at(np.array([0.1, 1.0, 10.0]), np.array([0.2, 2.0, 20.0]), 4.0, 0.1)
    assert size == pytest.approx(2.0)
    assert reached == 4.0


def test_size_below_and_above_the_tried_ones():
    assert size_at(np.array([0.1, 1.0]), np.array([5.0, 50.0]), 1.0, 0.1) == (0.1, 5.0)
    assert size_at(np.array([0.1, 1.0]), np.array([0.1, 0.5]), 3.0, 0.1) == (1.0, 0.5)


def test_wild_rigs_are_not_taken():
    assert size_at(np.array([0.1, 1.0, 10.0]), np.array([0.5, 1.0, np.inf]), 3.0, 0.1) == (1.0, 1.0)
    assert size_at(np.array([0.1, 1.0]), np.array([np.inf, np.inf]), 3.0, 0.1)[1] == 0.0


@pytest.mark.parametrize(
    ("signal", "value", "whole"),
    [
        ("position", 3.0, True),
        ("position", -5.0, False),
        ("velocity", -200.0, False),
        ("velocity", np.nan, False),
    ],
)
def test_a_rig_that_turns_too_far_or_too_fast_has_gone_to_pieces(signal, value, whole):
    trace = SimpleNamespace(position=np.zeros((5, 2)), velocity=np.zeros((5, 2)))
    getattr(trace, signal)[3, 1] = value
    assert calm(trace) is whole


@pytest.mark.parametrize(("wild", "logs"), [(0, 2), (3, 2), (CALMED, 0)])
def test_reference_logs_are_of_a_rig_that_stays_whole(wild, logs):
    tries = []

    def traces(jobs):
        tries.append(jobs)
        most = 50.0 if len(tries) <= wild else 1.0
        return [
            SimpleNamespace(position=np.full((5, 2), most), velocity=np.zeros((5, 2))) for _ in jobs
        ]

    rig = SimpleNamespace(
        plan=SimpleNamespace(duration=10.0),
        motions=lambda count, duration, rng: [np.zeros((5, 2))] * count,
        traces=traces,
        logs=lambda traces, jobs: ["log" for _ in traces],
    )
    assert len(_referred(rig, np.random.default_rng(0))) == logs
    assert len(tries) == min(wild + 1, CALMED)


@pytest.mark.parametrize("known", [True, False])
def test_where_even_the_healthy_rig_goes_to_pieces_the_smallest_size_is_taken(known):
    broken = SimpleNamespace(position=np.full((5, 2), np.nan), velocity=np.zeros((5, 2)))
    tries = []

    def traces(jobs):
        tries.append(len(jobs))
        return [broken] * len(jobs)

    rig = SimpleNamespace(
        chain=chain("servo"),
        reach=Reach(np.ones(1), np.ones(1)) if known else None,
        plan=SimpleNamespace(duration=5.0),
        traces=traces,
        recorder=Recorder(),
        motions=lambda count, duration, rng: [np.zeros((3, 1))] * count,
    )
    wrong = _sized(rig, "coulomb_friction", 3.0, np.random.default_rng(0), [])
    assert wrong.size == SIZES["coulomb_friction"].smallest
    assert len(tries) == ATTEMPTS


def test_a_healthy_rig_is_the_data_sheet():
    robot = chain("arm")
    plant = build_rig(robot, perfect(robot))
    np.testing.assert_array_equal(plant.joint_from_motor, robot.joint_from_motor)
    np.testing.assert_array_equal(plant.rotor_inertia, robot.rotor_inertia)
    np.testing.assert_array_equal(plant.torque_scale, 1.0)
    assert not plant.offset.any()
