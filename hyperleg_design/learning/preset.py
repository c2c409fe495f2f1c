"""Training presets: size, algorithm and stages, read from `sim/preset_*.yaml` or a user's file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.learning.final_reward import check_final_share
from hyperleg_design.reading import read_yaml, short_name
from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.fields import flag, number, text
from hyperleg_design.simulation.settings import Checked
from hyperleg_design.simulation.terms.rewards import TERMS

BEGINS = ("stage", "assist_gone")
"""When a ramp begins: with its stage, or with the first iteration without assist."""


OWN = ("name", "description", "tasks", "final_share")
"""What a preset does not take from its base."""


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
    critic (`learning/modulation.py`); otherwise it is an input like others."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WarmStart(Checked):
    """How a training begins that starts from another task's policy; `learning/warm_start.py`."""

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
    empty: gain of the gait clock in the observation; or `policy`, `deviation`, empty: the largest
    standard deviation of the actions."""
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
                f"has no stages for this task; it has {', '.join(self.tasks)}",
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


def preset_names() -> list[str]:
    """List the shipped presets.

    Returns:
        Their names, sorted.
    """
    return resources.sim_names("preset")


def load_preset(name: str | Path) -> Preset:
    """Read a training preset from a shipped file or a file of the user.

    Args:
        name: a shipped name such as `laptop`, or a YAML file.

    Returns:
        The validated preset.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find_sim("preset", name)
    return preset_from_mapping(_with_base(read_yaml(path), short_name(path)), short_name(path))


def _with_base(
    data: Mapping[str, Any], where: str, before: tuple[str, ...] = ()
) -> Mapping[str, Any]:
    """Fill what a preset leaves out with what its `base` states, but for name, tasks and the share
    of the final reward.
    """
    base = data.get("base")
    if base is None:
        return data
    if not isinstance(base, str) or base in before:
        raise InputError(where, "base", base, "expects the name of a preset that has other bases")
    path = resources.find_sim("preset", base)
    below = _with_base(read_yaml(path), short_name(path), (*before, base))
    merged = {key: value for key, value in below.items() if key not in OWN}
    for key, value in data.items():
        old = merged.get(key)
        if isinstance(old, Mapping) and isinstance(value, Mapping):
            merged[key] = {**old, **value}
        else:
            merged[key] = value
    del merged["base"]
    return merged


def preset_from_mapping(data: Mapping[str, Any], where: str) -> Preset:
    """Build a preset from nested mappings, as YAML gives them.

    Args:
        data: sections by name.
        where: file, for error messages.

    Returns:
        The validated preset.

    Raises:
        InputError: unknown or missing field, or a value that makes no sense.
    """
    rest = dict(data)
    rest.pop("description", None)
    name, tasks = rest.pop("name", None), rest.pop("tasks", None)
    if not isinstance(name, str):
        raise InputError(where, "name", name, "expects a text")
    given = {str(t): s for t, s in _mapping(tasks, where, "tasks").items()}
    for task, entry in given.items():
        if isinstance(entry, str) and not isinstance(given.get(entry), list):
            raise InputError(
                where, f"tasks.{task}", entry, "expects stages, or a task that has them"
            )
    stages = {
        t: _stages(given[s] if isinstance(s, str) else s, where, f"tasks.{t}")
        for t, s in given.items()
    }
    network = dict(_mapping(rest.pop("network", {}), where, "network"))
    hidden = network.pop("hidden", [512, 256, 128])
    if (
        not isinstance(hidden, list)
        or not hidden
        or not all(
            isinstance(h, int) and not isinstance(h, bool) and 0 < h <= 65536 for h in hidden
        )
    ):
        raise InputError(where, "network.hidden", hidden, "expects a list of widths")
    settings = parameters.from_mapping(Network, network, where, "network")
    warm = parameters.from_mapping(WarmStart, rest.pop("warm_start", {}), where, "warm_start")
    algorithm = parameters.from_mapping(Algorithm, rest.pop("algorithm", {}), where, "algorithm")
    if (algorithm.mirror, algorithm.adapted) in (("half", "minibatch"), ("append", "iteration")):
        raise InputError(
            where,
            "algorithm.adapted",
            algorithm.adapted,
            f"with mirror: {algorithm.mirror} would judge mirrored samples",
        )
    sizes = ("simulations", "rollout", "checkpoint_every", "trial_every", "late", "late_apart")
    least = _number(rest.pop("final_share", 0.0), where, "final_share", 0, 1)
    for task, parts in stages.items():
        check_final_share(parts, least, where, f"tasks.{task}")
    for key in rest:
        if key not in sizes:
            known = [
                "name",
                "base",
                *sizes,
                "final_share",
                "algorithm",
                "network",
                "warm_start",
                "tasks",
            ]
            raise InputError(where, str(key), rest[key], parameters.unknown(str(key), known))
    values = {key: _whole(rest[key], where, key) for key in rest}
    try:
        shape = dataclasses.replace(settings, hidden=tuple(hidden))
        return Preset(
            name=name,
            final_share=least,
            algorithm=algorithm,
            network=shape,
            warm_start=warm,
            tasks=stages,
            **values,
        )
    except InputError as error:
        raise InputError(where, error.field, error.value, error.remedy) from None


