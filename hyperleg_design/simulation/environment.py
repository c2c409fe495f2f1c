"""The environment: many simulations of a robot under a task, stepped together at the policy's rate.

    environment = Environment(load_design(), load_task("walk"), simulations=256, seed=0)
    observations = environment.reset()
    step = environment.step(policy(observations["policy"]))

Simulations are worked on in chunks, each with its own random stream and its own
`mujoco.batch.Batch`; while one chunk is in Python, for its actuators, rewards and observations,
others are in MuJoCo. The same seed gives the same bytes with any number of threads.
"""

from __future__ import annotations

import dataclasses
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.simulation.alteration import Alterations, alterations_of
from hyperleg_design.simulation.commands import changed_commands
from hyperleg_design.simulation.layout import stacked
from hyperleg_design.simulation.stepping.action import checked_action
from hyperleg_design.simulation.stepping.chunk import Chunk
from hyperleg_design.simulation.stepping.partition import partition
from hyperleg_design.simulation.stepping.robots import robots_of
from hyperleg_design.simulation.stepping.standing import check_all_standing
from hyperleg_design.simulation.stepping.step import Divergence, Step, joined, merged
from hyperleg_design.simulation.tasks import Reward, Task, check_reward
from hyperleg_design.simulation.terms import mirror, observations
from hyperleg_design.simulation.terms.assist import Assist
from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.layout import Layout

DIVERGENCES_KEPT = 100
"""Most divergences that an environment remembers; all are counted."""


