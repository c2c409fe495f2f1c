"""Some of an environment's simulations, stepped together: physics, rewards, ends, resets and
observations.

Threads take turns in Python and run side by side in MuJoCo: left to the interpreter's own lock,
which NumPy lets go of in every longer operation, they would hand it to and fro thousands of times a
second. Everything in a chunk depends on its own simulations and its own random stream only, so a
trajectory does not depend on how many threads work on the chunks.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.simulation import model as models
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.commands import commander
from hyperleg_design.simulation.drives.actuation import smoothed_action
from hyperleg_design.simulation.drives.drive import Drive
from hyperleg_design.simulation.drives.thermal import ThermalState
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.model import PAD_SENSOR_SIZE
from hyperleg_design.simulation.state import Goal, Motion, State, read_motion
from hyperleg_design.simulation.stepping.batch_models import give_models, vary_models
from hyperleg_design.simulation.stepping.divergence import all_sound, broken
from hyperleg_design.simulation.stepping.record import Record, signals_of
from hyperleg_design.simulation.stepping.sensing import sensed
from hyperleg_design.simulation.stepping.start import Starter
from hyperleg_design.simulation.stepping.step import Divergence, Step
from hyperleg_design.simulation.stepping.streams import RowStreams
from hyperleg_design.simulation.tasks import Reward, Task
from hyperleg_design.simulation.terms import terminations
from hyperleg_design.simulation.terms.assist import Assist
from hyperleg_design.simulation.terms.observations import observe
from hyperleg_design.simulation.terms.rewards import TERMS, Robot

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign


class Chunk:
    """Simulations `first .. first + count` of an environment."""

    def __init__(
        self,
        design: RobotDesign,
        task: Task,
        layout: Layout,
        models: Sequence[mujoco.MjModel],
        first: int,
        count: int,
        rng: RowStreams,
        turn: threading.Lock,
        threads: int,
        alterations: Sequence[Alteration] = (),
    ) -> None:
        from mujoco import batch

        self._turn = turn

        self.task, self.layout, self.first, self.count, self.rng = task, layout, first, count, rng
        model = models[0]
        self.batch = batch.Batch(model, count, threads)
        # A second batch finds how high to start: what is bound in the first is copied out after
        # each of its steps.
        starters = batch.Batch(model, count, 1)
        if len(models) > 1:
            give_models(self.batch, models)
            give_models(starters, models)
        vary_models(self.batch, task, rng)
        verticals = [a.vertical for a in alterations if a.vertical is not None]
        self._vertical = verticals[0] if verticals else None
        """Direction against gravity where alterations make that another than the world's z."""
        self.drive = Drive(
            design, layout, task.physics, self.batch, task.randomisation, rng, alterations
        )
        self._rated, self._heat = (
            self.drive.flat(self.drive.model.rated_torque),
            self.drive.flat(self.drive.model.envelope.power_constant),
        )
        sensors = self.batch.bind("sensordata")
        pads = PAD_SENSOR_SIZE * len(layout.pads)
        self._sensors, self._stops = sensors[:, :pads], sensors[:, pads:]
        self._push = self.batch.bind("xfrc_applied")
        self.starter = Starter(task, layout, models, starters)
        self.batch.reset(None, 0, 0)
        self._standing = self.batch.state.copy()
        self._pelvis = model.body(layout.base).id
        joints, motors = len(layout.joints), len(layout.motors)
        substeps = int(task.physics.substeps)
        self.action, self.previous_action, self.smoothed = (
            np.zeros((count, joints)) for _ in range(3)
        )
        self.motor_torque, self.motor_velocity = np.zeros((2, substeps, count, motors))
        self.sensors = np.zeros((substeps, count, self._sensors.shape[-1]))
        self.target = np.zeros((count, joints))
        """Joint angles that the controller was asked for in the last policy step [rad]."""
        self.record = Record(self.drive, layout, substeps)
        self.recording = False
        """Whether the record of each policy step is kept."""
        self.rewarded = True
        """Whether steps give rewards and the observations of all groups, or those of the policy
        alone."""
        self._running: np.ndarray | None = None
        """Simulations whose physics is stepped, in ascending order; None for all."""
        self.thermal = ThermalState(task.thermal, (count, motors))
        self.commander = commander(task.commands, count)
        self.rewards: dict[str, Reward] = dict(task.rewards)
        self.limits = task.limits.of(layout.default_height)
        self.assist: Assist | None = None
        self.robot = Robot(layout, task.clock)
        """Of this chunk's simulations."""
        self.episode_step = np.zeros(count, int)
        self._clock_start = np.zeros(count)
        self.motion: Motion
        self.goal: Goal | None = None

    def reset(self) -> dict[str, np.ndarray]:
        """Start all simulations of the chunk.

        Returns:
            Observations by group, `(n, size)` each.
        """
        everyone, self._running = np.arange(self.count), None
        state = self._started(everyone)
        self.motion, self.goal = state.motion, state.goal
        return observe(self._groups, state, self.robot)

    @property
    def _groups(self) -> Mapping[str, Sequence[str]]:
        """Parts of the groups of observations that are computed."""
        groups = self.task.observations
        return groups if self.rewarded else {"policy": groups["policy"]}

    def freeze(self, ids: np.ndarray) -> None:
        """Leave simulations as they are until the next reset.

        Args:
            ids: their indices within the chunk.
        """
        running = np.arange(self.count) if self._running is None else self._running
        self._running = np.setdiff1d(running, ids)

    def step(self, action: np.ndarray) -> Step:
        """Advance all simulations of the chunk by one policy step.

        Args:
            action: finite numbers, `(n, J)`.

        Returns:
            Observations, rewards and endings.
        """
        task, duration = self.task, self.task.physics.policy_step
        self.previous_action, self.action = (
            self.action,
            np.clip(action, -task.control.limit, task.control.limit),
        )
        self.smoothed = smoothed_action(self.smoothed, self.action, task.control.smoothing)
        position_before, velocity_before = self.drive.qpos.copy(), self.drive.qvel.copy()
        self._pushes(duration)
        self._physics()
        self.episode_step += 1
        divergences = self._find_diverged(position_before, velocity_before)
        self.motion = read_motion(self.drive.qpos, self.drive.qvel)
        self.goal = self.commander.judge(self.motion)
        ending = terminations.ending(
            self.motion, self.goal, self.episode_step, self.limits, duration
        )
        diverged = [d.simulation - self.first for d in divergences]
        if diverged:
            ending[diverged] = terminations.DIVERGED
        terminated = terminations.fell(ending)
        state = self._state(terminated)
        reward_terms = (
            self._rewards(state) * duration
            if self.rewarded
            else np.zeros((self.count, len(self.rewards)))
        )
        if diverged:
            reward_terms[diverged] = 0.0
        ended = np.flatnonzero(ending)
        lengths = self.episode_step[ended]
        self.commander.advance(self.motion, self.goal, duration, self.rng)
        state.command = self.commander.vector(self.goal)
        observations = observe(self._groups, state, self.robot)
        final = {group: values[ended] for group, values in observations.items()}
        if len(ended):
            fresh = self._started(ended)
            self.motion.put(ended, fresh.motion)
            if self.goal is not None and fresh.goal is not None:
                self.goal.put(ended, fresh.goal)
            for group, values in observe(self._groups, fresh, self.robot.take(ended)).items():
                observations[group][ended] = values
        return Step(
            observations=observations,
            reward=np.einsum("nt->n", reward_terms),
            terminated=terminated,
            truncated=(ending != 0) & ~terminated,
            ending=ending,
            reward_terms=reward_terms,
            ended=ended + self.first,
            final_observations=final,
            episode_steps=lengths,
            divergences=divergences,
        )

    @property
    def phase(self) -> np.ndarray:
        """Phase of the gait clock, 0 to 1, `(n,)`."""
        elapsed = self.episode_step * (self.task.physics.policy_step / self.task.clock.period)
        return np.asarray((self._clock_start + elapsed) % 1.0)

    def _physics(self) -> None:
        if self._running is not None and not len(self._running):
            return
        self.target = self.layout.default + self.task.control.scale * self.smoothed
        target = self.target.reshape(self.count, len(self.layout.limbs), -1)
        assisted = self.assist is not None and self.assist.active
        for substep in range(len(self.sensors)):
            if self.recording:
                self.record.keep_state(substep)
            self.drive.apply(target, self.motor_torque[substep], self.motor_velocity[substep])
            if self.recording:
                self.record.keep_altered(substep)
            if assisted:
                self._help()
            self._advance()
            self.sensors[substep] = self._sensors
            if self.recording:
                self.record.stops[substep] = self._stops
        if assisted:
            self._push[:, self._pelvis] = 0.0

    def _advance(self) -> None:
        from mujoco.batch import SimulationError

        failed: np.ndarray | None = None
        self._turn.release()
        try:
            self.batch.step(self._running)
        except SimulationError as error:
            failed = error.ids
        finally:
            self._turn.acquire()
        if failed is not None:
            self.drive.qpos[failed] = (
                np.nan
            )  # found, reported and started anew after the policy step

    def _help(self) -> None:
        assert self.assist is not None
        motion = read_motion(self.drive.qpos, self.drive.qvel)
        self._push[:, self._pelvis] = self.assist.wrench(
            motion, self.commander.wanted(self.goal), self.commander.turns
        )

    def _pushes(self, duration: float) -> None:
        settings = self.task.randomisation
        if settings.push_speed:
            hit = self.rng.uniform(size=self.count) < duration / settings.push_interval
            change = self.rng.uniform(-settings.push_speed, settings.push_speed, (self.count, 2))
            self.drive.qvel[hit, :2] += change[hit]

    def _state(self, terminated: np.ndarray) -> State:
        """State of all simulations after physics; what only rewards see is left out without."""
        seen = slice(None) if self.rewarded else slice(-1, None)
        torque, speed = self.motor_torque[seen], self.motor_velocity[seen]
        pad_load = models.pad_loads(self.sensors[seen])
        power = thermal_excess = np.zeros(self.count)
        if self.rewarded:
            power = np.einsum("snk,snk->n", self._heat * torque + speed, torque) / len(torque)
            duration = self.task.physics.policy_step
            thermal_excess = self.thermal.advance(torque / self._rated, duration)
        return State(
            motion=self.motion,
            action=self.action,
            previous_action=self.previous_action,
            command=self.commander.vector(self.goal),
            motor_torque=torque,
            motor_velocity=speed,
            pad_load=pad_load,
            foot_load=models.foot_loads(pad_load, self.layout.pads_of_foot),
            pad_slip=models.pad_slip(self.sensors[-1]),
            power=power,
            thermal_excess=thermal_excess,
            phase=self.phase,
            terminated=terminated,
            goal=self.goal,
            sensed=sensed(self.drive.chain, self.motion, self._vertical),
        )

    def _started(self, ids: np.ndarray) -> State:
        """Start simulations and give the state of their rows; nothing has touched or moved yet."""
        motion = self._start(ids)
        goal = self.commander.reset(ids, motion, self.rng.of(ids))
        count, substeps, joints = len(ids), len(self.sensors), len(self.layout.joints)
        motors = np.zeros((substeps, count, len(self.layout.motors)))
        pads = np.zeros((substeps, count, len(self.layout.pads)))
        none = np.zeros(count)
        return State(
            motion=motion,
            action=np.zeros((count, joints)),
            previous_action=np.zeros((count, joints)),
            command=self.commander.vector(goal, ids),
            motor_torque=motors,
            motor_velocity=motors,
            pad_load=pads,
            foot_load=models.foot_loads(pads, self.layout.pads_of_foot),
            pad_slip=pads[-1],
            power=none,
            thermal_excess=none,
            phase=self.phase[ids],
            terminated=np.zeros(count, bool),
            goal=goal,
            sensed=sensed(self.drive.chain, motion, self._vertical, ids),
        )

    def _rewards(self, state: State) -> np.ndarray:
        values = np.zeros((len(self.rewards), self.count))
        for row, (name, reward) in enumerate(self.rewards.items()):
            if reward.weight:
                np.multiply(
                    TERMS[name].function(state, self.robot, **reward.parameters),
                    reward.weight,
                    out=values[row],
                )
        return values.T

    def _find_diverged(self, position: np.ndarray, velocity: np.ndarray) -> list[Divergence]:
        """Simulations gone wrong in this step; they are put back to standing so that the others can
        go on.
        """
        warnings = self.batch.warning
        if all_sound(self.drive.qpos, self.drive.qvel, warnings):
            return []
        reasons = broken(self.drive.qpos, self.drive.qvel, warnings)
        ids = np.array(list(reasons), int)
        parts = []
        for i, reason in reasons.items():
            parts.append(
                Divergence(
                    self.first + i,
                    int(self.episode_step[i]),
                    self.batch.error(i) or reason,
                    position[i],
                    velocity[i],
                    self.action[i].copy(),
                )
            )
        if len(ids):
            self._start(ids)
            for values in (self.motor_torque, self.motor_velocity, self.sensors):
                values[:, ids] = 0.0
            self.record.forget(ids)
        return parts

    def _start(self, ids: np.ndarray) -> Motion:
        """Put robots on the floor near their default posture; motion of these rows."""
        self.batch.state[ids] = self._standing[ids]
        self.batch.warning[ids] = 0
        start = self.starter.draw(ids, self.drive.qpos[ids], self.rng)
        self.drive.qpos[ids], self.drive.qvel[ids] = start.position, start.velocity
        self._clock_start[ids] = start.phase
        self.episode_step[ids] = 0
        self.thermal.reset(ids)
        self.drive.reset(ids, start.position[:, 7:], start.velocity[:, 6:])
        for values in (self.action, self.previous_action):
            values[ids] = 0.0
        self.smoothed[ids] = start.smoothed
        return read_motion(start.position, start.velocity)

    def samples(self) -> dict[str, np.ndarray]:
        """Collect what was recorded in the last policy step, for `signals_of`.

        Returns:
            By name, `(substeps, n, ...)` each, not to be written into; `joint_target` with one
            sample.
        """
        return self.record.samples() | {
            "motor_torque": self.motor_torque,
            "motor_velocity": self.motor_velocity,
            "joint_target": self.target[None],
            "pad_force": models.pad_forces(self.sensors),
            "pad_slip": models.pad_slip(self.sensors),
        }

    def signals(self) -> dict[str, np.ndarray]:
        """Collect what happened within the last policy step; see `Environment.signals`.

        Returns:
            Arrays by name, `(n, substeps, ...)` each.
        """
        signals = signals_of(self.samples(), self.layout, self.drive.model.joint_from_motor)
        signals["joint_friction"] = self.record.friction(self.motor_velocity)
        return {name: np.moveaxis(values, 0, 1) for name, values in signals.items()}