def _stages(data: Any, where: str, path: str) -> tuple[Stage, ...]:
    if not isinstance(data, list) or not data:
        raise InputError(where, path, data, "expects a list of stages")
    return tuple(_stage(entry, where, f"{path}.{i}") for i, entry in enumerate(data))


def _stage(data: Any, where: str, path: str) -> Stage:
    known = ("name", "steps", "assist", "assist_gone_by", "rewards", "commands", "ramps")
    data = _mapping(data, where, path)
    for key in data:
        if key not in known:
            raise InputError(
                where, f"{path}.{key}", data[key], parameters.unknown(str(key), list(known))
            )
    for key in ("name", "steps"):
        if key not in data:
            raise InputError(where, f"{path}.{key}", None, "is missing")
    rewards: dict[str, Mapping[str, float]] = {}
    for term, entry in _mapping(data.get("rewards", {}), where, f"{path}.rewards").items():
        values = entry if isinstance(entry, Mapping) else {"weight": entry}
        _check_term(str(term), [str(k) for k in values], where, f"{path}.rewards.{term}")
        rewards[str(term)] = {
            str(k): _number(v, where, f"{path}.rewards.{term}.{k}") for k, v in values.items()
        }
    commands = {
        str(k): _number(v, where, f"{path}.commands.{k}")
        for k, v in _mapping(data.get("commands", {}), where, f"{path}.commands").items()
    }
    ramps = data.get("ramps", [])
    if not isinstance(ramps, list):
        raise InputError(where, f"{path}.ramps", ramps, "expects a list of ramps")
    return Stage(
        name=str(data["name"]),
        steps=_number(data["steps"], where, f"{path}.steps", 1, 1e12),
        assist=None
        if data.get("assist") is None
        else _number(data["assist"], where, f"{path}.assist", 0, 1),
        assist_gone_by=_number(
            data.get("assist_gone_by", 1.0), where, f"{path}.assist_gone_by", 0, 1
        ),
        rewards=rewards,
        commands=commands,
        ramps=tuple(_ramp(entry, where, f"{path}.ramps.{i}") for i, entry in enumerate(ramps)),
    )


def _ramp(data: Any, where: str, path: str) -> Ramp:
    data = _mapping(data, where, path)
    for key in data:
        if key not in ("set", "from", "to", "steps", "begins"):
            raise InputError(
                where,
                f"{path}.{key}",
                data[key],
                parameters.unknown(str(key), ["set", "from", "to", "steps", "begins"]),
            )
    for key in ("set", "from", "to", "steps"):
        if key not in data:
            raise InputError(where, f"{path}.{key}", None, "is missing")
    kind, _, rest = str(data["set"]).partition(".")
    name, _, parameter = rest.partition(".")
    if kind == "rewards" and name:
        parameter = parameter or "weight"
        _check_term(name, [parameter], where, f"{path}.set")
    elif str(data["set"]) not in ("policy.deviation", "clock.shown") and (
        kind != "commands" or not name or parameter
    ):
        raise InputError(
            where,
            f"{path}.set",
            data["set"],
            "expects rewards.TERM, rewards.TERM.PARAMETER, commands.SETTING, clock.shown or "
            "policy.deviation",
        )
    begins = data.get("begins", "stage")
    if begins not in BEGINS:
        raise InputError(where, f"{path}.begins", begins, f"expects one of {', '.join(BEGINS)}")
    least = 1e-3 if kind == "policy" else -1e12
    low, high = (_number(data[key], where, f"{path}.{key}", least) for key in ("from", "to"))
    return Ramp(
        (kind, name, parameter),
        low,
        high,
        _number(data["steps"], where, f"{path}.steps", 1, 1e12),
        begins,
    )


def _check_term(term: str, settings: list[str], where: str, path: str) -> None:
    if term not in TERMS:
        raise InputError(
            where, path, term, parameters.unknown(term, sorted(TERMS)).replace("field", "term")
        )
    for name in settings:
        if name != "weight" and name not in TERMS[term].parameters:
            raise InputError(
                where, path, name, parameters.unknown(name, ["weight", *TERMS[term].parameters])
            )


def _number(value: Any, where: str, path: str, low: float = -1e12, high: float = 1e12) -> float:
    return float(
        parameters.checked(value, parameter_fields.Rule("number", low=low, high=high), where, path)
    )


def _whole(value: Any, where: str, path: str) -> float:
    number = _number(value, where, path)
    if number != int(number):
        raise InputError(where, path, value, "expects a whole number")
    return number


def _mapping(data: Any, where: str, path: str) -> Mapping[str, Any]:
    if not isinstance(data, Mapping):
        raise InputError(where, path, data, "expects a mapping")
    return data
