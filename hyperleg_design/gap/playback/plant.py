"""A nominal robot in MuJoCo that is driven tick by tick as a log says."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.model.supply import followed
from hyperleg_design.simulation.alteration import Alteration, damps_motors
from hyperleg_design.simulation.drives import actuation
from hyperleg_design.simulation.drives.chain import Chain, Driven

FASTEST = 1e5
"""Velocity from which a simulation has diverged [rad/s, m/s]."""


def motor_tendons(subject: Subject) -> int:
    """Count the tendons of a subject's model that are rotors of its motors; these come first.

    Args:
        subject: the robot.

    Returns:
        The count.
    """
    model = subject.model
    return sum(model.tendon(index).name in subject.motors for index in range(model.ntendon))


def replay_model(
    subject: Subject,
    chain: Chain,
    alterations: Sequence[Alteration],
    step: float,
    unlimited: np.ndarray | None = None,
) -> Any:
    """Build the MuJoCo model of a subject with the rotors, transmission and edits of alterations.

    Args:
        subject: the robot.
        chain: of the drives.
        alterations: what is added.
        step: of the simulation [s].
        unlimited: joints that have no stops, `(n,)`; none by default.

    Returns:
        The model.
    """
    import mujoco

    model = copy.copy(subject.model)
    model.opt.timestep = step
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    if not subject.floating:
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    if unlimited is not None:
        model.jnt_limited[model.njnt - len(subject.joints) + np.flatnonzero(unlimited)] = 0
    for alteration in alterations:
        alteration.edit(model)
    machine, matrix = chain.machine, np.asarray(chain.machine.joint_from_motor)
    first = model.nv - len(subject.joints)
    pulled = motor_tendons(subject)
    if pulled:
        model.tendon_armature[:pulled] = machine.rigid_inertia
        adr, place = model.tendon_adr, model.wrap_objid - (model.njnt - len(subject.joints))
        for tendon in range(pulled):
            wraps = slice(adr[tendon], adr[tendon] + model.tendon_num[tendon])
            model.wrap_prm[wraps] = matrix[place[wraps], tendon]
    else:
        nominal = np.diag(
            (subject.joint_from_motor * subject.rotor_inertia) @ subject.joint_from_motor.T
        )
        model.dof_armature[first:] += np.diag((matrix * machine.rigid_inertia) @ matrix.T) - nominal
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


class Plant:
    """Simulations of one subject side by side, stepped with its drives; the seam between MuJoCo and
    `Chain`.
    """

    def __init__(
        self,
        subject: Subject,
        alterations: Sequence[Alteration],
        count: int,
        step: float,
        unlimited: np.ndarray | None = None,
    ) -> None:
        from mujoco.batch import Batch

        self.subject = subject
        self.chain = Chain(machine_of(subject), (*followed(subject), *alterations), count, step)
        self.model = replay_model(subject, self.chain, alterations, step, unlimited)
        self.batch = Batch(self.model, count, 1)
        self.qpos, self.qvel, self._applied = (
            self.batch.bind(name) for name in ("qpos", "qvel", "qfrc_applied")
        )
        joints = len(subject.joints)
        self._first = self.model.nv - joints
        self.joints = slice(self.model.nq - joints, None)
        self._softness = step * self.model.dof_invweight0[self._first :]
        self._damping = self.batch.expand("dof_damping")
        self._own_damping = self._damping.copy()
        by_tendons = motor_tendons(subject) and damps_motors(alterations)
        self._tendon_damping = self.batch.expand("tendon_damping") if by_tendons else None
        self.alive = np.arange(count)

    def start(
        self,
        position: np.ndarray,
        velocity: np.ndarray,
        base: np.ndarray | None,
        base_velocity: np.ndarray | None,
    ) -> None:
        """Set the states of all windows.

        Args:
            position: of the joints, as their sensors measure it [rad], `(w, n)`.
            velocity: of the joints, as their sensors measure it [rad/s], `(w, n)`.
            base: pose of a floating base, `(w, 7)`; None for a fixed one.
            base_velocity: linear in the world, angular in the base's frame, `(w, 6)`; None for a
                fixed one.
        """
        measured, measured_velocity = self.chain.measured(position, velocity)
        self.qpos[:, self.joints] = 2 * position - measured
        self.qvel[:, self._first :] = 2 * velocity - measured_velocity
        if base is not None and base_velocity is not None:
            self.qpos[:, :7], self.qvel[:, :6] = base, base_velocity
        self.chain.reset(
            np.arange(len(position)),
            self.qpos[:, self.joints].copy(),
            self.qvel[:, self._first :].copy(),
        )

    def measured(self) -> tuple[np.ndarray, np.ndarray]:
        """Compute the joint states as the sensors measure them.

        Returns:
            Positions [rad] and velocities [rad/s], `(w, n)` each.
        """
        return self.chain.measured(self.qpos[:, self.joints], self.qvel[:, self._first :])

    def step(
        self,
        follow: str,
        value: np.ndarray,
        temperature: np.ndarray | None,
        battery: np.ndarray | None,
    ) -> Driven:
        """Simulate one step along a target, command or torque.

        Args:
            follow: one of `INPUTS`.
            value: of the input, `(w, ...)`.
            temperature: of the motors [degC], where the log has it.
            battery: its voltage [V], where the log has it.

        Returns:
            Torques and resistances of the drives.
        """
        from mujoco.batch import SimulationError

        subject = self.subject
        position, velocity = self.qpos[:, self.joints].copy(), self.qvel[:, self._first :].copy()
        driven = self.chain.drive(
            position, velocity, temperature=temperature, battery=battery, **{follow: value}
        )
        matrix = self.chain.machine.joint_from_motor
        torque = actuation.applied(matrix, driven.transmitted)
        damping = actuation.friction_damping(
            subject.coulomb, subject.viscous, velocity, subject.friction_speed
        )
        if driven.joint_torque is not None:
            torque = torque + driven.joint_torque
        if driven.joint_damping is not None:
            damping = damping + driven.joint_damping
        if driven.motor_damping is not None:
            if self._tendon_damping is not None:
                self._tendon_damping[:, : driven.motor_damping.shape[-1]] = driven.motor_damping
            else:
                damping = damping + actuation.applied(np.asarray(matrix) ** 2, driven.motor_damping)
        implicit = np.maximum(0.5, self._implicit(damping))
        torque, damping = torque - (1 - implicit) * damping * velocity, implicit * damping
        if follow == "target":
            torque, damping = self._with_controller(torque, damping, velocity, driven)
        self._applied[:, self._first :] = torque
        self._damping[:, self._first :] = self._own_damping[:, self._first :] + damping
        if len(self.alive):
            try:
                self.batch.step(self.alive)
                lost = self.alive[~(np.abs(self.qvel[self.alive]) < FASTEST).all(1)]
            except SimulationError as error:
                lost = np.asarray(error.ids)
            if len(lost):
                self.qpos[lost], self.qvel[lost] = np.nan, np.nan
                self.alive = np.setdiff1d(self.alive, lost)
        return driven

    def _implicit(self, damping: np.ndarray) -> np.ndarray:
        """Part of a damping that must act on the velocity after the step for the step to be stable:
        1 - 1 / x, x = D h / I.
        """
        return np.asarray(1 - 1 / np.maximum(damping * self._softness, 1e-9))

    def _with_controller(
        self, torque: np.ndarray, damping: np.ndarray, velocity: np.ndarray, driven: Driven
    ) -> tuple[np.ndarray, np.ndarray]:
        """Gains too stiff for a joint's inertia made implicit as far as they must be; those of
        other joints stay as they are.

        A servo's model without its rotor has such joints. Where a motor is at its limit the
        controller has no say.
        """
        machine = self.chain.machine
        gain = np.asarray(machine.damping + self.chain.step * machine.stiffness)
        implicit = np.broadcast_to(np.maximum(0.0, self._implicit(gain)), velocity.shape)
        if not implicit.any() or driven.command is None:
            return torque, damping
        limited = np.abs(driven.believed - driven.command) > 1e-9
        reached = (
            actuation.applied(np.abs(np.asarray(machine.joint_from_motor)), limited.astype(float))
            > 0
        )
        implicit = np.where(reached, 0.0, implicit)
        return torque + implicit * machine.damping * velocity, damping + implicit * gain