class Environment:
    """Simulations of one robot, or of a batch of designs, under a task.

    Args:
        design: a robot; or a batch of designs with the same joints, motors and pads, each of which
            has an equal number of simulations that follow each other.
        task: what to do.
        simulations: how many in all.
        seed: of all randomness.
        threads: that step them; all processors by default.
        assist: helping forces, for training only.
        alterations: of the simulated robot, or what makes them for a design; without, nothing
            changes.
        common_random_numbers: each design has random numbers as if its simulations were the only
            ones, so its trajectories do not depend on the others in the batch, to the last digit,
            and all designs meet the same starting states. Without, every simulation has its own.
    """

    def __init__(
        self,
        design: RobotDesign,
        task: Task,
        *,
        simulations: int,
        seed: int = 0,
        threads: int | None = None,
        assist: Assist | None = None,
        alterations: Alterations | None = None,
        common_random_numbers: bool = False,
    ) -> None:
        if simulations < 1:
            raise InputError("environment", "simulations", simulations, "expects at least 1")
        if threads is not None and threads < 1:
            raise InputError("environment", "threads", threads, "expects at least 1")
        number = (design.batch_shape or (1,))[0]
        if simulations % number:
            raise InputError(
                "environment",
                "simulations",
                simulations,
                f"must be a multiple of the number of designs, {number}",
            )
        design = task.posed(design)
        self.design, self.task, self.simulations, self.seed = design, task, simulations, seed
        self.designs: list[RobotDesign] = (
            [design.take(i) for i in range(number)] if design.batch_shape else [design]
        )
        """The robots, one each."""
        self.alterations = alterations_of(alterations, self.designs[0])
        """Of each of the simulated robots."""
        robots = robots_of(self.designs, task, self.alterations, seed)
        self.models: list[mujoco.MjModel] = [model for model, _ in robots]
        """MuJoCo model of each design; shared, not to be written into."""
        self.layouts: list[Layout] = [layout for _, layout in robots]
        """Names, order and numbers of joints, motors and pads of each design."""
        self.design_index: np.ndarray = np.arange(simulations) // (simulations // number)
        """Design of each simulation, `(n,)`."""
        task.check_robot(self.layouts[0], self.designs[0].name)
        check_all_standing(self.designs, self.models, self.layouts, task.limits)
        self.layout: Layout = (
            stacked(self.layouts).take(self.design_index) if number > 1 else self.layouts[0]
        )
        """The same of each simulation, with the batch in front; of a single design without."""
        threads = threads or os.cpu_count() or 1
        parts = partition(
            simulations,
            seed,
            threads,
            designs=number if common_random_numbers else None,
        )
        workers = min(threads, len(parts))
        # Twice as many threads in MuJoCo as workers: while one chunk is in Python, another's
        # physics has the whole machine.
        each_threads = min(threads, -(-2 * threads // workers))
        self._turn = threading.Lock()
        self.chunks = []
        for part in parts:
            rows = self.design_index[part.first : part.end]
            each = design.batch_shape or common_random_numbers
            self.chunks.append(
                Chunk(
                    design.rows(rows) if each else design,
                    task,
                    self.layout.take(slice(part.first, part.end)),
                    [self.models[i] for i in rows] if number > 1 else self.models,
                    part.first,
                    part.end - part.first,
                    part.streams(),
                    self._turn,
                    each_threads,
                    self.alterations,
                )
            )
        self._pool = ThreadPoolExecutor(workers) if workers > 1 else None
        self.divergences: list[Divergence] = []
        """Simulations that diverged, the latest `DIVERGENCES_KEPT`."""
        self.divergence_count = 0
        """How many have diverged."""
        self._assist: Assist | None = None
        self.assist = assist

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo model that is simulated; the first one's of a batch of designs."""
        return self.models[0]

    @property
    def action_size(self) -> int:
        """Numbers in an action: one a joint."""
        return len(self.layout.joints)

    @property
    def observation_sizes(self) -> dict[str, int]:
        """Numbers in each group of observations."""
        return {
            group: observations.size(parts, self.layout)
            for group, parts in self.task.observations.items()
        }

    @property
    def observation_columns(self) -> dict[str, list[str]]:
        """A name for each number of each group."""
        return {
            group: observations.column_names(parts, self.layout)
            for group, parts in self.task.observations.items()
        }

    @property
    def reward_names(self) -> list[str]:
        """Names of the reward terms, in the order of the columns of `Step.reward_terms`."""
        return list(self.chunks[0].rewards)

    @property
    def assist(self) -> Assist | None:
        """Helping forces; None, the default, for evaluation."""
        return self._assist

    @assist.setter
    def assist(self, assist: Assist | None) -> None:
        self._assist = assist
        for chunk in self.chunks:
            chunk.assist = assist

    @property
    def episode_step(self) -> np.ndarray:
        """Policy steps since each episode began, `(n,)`."""
        return np.concatenate([c.episode_step for c in self.chunks])

    @episode_step.setter
    def episode_step(self, steps: np.ndarray) -> None:
        for chunk in self.chunks:
            chunk.episode_step[:] = np.asarray(steps)[chunk.first : chunk.first + chunk.count]

    def mirror_maps(self) -> dict[str, mirror.MirrorMap]:
        """Describe the left-right mirror of observations and actions.

        Returns:
            Indices and signs by observation group, and under `action`.
        """
        maps = {
            group: mirror.mirror_observation(parts, self.layout)
            for group, parts in self.task.observations.items()
        }
        return {**maps, "action": mirror.mirror_joints(self.layout)}

    def set_reward(self, name: str, weight: float | None = None, **parameters: float) -> None:
        """Change the weight or parameters of a reward term that the task has.

        Args:
            name: of the term.
            weight: the new weight; unchanged by default.
            parameters: new values by name.

        Raises:
            InputError: no such term in the task, or no such parameter.
        """
        old = self.chunks[0].rewards.get(name)
        if old is None:
            raise InputError(
                self.task.name,
                f"rewards.{name}",
                weight,
                f"is not in the task; it has {', '.join(self.reward_names)}",
            )
        new = Reward(
            old.weight if weight is None else float(weight), {**old.parameters, **parameters}
        )
        check_reward(self.task.name, name, new, isinstance(self.task.commands, WaypointCommands))
        for chunk in self.chunks:
            chunk.rewards[name] = new

    def set_clock(self, shown: float) -> None:
        """Change the gain of the gait clock in the observation.

        Args:
            shown: the gain, 0 .. 1 [-].

        Raises:
            InputError: not within 0 .. 1.
        """
        clock = dataclasses.replace(self.chunks[0].robot.clock, shown=shown)
        for chunk in self.chunks:
            chunk.robot = dataclasses.replace(chunk.robot, clock=clock)

    def set_commands(self, **values: Any) -> None:
        """Change settings of the commands, for those drawn from now on.

        Args:
            values: new settings by name.

        Raises:
            InputError: no such setting, or a value that makes no sense.
        """
        changed = changed_commands(self.chunks[0].commander.settings, values, self.task.name)
        for chunk in self.chunks:
            chunk.commander.settings = changed

    def reset(self) -> dict[str, np.ndarray]:
        """Start all simulations.

        Returns:
            Observations by group, `(n, size)` each.
        """
        return joined(self._each(Chunk.reset, [()] * len(self.chunks)))

    def step(self, action: np.ndarray) -> Step:
        """Advance all simulations by one policy step; those whose episode ends start a new one.

        Args:
            action: `(n, J)`; joint targets are the default posture plus `control.scale` times its
                moving average.

        Returns:
            Observations, rewards, and how episodes ended.

        Raises:
            InputError: wrong shape, or values that are not finite.
        """
        action = checked_action(action, (self.simulations, self.action_size))
        parts = self._each(
            Chunk.step, [(action[c.first : c.first + c.count],) for c in self.chunks]
        )
        step = parts[0] if len(parts) == 1 else merged(parts)
        if step.divergences:
            self.divergence_count += len(step.divergences)
            self.divergences = (self.divergences + step.divergences)[-DIVERGENCES_KEPT:]
        return step

    @property
    def recording(self) -> bool:
        """Whether states within a policy step are kept for `signals`."""
        return self.chunks[0].recording

    @recording.setter
    def recording(self, on: bool) -> None:
        for chunk in self.chunks:
            chunk.recording = on

    @property
    def rewarded(self) -> bool:
        """Whether steps give rewards and the observations of all groups, as they do by default.

        Otherwise they give the observations of the policy alone, rewards are zero, and the motors'
        thermal averages stay as they are.
        """
        return self.chunks[0].rewarded

    @rewarded.setter
    def rewarded(self, on: bool) -> None:
        for chunk in self.chunks:
            chunk.rewarded = on

    def freeze(self, simulations: np.ndarray) -> None:
        """Leave some simulations as they are until the next reset, which saves their physics.

        Nothing that steps give of them means anything from then on. The others go on to the last
        digit as they would have, unless they draw random numbers, which they share with those that
        would have started anew.

        Args:
            simulations: their indices.
        """
        for chunk in self.chunks:
            own = simulations - chunk.first
            chunk.freeze(own[(own >= 0) & (own < chunk.count)])

    def draws_later(self, duration: float) -> bool:
        """Decide whether running simulations draw random numbers after their start.

        Args:
            duration: time from the start that counts [s].

        Returns:
            True with alterations, or where the task draws, see `Task.draws_later`.
        """
        return self.task.draws_later(duration) or bool(self.alterations)

    def signals(self) -> dict[str, np.ndarray]:
        """What happened within the last policy step, at the start of each substep; needs
        `recording`.

        Returns:
            `(n, substeps, ...)` each: `base_position`, `base_velocity` (world), `base_orientation`
            (w x y z), `base_angular_velocity` (pelvis frame), `joint_target`, `joint_position`,
            `joint_velocity`, `driven_joint_torque` (M times the motor torque, before friction),
            `joint_friction`, `stop_torque` (of the stops on the joints), `motor_torque`,
            `motor_velocity`, `pad_force` (of the floor on each pad, world), `pad_slip`; with
            alterations also those of `told.Told`. Zero for a simulation that diverged; for others
            that ended, of the episode that did.

        Raises:
            InputError: the environment was made without `recording`.
        """
        if not self.recording:
            raise InputError(
                "environment",
                "recording",
                False,
                "must be set before the step whose signals are read",
            )
        return joined([c.signals() for c in self.chunks])

    def close(self) -> None:
        """Stop the threads of the simulation."""
        if self._pool is not None:
            self._pool.shutdown()

    def _each(self, method: Any, arguments: list[tuple[Any, ...]]) -> list[Any]:
        def work(chunk: Chunk, given: tuple[Any, ...]) -> Any:
            with self._turn:
                return method(chunk, *given)

        if self._pool is None:
            return [work(chunk, a) for chunk, a in zip(self.chunks, arguments, strict=True)]
        waiting = [
            self._pool.submit(work, chunk, a)
            for chunk, a in zip(self.chunks, arguments, strict=True)
        ]
        return [w.result() for w in waiting]
