"""One training in memory: its environment, learner, schedule, checkpoints and exports."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from tensordict import TensorDict

from hyperleg_design.errors import InputError, in_short
from hyperleg_design.learning.design_sampler import DesignSampler
from hyperleg_design.learning.learner.algorithm import IterationPPO, as_tensors, make_algorithm
from hyperleg_design.learning.policies.export import export_policy
from hyperleg_design.learning.policies.policy_metadata import policy_metadata
from hyperleg_design.learning.policies.start_policy import StartPolicy
from hyperleg_design.learning.policies.warm_start import (
    check_posture,
    fits_critic,
    start_actor,
    start_critic,
)
from hyperleg_design.learning.preset import Preset
from hyperleg_design.learning.records.checkpoint import load_checkpoint, save_checkpoint
from hyperleg_design.learning.records.meter import Meter
from hyperleg_design.learning.records.progress import (
    finite,
    log_measures,
    open_writer,
    progress_line,
)
from hyperleg_design.learning.records.status import CHECKPOINT, CRITIC, POLICY, STATUS
from hyperleg_design.learning.records.trial import trial
from hyperleg_design.learning.resolved import task_mapping
from hyperleg_design.learning.schedule import Schedule
from hyperleg_design.learning.stop_requests import stop_requests
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.simulation.alteration import Alterations
from hyperleg_design.simulation.design_spread import DesignSpread
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.policy_file import CRITIC_FORMAT
from hyperleg_design.simulation.stepping.snapshot import put_snapshot, take_snapshot
from hyperleg_design.simulation.tasks import Task
from hyperleg_design.writing import write_json

SHOW_EVERY = 5.0
"""Seconds between two lines of progress."""
TRIED = 32
"""Robots in a trial; of many designs the pool's first."""
TRIAL_SEED = 20_000
"""Seed of the starting states of trials, different from the seed of any training."""


