"""Forward predictions in MuJoCo of what a log shows: short windows from conditioned states, or the
whole log, with any change.

A replay follows the logged position targets through the nominal controller (closed loop), or the
logged torques (open loop, which drifts: short windows only). MuJoCo steps as a leapfrog, its
velocity half a step behind its position; windows start, and velocities are told, with that half
step made up for. Joint friction is a damping D(v) of the velocity before the step, on the mean of
the velocities before and after it, or, the stiffer it is, the more on the one after: x = D h / I
above 2 would ring at the mean, dry friction at rest chatter, so theta = max(1/2, 1 - 1/x) of it is
implicit.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.model.rigid import pad_points
from hyperleg_design.gap.model.supply import followed
from hyperleg_design.gap.signals.conditioning import wrong_limits
from hyperleg_design.simulation import actuation
from hyperleg_design.simulation.alteration import Alteration, damps_motors
from hyperleg_design.simulation.chain import Chain, Driven

if TYPE_CHECKING:
    from hyperleg_design.gap.effects.effect import Change
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals

LONGEST_STEP = 0.00125
"""Of the simulation, where nobody gives one [s]: above it the controllers' discretisation shows
(assumed)."""
FASTEST = 1e5
"""Velocity from which a simulation has diverged [rad/s, m/s]."""
INPUTS = ("target", "command", "torque")
"""What a replay can follow."""


@dataclass(frozen=True, eq=False)
class Windows:
    """Stretches of one log, all of one length."""

    start: np.ndarray
    """First tick of each `(w,)`."""
    length: int
    """Ticks predicted after the first."""

    @property
    def ticks(self) -> np.ndarray:
        """All ticks of all windows `(w, length + 1)`."""
        return np.asarray(self.start[:, None] + np.arange(self.length + 1))


@dataclass(frozen=True, eq=False)
class Replay:
    """What k changed simulations predict for w windows of T ticks each, first tick included."""

    windows: Windows
    position: np.ndarray
    velocity: np.ndarray
    """As the joint sensors would tell `(k, w, T, n)` [rad, rad/s]; NaN after a simulation
    diverged."""
    torque: np.ndarray
    """That the drives take themselves to give `(k, w, T, m)` [Nm]; of the last tick, as of the one
    before."""
    base: np.ndarray
    """Position and quaternion, w first, of a floating base `(k, w, T, 7)`; empty of a fixed one."""

    def errors(self, signals: Signals) -> tuple[np.ndarray, np.ndarray]:
        """Compute logged minus predicted positions and velocities.

        Args:
            signals: of the log that was replayed.

        Returns:
            Errors [rad] and [rad/s], `(k, w, T, n)` each; NaN at ticks that are not fit for use.
        """
        ticks = self.windows.ticks
        fit = signals.valid[ticks][..., None]
        position = np.where(fit, signals.position[ticks] - self.position, np.nan)
        return position, np.where(fit, signals.velocity[ticks] - self.velocity, np.nan)


def short_windows(signals: Signals, duration: float = 0.25, stride: float | None = None) -> Windows:
    """Choose windows of one length that hold valid ticks only.

    Args:
        signals: conditioned log.
        duration: of each window [s].
        stride: between their starts [s]; end to end by default.

    Returns:
        The windows.

    Raises:
        InputError: the log has no valid stretch that long.
    """
    length = max(round(duration / signals.step), 1)
    every = max(round((stride or duration) / signals.step), 1)
    total = np.concatenate([[0], np.cumsum(signals.valid)])
    starts = np.arange(0, len(signals.time) - length, every)
    starts = starts[total[starts + length + 1] - total[starts] == length + 1]
    if not len(starts):
        raise InputError(
            signals.log.name, "t", duration, "is longer than any stretch of this log without gaps"
        )
    return Windows(starts, length)


def whole_log(signals: Signals) -> Windows:
    """Choose one window from the first valid tick to the last.

    Args:
        signals: conditioned log.

    Returns:
        The window.

    Raises:
        InputError: no tick is valid.
    """
    valid = np.flatnonzero(signals.valid)
    if len(valid) < 2:
        raise InputError(
            signals.log.name,
            "t",
            len(valid),
            "ticks are fit for use: the log is all gaps, or too short",
        )
    return Windows(valid[:1], int(valid[-1] - valid[0]))


def best_input(signals: Signals) -> str:
    """Choose what a replay of a log follows by itself: targets where all gains are known, else
    torques.

    Args:
        signals: conditioned log.

    Returns:
        One of `INPUTS`.
    """
    subject = signals.subject
    if signals.target is not None:
        driven = ~subject.passive & np.isfinite(signals.target).any(0)
        if (
            driven.any()
            and np.isfinite(subject.gains[driven]).all()
            and (driven | subject.passive).all()
        ):
            return "target"
    return "torque"


def replay(
    signals: Signals,
    changes: Sequence[Change | Sequence[Alteration]] = ((),),
    windows: Windows | None = None,
    *,
    follow: str = "",
    time_step: float | None = None,
    threads: int = 1,
) -> Replay:
    """Predict windows of a log, once with each change.

    Args:
        signals: conditioned log.
        changes: what to add to the nominal simulation, each a `Change` or alterations; empty, the
            nominal one.
        windows: by default `short_windows`.
        follow: one of `INPUTS`; `best_input` by default.
        time_step: of the simulation, as a rule a fraction of a tick [s].
        threads: of MuJoCo; the result does not depend on it.

    Returns:
        Predicted positions and velocities of each change and window.

    Raises:
        InputError: an input that this log does not have, or a change that this robot cannot have.
    """
    windows = windows or short_windows(signals)
    follow = follow or best_input(signals)
    inputs = _inputs(signals, follow)
    substeps = max(int(np.ceil(signals.step / (time_step or LONGEST_STEP) - 1e-9)), 1)
    runs = [
        _run(
            signals,
            _alterations(change, signals.subject),
            windows,
            follow,
            inputs,
            substeps,
            threads,
        )
        for change in changes
    ]
    return Replay(windows, *(np.stack([run[i] for run in runs]) for i in range(4)))


def _alterations(change: Change | Sequence[Alteration], subject: Subject) -> tuple[Alteration, ...]:
    if not change:
        return ()
    if isinstance(change, dict) or hasattr(change, "items"):
        from hyperleg_design.gap.playback.overlay import alterations

        return alterations(change, subject)  # type: ignore[arg-type]
    return tuple(change)


def _inputs(signals: Signals, follow: str) -> np.ndarray:
    """What to follow, with unknown ticks held at the last known value and unknown channels at
    rest.
    """
    if follow not in INPUTS:
        raise InputError("replay", "follow", follow, f"expects one of {', '.join(INPUTS)}")
    found = {"target": signals.target, "command": signals.command, "torque": signals.believed}[
        follow
    ]
    if found is None:
        raise InputError(
            signals.log.name, follow, None, f"is not in this log; it has {best_input(signals)}"
        )
    known = np.isfinite(found)
    latest = np.maximum.accumulate(np.where(known, np.arange(len(found))[:, None], 0), 0)
    held = np.take_along_axis(found, latest, 0)
    at_rest = signals.subject.default if follow == "target" else np.zeros(held.shape[1])
    return np.where(np.isfinite(held), held, at_rest)


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
        threads: int,
        unlimited: np.ndarray | None = None,
    ) -> None:
        from mujoco.batch import Batch

        self.subject = subject
        self.chain = Chain(machine_of(subject), (*followed(subject), *alterations), count, step)
        self.model = replay_model(subject, self.chain, alterations, step, unlimited)
        self.batch = Batch(self.model, count, threads)
        self.qpos, self.qvel, self._applied = (
            self.batch.bind(name) for name in ("qpos", "qvel", "qfrc_applied")
        )
        joints = len(subject.joints)
        self._first = self.model.nv - joints
        self.joints = slice(self.model.nq - joints, None)
        self._softness = step * self.model.dof_invweight0[self._first :]
        self._damping = self.batch.expand("dof_damping")
        self._own_damping = self._damping.copy()
        self._tendon_damping = (
            self.batch.expand("tendon_damping")
            if motor_tendons(subject) and damps_motors(alterations)
            else None
        )
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
        told, told_velocity = self.chain.measured(position, velocity)
        self.qpos[:, self.joints], self.qvel[:, self._first :] = (
            2 * position - told,
            2 * velocity - told_velocity,
        )
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


def _run(
    signals: Signals,
    alterations: tuple[Alteration, ...],
    windows: Windows,
    follow: str,
    inputs: np.ndarray,
    substeps: int,
    threads: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    subject, ticks = signals.subject, windows.ticks
    count, length = ticks.shape
    plant = Plant(
        subject,
        alterations,
        count,
        signals.step / substeps,
        threads,
        wrong_limits(subject, signals.position),
    )
    first, half = windows.start, signals.step / substeps / 2
    base, base_velocity = base_states(signals, first, half) if subject.floating else (None, None)
    plant.start(
        signals.position[first],
        signals.velocity[first] - half * signals.acceleration[first],
        base,
        base_velocity,
    )
    joints, motors = len(subject.joints), len(subject.motors)
    change = np.zeros((count, joints))
    position, velocity = (
        np.full((count, length, joints), np.nan),
        np.full((count, length, joints), np.nan),
    )
    torque, pose = (
        np.full((count, length, motors), np.nan),
        np.full((count, length, 7 if subject.floating else 0), np.nan),
    )
    for k in range(length):
        position[:, k], velocity[:, k] = plant.measured()
        pose[:, k] = plant.qpos[:, : pose.shape[-1]]
        if k == length - 1:
            torque[:, k] = torque[:, max(k - 1, 0)]
            break
        now, after = ticks[:, k], ticks[:, k + 1]
        battery = None if signals.voltage is None else signals.voltage[now]
        temperature = None if signals.temperature is None else signals.temperature[now]
        for sub in range(substeps):
            part = sub / substeps
            # A controller holds a target until the next; a torque is a sample of something
            # continuous.
            value = (
                inputs[now]
                if follow == "target"
                else (1 - part) * inputs[now] + part * inputs[after]
            )
            driven = plant.step(follow, value, temperature, battery)
            if sub == 0:
                torque[:, k] = driven.believed
                late = plant.measured()[1]
                velocity[:, k], change = (velocity[:, k] + late) / 2, (late - velocity[:, k]) / 2
    velocity[:, -1] += change
    return position, velocity, torque, pose


def base_states(
    signals: Signals, ticks: np.ndarray, before: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the states of a floating base at some ticks.

    The height is such that the lowest pad touches the ground where it was not measured, and an
    unknown velocity is that of a lowest pad at rest.

    Args:
        signals: conditioned log.
        ticks: their indices, `(w,)`.
        before: time by which the velocities are earlier than the ticks [s].

    Returns:
        Pose `(w, 7)`, and velocity, linear in the world and angular in the base's frame, `(w, 6)`.
    """
    import mujoco

    base, subject = signals.base, signals.subject
    assert base is not None
    rotation = base.rotation[ticks]
    place, velocity = (
        base.position[ticks].copy(),
        np.einsum("tij,tj->ti", rotation, base.linear_velocity[ticks]),
    )
    if not np.isfinite(place).all():
        points = np.einsum(
            "tij,tpj->tpi", rotation, pad_points(subject, signals.position[ticks], rotation)
        )
        low = points[..., 2].min(1) if points.shape[1] else np.zeros(len(ticks))
        place = np.where(
            np.isfinite(place),
            place,
            np.stack([np.zeros(len(ticks)), np.zeros(len(ticks)), -low], -1),
        )
    if not np.isfinite(velocity).all():
        velocity = np.where(np.isfinite(velocity), velocity, _still_foot_velocity(signals, ticks))
    quaternion = np.zeros((len(ticks), 4))
    for row, matrix in enumerate(rotation):
        mujoco.mju_mat2Quat(quaternion[row], np.ascontiguousarray(matrix).ravel())
    velocity = velocity - before * (
        np.einsum("tij,tj->ti", rotation, base.specific_force[ticks]) + subject.gravity
    )
    spin = base.angular_velocity[ticks] - before * base.angular_acceleration[ticks]
    return np.concatenate([place, quaternion], 1), np.concatenate([velocity, spin], 1)


def _still_foot_velocity(signals: Signals, ticks: np.ndarray) -> np.ndarray:
    """Velocity of the base in the world at which its lowest pad stands still `(w, 3)`."""
    base, subject = signals.base, signals.subject
    assert base is not None
    if not subject.pads:
        return np.zeros((len(ticks), 3))
    before, after = np.maximum(ticks - 1, 0), np.minimum(ticks + 1, len(signals.time) - 1)

    def points(at: np.ndarray) -> np.ndarray:
        rotation = base.rotation[at]
        return np.einsum(
            "tij,tpj->tpi", rotation, pad_points(subject, signals.position[at], rotation)
        )

    lowest = np.argmin(points(ticks)[..., 2], 1)
    change = np.take_along_axis(points(after) - points(before), lowest[:, None, None], 1)[:, 0]
    return np.asarray(-change / (signals.time[after] - signals.time[before])[:, None])
