"""Reading of training presets: `sim/preset_*.yaml`, or a user's file."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.learning.final_reward import check_final_share
from hyperleg_design.learning.preset import (
    BEGINS,
    Algorithm,
    Network,
    Preset,
    Ramp,
    Stage,
    WarmStart,
)
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import (
    check_keys,
    checked_mapping,
    checked_number,
    checked_whole_number,
)
from hyperleg_design.simulation.terms.rewards import TERMS

OWN = ("name", "description", "tasks", "final_share")
"""What a preset does not take from its base."""
FINITE = (-1e12, 1e12)
"""Range of numbers that are taken for meant."""


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
    return preset_from_mapping(_with_base(read_yaml(path), given_path(path)), given_path(path))


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
    try:
        path = resources.find_sim("preset", base)
    except InputError as error:
        raise InputError(where, "base", base, error.remedy) from None
    below = _with_base(read_yaml(path), given_path(path), (*before, base))
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
    given = {str(t): s for t, s in checked_mapping(tasks, where, "tasks").items()}
    for task, entry in given.items():
        if isinstance(entry, str) and not isinstance(given.get(entry), list):
            raise InputError(
                where, f"tasks.{task}", entry, "expects stages, or a task that has them"
            )
    stages = {
        t: _stages(given[s] if isinstance(s, str) else s, where, f"tasks.{t}")
        for t, s in given.items()
    }
    network = dict(checked_mapping(rest.pop("network", {}), where, "network"))
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
    least = checked_number(rest.pop("final_share", 0.0), where, "final_share", 0, 1)
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
    values = {key: float(checked_whole_number(rest[key], where, key, *FINITE)) for key in rest}
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
    data = checked_mapping(data, where, path)
    optional = ("assist", "assist_gone_by", "rewards", "commands", "ramps")
    check_keys(data, where, path, ("name", "steps"), optional)
    rewards: dict[str, Mapping[str, float]] = {}
    for term, entry in checked_mapping(data.get("rewards", {}), where, f"{path}.rewards").items():
        values = entry if isinstance(entry, Mapping) else {"weight": entry}
        _check_term(str(term), [str(k) for k in values], where, f"{path}.rewards.{term}")
        rewards[str(term)] = {
            str(k): checked_number(v, where, f"{path}.rewards.{term}.{k}", *FINITE)
            for k, v in values.items()
        }
    commands = {
        str(k): checked_number(v, where, f"{path}.commands.{k}", *FINITE)
        for k, v in checked_mapping(data.get("commands", {}), where, f"{path}.commands").items()
    }
    ramps = data.get("ramps", [])
    if not isinstance(ramps, list):
        raise InputError(where, f"{path}.ramps", ramps, "expects a list of ramps")
    return Stage(
        name=str(data["name"]),
        steps=checked_number(data["steps"], where, f"{path}.steps", 1, FINITE[1]),
        assist=None
        if data.get("assist") is None
        else checked_number(data["assist"], where, f"{path}.assist", 0, 1),
        assist_gone_by=checked_number(
            data.get("assist_gone_by", 1.0), where, f"{path}.assist_gone_by", 0, 1
        ),
        rewards=rewards,
        commands=commands,
        ramps=tuple(_ramp(entry, where, f"{path}.ramps.{i}") for i, entry in enumerate(ramps)),
    )


def _ramp(data: Any, where: str, path: str) -> Ramp:
    data = checked_mapping(data, where, path)
    check_keys(data, where, path, ("set", "from", "to", "steps"), ("begins",))
    kind, _, rest = str(data["set"]).partition(".")
    name, _, parameter = rest.partition(".")
    if kind == "rewards" and name:
        parameter = parameter or "weight"
        _check_term(name, [parameter], where, f"{path}.set")
    elif str(data["set"]) not in ("policy.deviation", "algorithm.kl_target", "clock.shown") and (
        kind != "commands" or not name or parameter
    ):
        raise InputError(
            where,
            f"{path}.set",
            data["set"],
            "expects rewards.TERM, rewards.TERM.PARAMETER, commands.SETTING, clock.shown, "
            "policy.deviation or algorithm.kl_target",
        )
    begins = data.get("begins", "stage")
    if begins not in BEGINS:
        raise InputError(where, f"{path}.begins", begins, f"expects one of {', '.join(BEGINS)}")
    least = {"policy": 1e-3, "algorithm": 1e-5}.get(kind, FINITE[0])
    low, high = (
        checked_number(data[key], where, f"{path}.{key}", least, FINITE[1])
        for key in ("from", "to")
    )
    return Ramp(
        (kind, name, parameter),
        low,
        high,
        checked_number(data["steps"], where, f"{path}.steps", 1, FINITE[1]),
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
