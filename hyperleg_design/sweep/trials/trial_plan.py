"""Which policies run which protocol on the designs of a sweep, and with which seeds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.policy_choice import policies_for
from hyperleg_design.evaluation.protocol import (
    Protocol,
    load_protocol,
    protocol_mapping,
)
from hyperleg_design.evaluation.shipped import Shipped
from hyperleg_design.simulation.settings import in_use
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.trials.best_policy import FEWEST_TRIALS

SEEDS = 3
"""Trainings that are evaluated on each design."""


@dataclass(frozen=True)
class Plan:
    """What is run on the designs of a sweep."""

    protocols: tuple[Protocol, ...]
    policies: dict[tuple[str, str], list[Shipped]]
    """Policies by protocol and variant."""
    digest: str
    """SHA-256 of the protocols and of the policies' contents."""


def _settings(protocol: Protocol) -> dict[str, Any]:
    """A protocol written out, without what came later and is not used."""
    return {
        name: in_use(value) if isinstance(value, dict) else value
        for name, value in protocol_mapping(protocol).items()
    }


def plan(
    sweep: Sweep,
    protocols: Sequence[str | Path | Protocol],
    *,
    seeds: int = SEEDS,
    policies: Sequence[str | Path] = (),
) -> Plan:
    """Choose protocols and policies of an evaluated sweep.

    Args:
        sweep: the definition.
        protocols: shipped names, files, or protocols; the kind decides which policies run them.
        seeds: trainings of each variant in each folder, at most.
        policies: folders of trainings; the shipped ones by default.

    Returns:
        The plan.

    Raises:
        InputError: no such protocol, no policy for the robot or a variant of it, or too few trials
            to choose among several.
    """
    run = tuple(p if isinstance(p, Protocol) else load_protocol(p) for p in protocols)
    if len({kind_of(p) for p in run}) < len(run):
        raise InputError("evaluate", "", list(map(str, protocols)), "expects one of each kind")
    robots = (
        {variant: sweep.ablated(sweep.base, variant) for variant in sweep.variants} if run else {}
    )
    chosen = {
        (kind_of(protocol), variant): policies_for(kind_of(protocol), robot, seeds, policies)
        for protocol in run
        for variant, robot in robots.items()
    }
    for protocol in run:
        _check_trials(protocol, max(len(chosen[kind_of(protocol), v]) for v in sweep.variants))
    digest = hashlib.sha256(json.dumps([_settings(p) for p in run], sort_keys=True).encode())
    for (kind, variant), files in chosen.items():
        for file in files:
            load_policy(file.path)  # a broken file is told before hours of work
            digest.update(f"{kind} {variant} {file.name}".encode() + file.path.read_bytes())
    return Plan(run, chosen, digest.hexdigest())


def _check_trials(protocol: Protocol, policies: int) -> None:
    """Refuse several policies whose trials cannot both decide which is best and be reported."""
    if policies > 1 and int(protocol.trials) < FEWEST_TRIALS:
        raise InputError(
            protocol.name,
            "trials",
            int(protocol.trials),
            f"expects at least {FEWEST_TRIALS} where several policies run: some trials choose the "
            f"best policy of each design, the others are reported; or give --seeds 1",
        )


def kind_of(protocol: Protocol) -> str:
    """Name the kind of a protocol.

    Args:
        protocol: the protocol.

    Returns:
        `walk` or `t_test`.
    """
    return str(protocol_mapping(protocol)["kind"])
