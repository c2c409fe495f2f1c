"""Swaps of the toe: each changes one thing, and that as an independent computation says."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.simulation.drives.actuation import actuation_model
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.toe_swap import SHARE, SWAPS, Swap

LEG = slice(0, 7)


def altered(design, name):
    (alteration,) = Swap(name)(design)
    machine = machine_of(design)
    return machine, alteration.machine(machine)


def test_a_locked_toe_is_driven_as_in_the_arm_with_a_locked_toe(hyperleg):
    _, machine = altered(hyperleg, "lock_toe")
    expected = actuation_model(load_design("toe_locked")).motor_from_joint
    np.testing.assert_allclose(machine.motor_from_joint[LEG, :6], expected, atol=1e-12)
    np.testing.assert_array_equal(machine.motor_from_joint[:, [6, 13]], 0.0)


def test_the_toes_motor_alone_moves_nothing_but_the_toe(hyperleg):
    before, machine = altered(hyperleg, "toe_motor_alone")
    torque = np.zeros(14)
    torque[6] = 1.0
    moved = machine.joint_from_motor @ torque
    assert set(np.flatnonzero(moved)) == {6}
    assert moved[6] == before.joint_from_motor[6, 6]
    np.testing.assert_allclose(
        machine.joint_from_motor @ machine.motor_from_joint, np.eye(14), atol=1e-9
    )
    others = [i for i in range(14) if i not in (6, 13)]
    np.testing.assert_array_equal(
        machine.joint_from_motor[:, others], before.joint_from_motor[:, others]
    )


def test_the_ankles_take_over_the_toes_motor():
    design = load_design("toe_removed_matched")
    before, machine = altered(design, "toe_motor_to_ankle")
    full = machine_of(load_design("toe"))
    for field in ("peak_torque", "stall_torque", "rated_torque", "rotor_inertia"):
        assert getattr(machine, field)[:6].sum() == pytest.approx(getattr(full, field)[:7].sum())
    ankle = machine.motor("left_ankle_left")
    torque = 1.2
    side_by_side = SHARE * before.power_constant[ankle] * (torque / SHARE) ** 2
    assert machine.power_constant[ankle] * torque**2 == pytest.approx(side_by_side)
    knee = np.abs(machine.joint_from_motor[3, :6]) @ machine.peak_torque[:6]
    assert knee == pytest.approx(
        np.abs(transmission.joint_from_motor(load_design("toe"))[3]) @ full.peak_torque[:7]
    )


def test_a_locked_toe_stays_where_it_is(hyperleg):
    task = load_task("walk_free")
    rng = np.random.default_rng(0)
    moved = {}
    for name in (None, "lock_toe"):
        environment = Environment(
            hyperleg,
            task,
            simulations=2,
            seed=1,
            threads=1,
            alterations=Swap(name) if name else None,
        )
        environment.reset()
        toes = environment.layout.joint_indices("toe")
        start = environment.chunks[0].motion.joint_position[:, toes].copy()
        for _ in range(15):
            environment.step(rng.normal(size=(2, 14)))
        motion = environment.chunks[0].motion
        moved[name] = np.abs(motion.joint_position[:, toes] - start).max()
        environment.close()
    assert moved["lock_toe"] < 1e-3 < 0.02 < moved[None]


@pytest.mark.parametrize(
    ("swap", "layout"),
    [
        ("lock_toe", "toe_locked"),
        ("toe_motor_alone", "toe_removed"),
        ("toe_motor_to_ankle", "toe"),
        ("toe_motor_to_ankle", "toe_locked"),
    ],
)
def test_a_swap_of_the_wrong_robot_is_refused(swap, layout):
    with pytest.raises(InputError, match="expects a policy of"):
        Swap(swap)(load_design(layout))
    with pytest.raises(InputError, match=r"mini_cheetah.*is no HyperLeg"):
        Swap(swap)(load_robot("mini_cheetah"))


def test_swaps_have_names_and_pickle():
    with pytest.raises(InputError, match="lock_toe"):
        Swap("no_toe")
    for name in SWAPS:
        assert pickle.loads(pickle.dumps(Swap(name))) == Swap(name)
