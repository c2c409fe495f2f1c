"""Training presets: size, algorithm and stages, read from `sim/preset_*.yaml` or a user's file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters.fields import flag, number, text
from hyperleg_design.robot.parameters.values import Checked

BEGINS = ("stage", "assist_gone")
"""When a ramp begins: with its stage, or with the first iteration without assist."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Algorithm(Checked):
    """Proximal policy optimisation; defaults as measured on this biped, not the paper's."""

    epochs: Any = number("", 1, 100, default=5)
    minibatches: Any = number("", 1, 1000, default=4)
    discount: Any = number("", 0, 1, default=0.99)
    """gamma (paper, Table II)."""
    trace: Any = number("", 0, 1, default=0.95)
    """lambda of the generalised advantage (paper, Table II)."""
    clip: Any = number("", 0.01, 1, default=0.2)
    """Bound of the change of the probability ratio (paper, Table II)."""
    entropy: Any = number("", 0, 1, default=0.002)
    learning_rate: Any = number("", 1e-7, 1, default=3e-4)
    kl_target: Any = number("", 1e-5, 1, default=0.02)
    """Divergence of the policy in one update that the learning rate is adapted to [nat]."""
    adapted: Any = text("iteration", "minibatch", "never", default="iteration")
    """How often the learning rate is adapted."""
    slowest: Any = number("", 0, 1, default=5e-5)
    """Least learning rate when adapted once an iteration."""
    fastest: Any = number("", 0, 1, default=2e-3)
    """Largest learning rate when adapted once an iteration."""
    value_weight: Any = number("", 0, 100, default=1.0)
    """Weight of the value loss."""
    value_clipped: Any = flag(default=False)
    """Whether the value loss is clipped as the probability ratio is."""
    gradient_norm: Any = number("", 1e-3, 1e6, default=1.0)
    """Largest norm of the gradients of actor and critic, each."""
    mirror: Any = text("half", "append", "never", default="half")
    """Left-right symmetry: `half` mirrors each sample with probability one half, `append` adds
    every sample's mirror image."""
    mixed_precision: Any = flag(default=True)
    """Whether networks run in bfloat16 during updates."""

    @property
    def mirrored(self) -> bool:
        """Whether the learner uses mirrored samples."""
        return bool(self.mirror != "never")


@dataclass(frozen=True, eq=False, kw_only=True)
class Network(Checked):
    """Actor and critic, one multi-layer perceptron each."""

    hidden: tuple[int, ...] = (512, 256, 128)
    """Widths of the hidden layers (paper, Table II)."""
    activation: Any = text("elu", "relu", "tanh", default="elu")
    """Activation function (paper, Table II)."""
    deviation: Any = number("", 1e-3, 10, default=0.8)
    """Standard deviation of the actions at the start."""
    normalised: Any = flag(default=True)
    """Whether observations are normalised by their running mean and deviation."""
    modulated: Any = flag(default=True)
    """Whether the design, where it is observed, scales and shifts the hidden features of actor and
    critic (`learning/learner/modulation.py`); otherwise it is an input like others."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WarmStart(Checked):
    """How a training begins that starts from another task's policy; see
    `learning/policies/warm_start.py`.
    """

    forward: Any = number("m/s", -5, 5, default=1.33)
    """Velocity command that the policy follows at first, straight ahead [m/s]."""
    deviation: Any = number("", 1e-3, 10, default=0.5)
    """Standard deviation of the actions at the start."""
    critic_iterations: Any = number("", 0, 10000, default=20)
    """Iterations at the start in which only the critic learns."""


@dataclass(frozen=True)
class Ramp:
    """A value that changes linearly over some steps and then stays."""

    target: tuple[str, str, str]
    """`rewards`, term, `weight` or a parameter; `commands`, setting, empty; `clock`, `shown`,
    empty: gain of the gait clock in the observation; `policy`, `deviation`, empty: the largest
    standard deviation of the actions; or `algorithm`, `kl_target`, empty."""
    low: float
    """Value at its beginning."""
    high: float
    """Value at its end."""
    steps: float
    """Policy steps that it takes."""
    begins: str
    """One of `BEGINS`."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Stage:
    """A part of a training; settings that it does not name stay as the task and the stages before
    left them.
    """

    name: str
    steps: float
    """Policy steps of all simulations."""
    assist: float | None = None
    """Gain of the helping forces at its beginning; None leaves it as it is."""
    assist_gone_by: float = 1.0
    """Fraction of the stage after which the assist is off in any case."""
    rewards: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Weights and parameters by term."""
    commands: Mapping[str, float] = field(default_factory=dict)
    """Settings of the commands."""
    ramps: tuple[Ramp, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Preset(Checked):
    """Size, learning algorithm and stages of a training."""

    name: str
    simulations: Any = number("", 1, 1e6, default=256)
    rollout: Any = number("", 1, 10000, default=32)
    """Policy steps of each simulation between updates."""
    checkpoint_every: Any = number("", 1, 1e6, default=25)
    """Iterations between checkpoints."""
    trial_every: Any = number("", 1, 1e6, default=120)
    """Iterations between trials: deterministic, without assist."""
    late: Any = number("", 1, 100, default=3)
    """Policies kept from the end of the training."""
    late_apart: Any = number("", 1, 1e9, default=500_000)
    """Policy steps between them."""
    final_share: Any = number("", 0, 1, default=0.0)
    """Share of each task's steps, at the end, that must run under the final reward and without
    assist; a preset whose stages do not keep to it is refused."""
    algorithm: Algorithm = field(default_factory=Algorithm)
    network: Network = field(default_factory=Network)
    warm_start: WarmStart = field(default_factory=WarmStart)
    tasks: Mapping[str, tuple[Stage, ...]]
    """Stages by name of the task."""

    @property
    def steps_per_iteration(self) -> int:
        """Policy steps of all simulations in one iteration."""
        return int(self.simulations) * int(self.rollout)

    def stages(self, task: str) -> tuple[Stage, ...]:
        """List the stages of the training for one task.

        Args:
            task: name of the task.

        Returns:
            The stages in order.

        Raises:
            InputError: the preset has none for it.
        """
        if task not in self.tasks:
            raise InputError(
                self.name,
                "tasks",
                task,
                f"has no stages for this task; it has {', '.join(self.tasks)}; a task made from "
                "one of these keeps its name",
            )
        return self.tasks[task]

    def iterations(self, stage: Stage) -> int:
        """Compute the number of iterations that a stage takes.

        Args:
            stage: of the training.

        Returns:
            The number, at least one.
        """
        return max(1, round(stage.steps / self.steps_per_iteration))

    def total_iterations(self, task: str) -> int:
        """Compute the number of iterations of all stages of a task.

        Args:
            task: name of the task.

        Returns:
            The number.
        """
        return sum(self.iterations(stage) for stage in self.stages(task))
