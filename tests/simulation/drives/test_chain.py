"""The order in which hooks act, against the plain formulas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from hyperleg_design.simulation.alteration import Alteration, Live
from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.drives.limits import Limits
from hyperleg_design.simulation.drives.machine import machine_of


@pytest.fixture
def state():
    rng = np.random.default_rng(2)
    return (
        0.3 * rng.normal(size=(5, 14)),
        2.0 * rng.normal(size=(5, 14)),
        0.3 * rng.normal(size=(5, 14)),
    )


def test_without_alterations_it_is_controller_inverse_and_clip(design, state):
    position, velocity, target = state
    machine = machine_of(design)
    driven = Chain(machine, (), 5, 0.005).drive(position, velocity, target=target)
    wanted = (machine.stiffness * (target - position) - machine.damping * velocity) @ np.linalg.inv(
        machine.joint_from_motor
    ).T
    speed = velocity @ machine.joint_from_motor
    limits = Limits(machine.no_load_speed, machine.stall_torque, machine.peak_torque)
    np.testing.assert_allclose(driven.command, wanted, rtol=1e-9)
    np.testing.assert_allclose(driven.motor_velocity, speed, rtol=1e-9)
    for found in (driven.torque, driven.believed, driven.transmitted):
        np.testing.assert_allclose(found, limits.clip(wanted, speed), rtol=1e-9)
    assert driven.motor_damping is None
    assert driven.joint_damping is None
    assert driven.joint_torque is None
    # power is the same on both sides of the transmission
    power = np.einsum("nj,nj->n", driven.torque @ machine.joint_from_motor.T, velocity)
    np.testing.assert_allclose(
        power, np.einsum("nk,nk->n", driven.torque, driven.motor_velocity), rtol=1e-9
    )


class _Everything(Live):
    hidden_state = ("count_of_steps",)

    def prepare(self):
        self.count_of_steps = np.zeros(self.count)
        self.order = []

    def begin(self, tick):
        self.order.append("begin")
        self.count_of_steps += 1
        self.last = tick.last_torque.copy()

    def measured(self, position, velocity):
        return position + 0.01, 0.5 * velocity

    def target(self, target, tick):
        self.order.append("target")
        return target + 0.03

    def command(self, command, tick):
        self.order.append("command")
        return 2.0 * command

    def limits(self, limits, tick):
        self.order.append("limits")
        return Limits(limits.no_load_speed, limits.stall_torque, np.full(self.count and 14, 3.0))

    def motor_torque(self, torque, tick):
        self.order.append("motor_torque")
        return 0.9 * torque

    def motor_damping(self, tick):
        self.order.append("motor_damping")
        self.torque = tick.torque.copy()
        return np.full((self.count, 14), 0.1)

    def joint_damping(self, tick):
        self.order.append("joint_damping")
        return np.full((self.count, 14), 0.2)

    def joint_torque(self, tick):
        self.order.append("joint_torque")
        return -tick.joint_torque

    def transmitted(self, torque, damping, tick):
        self.order.append("transmitted")
        return torque + 1.0, 2 * damping


@dataclass(frozen=True, eq=False)
class Everything(Alteration):
    """Every hook."""

    live = _Everything


def test_hooks_act_in_order_and_each_on_what_the_one_before_made(design, state):
    position, velocity, target = state
    machine = machine_of(design)
    chain = Chain(machine, (Everything(),), 5, 0.005)
    driven = chain.drive(position, velocity, target=target)
    (live,) = chain.lives
    assert live.order == [
        "begin",
        "target",
        "command",
        "limits",
        "motor_torque",
        "motor_damping",
        "transmitted",
        "joint_damping",
        "joint_torque",
    ]
    wanted = (
        machine.stiffness * (target + 0.02 - position) - machine.damping * 0.5 * velocity
    ) @ np.linalg.inv(machine.joint_from_motor).T
    np.testing.assert_allclose(driven.command, wanted, rtol=1e-9)
    limits = Limits(machine.no_load_speed, machine.stall_torque, np.full(14, 3.0))
    np.testing.assert_allclose(
        driven.believed, limits.clip(2 * wanted, driven.motor_velocity), rtol=1e-9
    )
    np.testing.assert_allclose(driven.torque, 0.9 * driven.believed)
    np.testing.assert_allclose(live.torque, driven.torque)
    np.testing.assert_allclose(driven.transmitted, driven.torque + 1.0)
    np.testing.assert_allclose(driven.motor_damping, 0.2)
    np.testing.assert_allclose(driven.joint_damping, 0.2)
    np.testing.assert_allclose(driven.joint_torque, -driven.torque @ machine.joint_from_motor.T)
    assert not live.last.any()
    chain.drive(position, velocity, target=target)
    np.testing.assert_array_equal(live.last, driven.torque)


def test_replayed_commands_and_torques_enter_where_they_belong(design, state):
    position, velocity, _ = state
    given = np.linspace(-2, 2, 70).reshape(5, 14)
    chain = Chain(machine_of(design), (Everything(),), 5, 0.005)
    commanded = chain.drive(position, velocity, command=given)
    np.testing.assert_array_equal(commanded.command, given)
    assert "target" not in chain.lives[0].order
    chain.lives[0].order.clear()
    driven = chain.drive(position, velocity, torque=given)
    assert chain.lives[0].order[:2] == ["begin", "motor_torque"]
    assert driven.command is None
    np.testing.assert_array_equal(driven.believed, given)
    np.testing.assert_allclose(driven.torque, 0.9 * given)


def test_hidden_state_goes_out_and_in(design, state):
    position, velocity, target = state
    chain = Chain(machine_of(design), (Everything(),), 5, 0.005)
    chain.drive(position, velocity, target=target)
    kept = chain.state()
    chain.drive(position, velocity, target=target)
    chain.reset(np.array([1, 3]), position[:2], velocity[:2])
    assert chain.lives[0].count_of_steps.tolist() == [2, 0, 2, 0, 2]
    assert not chain.last_torque[[1, 3]].any()
    chain.put_state(kept)
    assert chain.lives[0].count_of_steps.tolist() == [1] * 5
    np.testing.assert_array_equal(chain.last_torque, kept["last_torque"])


def test_measured_writes_into_nobodys_arrays(design, state):
    position, velocity, _ = state
    before = position.copy()
    told, _ = Chain(machine_of(design), (Everything(),), 5, 0.005).measured(position, velocity)
    np.testing.assert_array_equal(position, before)
    np.testing.assert_allclose(told, before + 0.01)
