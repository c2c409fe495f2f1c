"""Alterations and their parts: what does nothing changes nothing, masses are felt."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from hyperleg_design.simulation.alteration import (
    Alteration,
    Live,
    alterations_of,
    damps_motors,
    edited,
    overrides,
    resistance,
)
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.drives.told import TOLD
from hyperleg_design.simulation.drives.two_mass import Belt
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.settings import Physics
from hyperleg_design.simulation.stepping.snapshot import put_snapshot, take_snapshot
from hyperleg_design.simulation.tasks import load_task


class _Through(Live):
    def command(self, command, tick):
        return command


@dataclass(frozen=True, eq=False)
class Through(Alteration):
    """Has a hook, changes nothing."""

    live = _Through


@dataclass(frozen=True, eq=False)
class Heavier(Alteration):
    """Mass of the pelvis."""

    mass: Any

    def edit(self, model, simulation=0):
        model.body_mass[model.body("pelvis").id] += np.broadcast_to(self.mass, (simulation + 1,))[
            simulation
        ]


class _Lagging(Live):
    hidden_state = ("held",)

    def prepare(self):
        self.held = np.zeros((self.count, len(self.machine.motors)))

    def command(self, command, tick):
        self.held += 0.3 * (command - self.held)
        return self.held.copy()


@dataclass(frozen=True, eq=False)
class Lagging(Alteration):
    """With a hidden state."""

    live = _Lagging


class _Wrong(Live):
    def measured(self, position, velocity):
        position[:, 3] += self.alteration.offset
        return position, velocity

    def imu(self, angular_velocity, gravity):
        return angular_velocity + 0.25, gravity


@dataclass(frozen=True, eq=False)
class Wrong(Alteration):
    """Wrong sensors."""

    live = _Wrong
    offset: float = 0.1


def walked(design, alterations, steps=40, **changes):
    environment = Environment(
        design,
        load_task("walk").changed(**changes),
        simulations=6,
        seed=3,
        threads=1,
        alterations=alterations,
    )
    environment.recording = True
    environment.reset()
    rng = np.random.default_rng(5)
    seen = []
    for _ in range(steps):
        step = environment.step(0.4 * rng.normal(size=(6, environment.action_size)))
        truth = [
            values for name, values in environment.signals().items() if not name.startswith(TOLD)
        ]
        seen.append((step.observations["policy"], step.reward_terms, *truth))
    environment.close()
    return seen


@pytest.mark.parametrize(
    "physics",
    [Physics(), Physics(posture_dependent=True), Physics(friction="explicit")],
    ids=["plain", "linkage", "explicit"],
)
def test_a_hook_that_changes_nothing_changes_nothing(design, physics):
    plain, altered = (
        walked(design, (), physics=physics),
        walked(design, (Through(),), physics=physics),
    )
    for one, other in zip(plain, altered, strict=True):
        for a, b in zip(one, other, strict=True):
            # Rounding alone, which contact enlarges: on one processor two of 864 accelerations
            # differ by 2e-11, on others less.
            np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-10)


def test_no_alterations_means_no_chain(design):
    environment = Environment(
        design, load_task("walk"), simulations=2, threads=1, alterations=lambda given: ()
    )
    assert all(
        chunk.drive.chain is None and chunk.record.altered is None for chunk in environment.chunks
    )
    assert environment.model.opt.integrator == simulation_model(design).opt.integrator


def test_alterations_may_depend_on_the_design(design):
    seen = []

    def of(given):
        seen.append(given)
        return (Heavier(1.0),)

    environment = Environment(design, load_task("walk"), simulations=2, threads=1, alterations=of)
    assert seen == [design]
    assert environment.model.body_mass.sum() == pytest.approx(
        simulation_model(design).body_mass.sum() + 1.0
    )
    assert environment.layout.weight == pytest.approx(layout_of(design).weight + 9.81)
    assert alterations_of(None, design) == ()


def test_edits_leave_the_given_model_alone_and_its_constants_follow(design):
    model = simulation_model(design)
    before = model.body_mass.copy()
    assert edited(model, (Through(),)) is model
    changed = edited(model, (Heavier(np.array([1.0, 2.0])),), 1)
    np.testing.assert_array_equal(model.body_mass, before)
    assert changed.body_mass.sum() == pytest.approx(before.sum() + 2.0)
    assert changed.body_subtreemass[1] == pytest.approx(model.body_subtreemass[1] + 2.0)
    assert Heavier(1.0).edits
    assert not Through().edits


def test_a_heavier_robot_presses_more_on_the_floor(design):
    forces = []
    for alterations in ((), (Heavier(3.0),)):
        environment = Environment(
            design, load_task("walk"), simulations=1, threads=1, alterations=alterations
        )
        environment.recording = True
        environment.reset()
        acting = np.zeros((1, environment.action_size))
        forces.append(
            np.mean(
                [
                    environment.step(acting)
                    and environment.signals()["pad_force"][..., 2].sum(-1).mean()
                    for _ in range(10)
                ]
            )
        )
    # while it still stands, before it tips over
    assert forces[1] - forces[0] == pytest.approx(3.0 * 9.81, rel=0.15)


def test_wrong_sensors_reach_controller_and_policy_but_not_the_critic(design):
    task = load_task("walk")
    told, true = (
        Environment(design, task, simulations=3, seed=1, threads=1, alterations=a)
        for a in ((Wrong(0.1),), ())
    )
    first, other = told.reset(), true.reset()
    columns = told.observation_columns
    for group in ("policy", "critic"):
        difference = (first[group] - other[group])[0]
        for name, value in zip(columns[group], difference, strict=True):
            expected = (
                0.1
                if name == "joint_position.left_knee"
                else 0.25
                if name.startswith("angular_velocity")
                else 0.0
            )
            assert value == pytest.approx(expected, abs=1e-6), name
    told.recording = true.recording = True
    acting = np.zeros((3, told.action_size))
    told.step(acting), true.step(acting)
    wanted = (
        told.signals()["driven_joint_torque"][:, 0, 3]
        - true.signals()["driven_joint_torque"][:, 0, 3]
    )
    # the knee's controller asks for stiffness times the offset less
    np.testing.assert_allclose(wanted, -design.joints.knee.stiffness * 0.1, rtol=0.02)


@pytest.mark.parametrize(
    "alteration", [Lagging(), Belt("left_hip_pitch", compliance=2.0, play=0.1)], ids=["lag", "belt"]
)
def test_an_altered_environment_put_back_goes_on_bit_for_bit(design, alteration):
    def environment():
        return Environment(
            design, load_task("walk"), simulations=5, seed=4, threads=1, alterations=(alteration,)
        )

    actions = 0.5 * np.random.default_rng(0).normal(size=(80, 5, 14))
    first = environment()
    first.reset()
    for action in actions[:30]:
        first.step(action)
    snapshot = take_snapshot(first)
    expected = [first.step(action).observations["policy"] for action in actions[30:]]
    again = environment()
    put_snapshot(again, snapshot)
    for action, observation in zip(actions[30:], expected, strict=True):
        np.testing.assert_array_equal(again.step(action).observations["policy"], observation)
    plain = Environment(design, load_task("walk"), simulations=5, seed=4, threads=1)
    plain.reset()
    assert (
        np.abs(
            plain.step(actions[0]).observations["policy"]
            - environment_step(environment(), actions[0])
        ).max()
        > 1e-4
    )


def environment_step(environment, action):
    environment.reset()
    return environment.step(action).observations["policy"]


def test_constants_change_for_all_or_one_by_one(design):
    machine = machine_of(design)
    place = machine.joint("right_knee")
    one = machine.changed("stiffness", place, lambda old: 1.5 * old)
    assert one.stiffness[place] == 1.5 * machine.stiffness[place]
    assert np.delete(one.stiffness, place).tolist() == np.delete(machine.stiffness, place).tolist()
    many = machine.changed("stiffness", place, lambda old: old * np.array([1.0, 2.0, 3.0]))
    assert many.stiffness.shape == (3, 14)
    np.testing.assert_allclose(
        many.stiffness[:, place], machine.stiffness[place] * np.array([1, 2, 3])
    )
    assert machine.motors[machine.motor("left_toe")] == "left_toe"
    loose = dataclasses.replace(machine, free=np.arange(14) == 2)
    assert loose.rigid_inertia[2] == 0
    assert np.array_equal(np.delete(loose.rigid_inertia, 2), np.delete(machine.rotor_inertia, 2))


def test_resistance_is_friction_over_velocity():
    velocity = np.array([-3.0, -1e-3, 0.0, 1e-3, 0.2, 5.0])
    found = resistance(np.full(6, 2.0), velocity, 0.01)
    np.testing.assert_allclose(found * velocity, 2.0 * np.tanh(velocity / 0.01), atol=1e-12)
    assert found[2] == pytest.approx(2.0 / 0.01)


def test_resistance_at_motors_is_announced():
    assert damps_motors((Belt("m"),))
    assert not damps_motors((Through(), Heavier(1.0)))
    assert not overrides(None, "command")
    assert overrides(_Through, "command")
    assert not overrides(_Through, "target")
