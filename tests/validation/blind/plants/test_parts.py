from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.parts import (
    HISTORY,
    DelayLine,
    HostTargets,
    Ripple,
    UnlistedForces,
    stacked,
)

SENT = [False]


def test_a_command_arrives_after_its_delay_and_fractions_are_interpolated():
    line = DelayLine(np.array([[0.0, 0.003, 0.0045]]), 0.001)
    arrived = [
        line.send(tick, np.full((1, 3), float(tick)), np.array([SENT])) for tick in range(300)
    ]
    assert len(arrived) > 2 * HISTORY
    np.testing.assert_allclose(arrived[-1], [[299.0, 296.0, 294.5]])


def test_a_lost_command_leaves_the_one_before_it():
    line = DelayLine(np.zeros((2, 1)), 0.001)
    line.send(0, np.array([[5.0], [5.0]]), np.array([SENT, SENT]))
    kept = line.send(1, np.array([[7.0], [7.0]]), np.array([[True], [False]]))
    assert kept.tolist() == [[5.0], [7.0]]


def test_targets_are_interpolated_and_held_at_both_ends():
    host = HostTargets(np.array([[[0.0], [1.0], [3.0]]]), hold=5)
    assert [host.at(tick).item() for tick in (-7, 0, 2, 5, 9, 14)] == pytest.approx(
        [0.0, 0.0, 0.4, 1.0, 2.6, 3.0]
    )


def plant(**fields):
    zero = dict.fromkeys(("spring", "hysteresis", "push", "hardening", "drag"), np.zeros(2))
    nothing = {
        **zero,
        **dict.fromkeys(("spring_rest", "rest"), np.zeros(2)),
        "coupling": np.zeros((2, 2)),
        "push_frequency": 1.0,
        **dict.fromkeys(("cogging", "cogging_order", "cogging_phase", "ripple"), np.zeros(2)),
    }
    return SimpleNamespace(**(nothing | fields))


def test_a_spring_pulls_back_and_drag_resists():
    forces = UnlistedForces([plant(spring=np.array([2.0, 0.0]), drag=np.array([0.0, 3.0]))], 1e-3)
    assert forces.act
    found = forces.beside(1.0, 0.0, np.array([[0.5, 0.5]]), np.array([[1.0, -2.0]]))
    np.testing.assert_allclose(found, [[1.0 - 2.0 * 0.5, 1.0 + 3.0 * 4.0]])


def test_hysteresis_keeps_its_torque_when_the_joint_stops():
    forces = UnlistedForces([plant(hysteresis=np.array([1.0, 0.0]))], 1e-3)
    for _ in range(2000):
        moving = forces.beside(0.0, 0.0, np.zeros((1, 2)), np.array([[1.0, 0.0]]))
    resting = forces.beside(0.0, 0.0, np.zeros((1, 2)), np.zeros((1, 2)))
    assert moving[0, 0] == pytest.approx(-1.0, rel=1e-2)
    assert resting[0, 0] == pytest.approx(moving[0, 0])


def test_nothing_acts_where_all_is_zero():
    assert not UnlistedForces([plant()], 1e-3).act
    assert not Ripple([plant()]).act
    assert stacked([plant(), plant()], "coupling").shape == (2, 2, 2)


def test_cogging_repeats_each_period_and_ripple_goes_with_the_torque():
    toothed = plant(cogging=np.full(2, 0.1), cogging_order=np.full(2, 8.0), ripple=np.full(2, 0.03))
    ripple, angle = Ripple([toothed]), np.array([[0.3, 1.1]])
    np.testing.assert_allclose(ripple.cogging(angle + 2 * np.pi / 8), ripple.cogging(angle))
    once = ripple.of_torque(angle, np.ones((1, 2)))
    np.testing.assert_allclose(ripple.of_torque(angle, np.full((1, 2), 2.0)), 2 * once)