class Training:
    """One training: its environment, learner, schedule and files."""

    def __init__(
        self,
        task: Task,
        design: RobotDesign,
        seed: int,
        preset: Preset,
        folder: Path,
        threads: int,
        description: dict[str, Any],
        start: StartPolicy | None = None,
        alterations: Alterations | None = None,
        spread: DesignSpread | None = None,
    ) -> None:
        self.task, self.design, self.preset = task, design, preset
        self.folder, self.description = folder, description
        self.schedule, self.alterations = Schedule(preset, task.name), alterations
        self.sampler = (
            DesignSampler(design, spread, int(preset.simulations), seed) if spread else None
        )
        """What designs the simulations have; None for one design."""
        self.threads = threads
        self.environment = self._new_environment()
        torch.manual_seed(seed)
        self.observations = self._begin(seed)
        self.algorithm = make_algorithm(preset, self.environment, self.observations)
        self.algorithm.train_mode()
        self.meter = Meter(self.environment)
        self.latest_trial: dict[str, float] = {}
        self.seconds = 0.0
        """Spent on training so far, trials left out [s]."""
        self.processor_seconds = 0.0
        """Processor time of the same [s]: the clock that other work on the machine leaves alone."""
        columns = self.environment.observation_columns["critic"]
        self._takes_critic = bool(start and fits_critic(self.algorithm.critic, start, columns))
        fresh = start is not None and not (self._takes_critic and start.own_critic)
        self._critic_only = int(preset.warm_start.critic_iterations) if fresh else 0
        if (folder / CHECKPOINT).exists():
            self._load()
        elif start is not None:
            self._start_from(start)

    def run(self, iterations: int | None, show: Callable[[str], None]) -> bool:
        """Train to the end, until a signal comes, or for some iterations.

        Args:
            iterations: at most; to the end by default.
            show: is called with each line of progress.

        Returns:
            Whether the training is done.
        """
        first, schedule, preset = self.schedule.iteration, self.schedule, self.preset
        last = schedule.total if iterations is None else min(schedule.total, first + iterations)
        if (self.folder / POLICY).exists():
            return True
        writer = open_writer(self.folder, first, self.preset.steps_per_iteration)
        shown, began = 0.0, time.monotonic()
        measures: dict[str, Any] = {}
        with stop_requests() as stop:
            while schedule.iteration < last and not stop.is_set():
                started, worked = time.monotonic(), time.process_time()
                measures = self._iterate()
                self.seconds += time.monotonic() - started
                self.processor_seconds += time.process_time() - worked
                measures["minutes"] = self.seconds / 60.0
                measures["processor_minutes"] = self.processor_seconds / 60.0
                if (
                    schedule.iteration % int(preset.trial_every) == 0
                    or preset.trial_every < schedule.iteration == schedule.total
                ):
                    self._try()
                    measures["trial"] = self.latest_trial
                log_measures(self.folder, writer, measures)
                if self.schedule.is_late:
                    self._export(f"late_{schedule.iteration:06d}.onnx")
                if schedule.iteration % int(preset.checkpoint_every) == 0:
                    self.save()
                if time.monotonic() - shown > SHOW_EVERY or schedule.iteration == last:
                    shown = time.monotonic()
                    left = (
                        (shown - began)
                        / (schedule.iteration - first)
                        * (schedule.total - schedule.iteration)
                    )
                    write_json(
                        self.folder / STATUS,
                        finite({**measures, "left": left, "pid": os.getpid(), "done": False}),
                    )
                    show(
                        progress_line(
                            self.task.name,
                            f"{self.design.variant or self.design.name}"
                            f" seed {self.description['seed']}",
                            measures,
                            self.latest_trial,
                            left,
                        )
                    )
        done = schedule.iteration >= schedule.total
        self.save()
        if done:
            self._export_critic()
            self._export(POLICY)
            write_json(
                self.folder / STATUS, finite({**measures, "left": 0.0, "pid": None, "done": True})
            )
        writer.close()
        self.environment.close()
        return done

    def _new_environment(self) -> Environment:
        """An environment with the present designs."""
        sampler = self.sampler
        environment = Environment(
            sampler.design if sampler else self.design,
            self.task,
            simulations=int(self.preset.simulations),
            seed=sampler.environment_seed if sampler else self.description["seed"],
            threads=self.threads,
            alterations=self.alterations,
        )
        self.schedule.apply(environment)
        return environment

    def _begin(self, seed: int) -> TensorDict:
        """Start all simulations, in the midst of their episodes so that not all end together."""
        observations = as_tensors(self.environment.reset())
        self.environment.episode_step = np.random.default_rng(seed).integers(
            round(self.task.limits.duration / self.task.physics.policy_step),
            size=self.environment.simulations,
        )
        return observations

    def _redraw_designs(self) -> None:
        """Give the simulations other designs where it is time, by how often the policy falls with
        each.
        """
        sampler = self.sampler
        if sampler is None or self.schedule.iteration % sampler.spread.redraw_every:
            return
        sampler.redraw()
        self._replace_environment()
        self.observations = self._begin(sampler.environment_seed)

    def _replace_environment(self) -> None:
        """Make the environment anew, with the present designs."""
        count, divergences = self.environment.divergence_count, self.environment.divergences
        self.environment.close()
        self.environment = self._new_environment()
        self.environment.divergence_count, self.environment.divergences = count, divergences
        self.meter.environment = self.environment

    def policy(self, observation: np.ndarray) -> np.ndarray:
        """Compute the actions of the deterministic policy so far.

        Args:
            observation: `(n, size)`.

        Returns:
            Actions, `(n, J)`.
        """
        actor = self.algorithm.get_policy()
        with torch.inference_mode():
            return actor.mlp(actor.obs_normalizer(torch.from_numpy(observation))).numpy()

    def save(self) -> None:
        """Write a checkpoint with all that the rest of the training depends on."""
        save_checkpoint(
            self.folder / CHECKPOINT,
            {
                "networks": self.algorithm.save(),
                "environment": take_snapshot(self.environment),
                "observations": {
                    name: values.numpy() for name, values in self.observations.items()
                },
                "schedule": self.schedule.state(),
                "sampler": self.sampler and self.sampler.state(),
                "meter": self.meter.state(),
                "trial": self.latest_trial,
                "seconds": self.seconds,
                "processor_seconds": self.processor_seconds,
                "random": torch.get_rng_state().numpy(),
            },
        )

    def _iterate(self) -> dict[str, Any]:
        """Roll out, learn, and go on in the schedule."""
        algorithm, environment, began = self.algorithm, self.environment, time.monotonic()
        self.schedule.apply(environment)
        if np.isfinite(self.schedule.most_deviation):
            with torch.no_grad():
                deviations = algorithm.get_policy().distribution.log_std_param
                deviations.clamp_(max=float(np.log(self.schedule.most_deviation)))
        algorithm.desired_kl = self.schedule.kl_target
        stage, gain = self.schedule.place[0], self.schedule.gain
        with torch.inference_mode():
            for _ in range(int(self.preset.rollout)):
                action = algorithm.act(self.observations)
                step = environment.step(action.numpy())
                self.meter.note(step)
                if self.sampler is not None:
                    self.sampler.note(step.terminated)
                reward = torch.from_numpy(step.reward.astype(np.float32))
                self._bootstrap(step, reward)
                self.observations = as_tensors(step.observations)
                algorithm.process_env_step(
                    self.observations, reward, torch.from_numpy(step.ending != 0), {}
                )
            algorithm.designs = None if self.sampler is None else self.sampler.assigned
            algorithm.compute_returns(self.observations)
        losses = self._update()
        measures = self.meter.read()
        self.schedule.advance(measures["episode"], measures["share"])
        diverged = environment.divergence_count
        self._redraw_designs()
        steps = self.preset.steps_per_iteration
        return {
            "iteration": self.schedule.iteration,
            "steps": self.schedule.iteration * steps,
            "total": self.schedule.total * steps,
            "stage": stage + 1,
            "assist": gain,
            **measures,
            "rate": steps / (time.monotonic() - began),
            "learning_rate": algorithm.learning_rate,
            "divergence": algorithm.divergence
            if isinstance(algorithm, IterationPPO)
            else float("nan"),
            "deviation": float(
                algorithm.get_policy().distribution.log_std_param.detach().exp().mean()
            ),
            "losses": losses,
            "diverged": diverged,
        }

    def _update(self) -> dict[str, float]:
        """One iteration's learning; of the critic alone where a warm start asks for it."""
        algorithm = self.algorithm
        if self.schedule.iteration >= self._critic_only:
            return algorithm.update()
        rate = algorithm.learning_rate
        algorithm.actor.requires_grad_(False)
        losses = algorithm.update()
        algorithm.actor.requires_grad_(True)
        if isinstance(algorithm, IterationPPO):
            algorithm.set_rate(rate)  # adapted on a divergence of zero
        return losses

    def _start_from(self, start: StartPolicy) -> None:
        warm, columns = self.preset.warm_start, self.environment.observation_columns
        check_posture(start, self.task.posture_deg)
        start = start.toward(self.task.name)
        same = start.commands == task_mapping(self.task)["commands"]["kind"]
        command = None if same else np.array([float(warm.forward), 0.0, 0.0])
        start_actor(
            self.algorithm.actor,
            start,
            columns["policy"],
            list(self.environment.layout.joints),
            command,
            self.observations["policy"].numpy(),
            float(warm.deviation),
        )
        if self._takes_critic:
            start_critic(
                self.algorithm.critic,
                self.algorithm.actor,
                start,
                columns["critic"],
                self.observations["critic"].numpy(),
            )

    def _bootstrap(self, step: Any, reward: torch.Tensor) -> None:
        """An episode that was cut, not lost, goes on in value: add what the critic expects of its
        last state.
        """
        cut = step.truncated[step.ended]
        if cut.any():
            final = as_tensors(
                {name: values[cut] for name, values in step.final_observations.items()}
            )
            reward[torch.from_numpy(step.ended[cut])] += (
                self.preset.algorithm.discount * self.algorithm.critic(final).squeeze(-1)
            )

    def _try(self) -> None:
        commands = self.environment.chunks[0].commander.settings
        pool = None if self.sampler is None else self.sampler.pool
        self.latest_trial = trial(
            self.design if pool is None else pool.rows(np.arange(TRIED) % pool.batch_shape[0]),
            self.task.changed(commands=commands),
            self.policy,
            simulations=TRIED,
            seed=TRIAL_SEED,
            alterations=self.alterations,
        )

    def _export(self, name: str) -> None:
        environment = self.environment
        metadata = policy_metadata(
            self.description,
            steps=self.schedule.iteration * self.preset.steps_per_iteration,
            columns=environment.observation_columns["policy"],
            joints=environment.layout.joints,
            designs=self.task.designs,
        )
        export_policy(self.folder / name, self.algorithm.get_policy(), metadata)

    def _export_critic(self) -> None:
        deviations = self.algorithm.get_policy().distribution.log_std_param.detach().exp()
        metadata = {
            "columns": self.environment.observation_columns["critic"],
            "action_deviation": deviations.tolist(),
        }
        export_policy(self.folder / CRITIC, self.algorithm.critic, metadata, CRITIC_FORMAT)

    def _load(self) -> None:
        content = load_checkpoint(self.folder / CHECKPOINT)
        try:
            self.algorithm.load(content["networks"], None, True)
        except (RuntimeError, KeyError, ValueError) as error:
            reason = in_short(error)
            raise InputError(
                f"{self.folder.name}/{CHECKPOINT}",
                "networks",
                None,
                f"do not fit this task, design and preset ({reason})",
            ) from None
        self.schedule.put(content["schedule"])
        if self.sampler is not None:
            self.sampler.put(content["sampler"])
            self._replace_environment()
        self.schedule.apply(self.environment)
        put_snapshot(self.environment, content["environment"])
        self.observations = as_tensors(content["observations"])
        self.meter.put(content["meter"])
        self.latest_trial, self.seconds = content["trial"], content["seconds"]
        self.processor_seconds = content["processor_seconds"]
        torch.set_rng_state(torch.from_numpy(content["random"]))
