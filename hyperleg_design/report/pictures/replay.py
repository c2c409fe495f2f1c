"""Replays of a policy: one trial with all its signals, and its animation."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hyperleg_design.evaluation.evaluate import evaluate, protocol_for
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Protocol, load_protocol

if TYPE_CHECKING:
    from hyperleg_design.evaluation.policy import Policy
    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.tasks import Task


def replay(
    policy: Policy | str | Path,
    protocol: Protocol | str | Path | None = None,
    *,
    seed: int | None = None,
    design: RobotDesign | None = None,
    task: Task | None = None,
) -> Evaluation:
    """Run one trial of a policy and keep all its signals.

    Args:
        policy: as in `evaluate`.
        protocol: as in `evaluate`; only its first trial is run.
        seed: of the starting state; the protocol's by default.
        design: as in `evaluate`.
        task: as in `evaluate`.

    Returns:
        The evaluation with its one trial.

    Raises:
        InputError: as `evaluate`.
    """
    chosen = load_policy(policy) if isinstance(policy, str | Path) else policy
    run = (
        protocol_for(chosen, task)
        if protocol is None
        else load_protocol(protocol)
        if isinstance(protocol, str | Path)
        else protocol
    )
    single = run.changed(trials=1) if seed is None else run.changed(trials=1, seed=seed)
    return evaluate(chosen, single, design=design, task=task, threads=1)
