"""Evaluation of one policy, or of many side by side, under any protocol."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.policy import Policy, load_policy
from hyperleg_design.evaluation.protocol import (
    Protocol,
    TTestProtocol,
    WalkProtocol,
    load_protocol,
    protocol_from_mapping,
    protocol_mapping,
)
from hyperleg_design.evaluation.t_test import evaluate_t_test, evaluate_t_tests
from hyperleg_design.evaluation.walk import evaluate_walk, evaluate_walks
from hyperleg_design.simulation.commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.robot.described import RobotDesign
    from hyperleg_design.simulation.alteration import Alterations
    from hyperleg_design.simulation.tasks import Task


def evaluate(
    policy: Policy | str | Path,
    protocol: Protocol | str | Path | None = None,
    *,
    design: RobotDesign | None = None,
    task: Task | None = None,
    threads: int | None = None,
    alterations: Alterations | None = None,
) -> Evaluation:
    """Run a protocol on a policy: deterministic, without assist.

    Args:
        policy: a callable from observations `(n, k)` to actions `(n, J)`, a shipped policy's name,
            or an ONNX file.
        protocol: a protocol, a shipped name, or a file; by default `t_test` for tasks with
            waypoints, else `walk`.
        design: the robot; an ONNX policy's own by default.
        task: which gives observations, physics and control; an ONNX policy's own by default.
        threads: of the simulation; the result does not depend on it.
        alterations: of the simulated robot, or what makes them for a design, such as
            `Overlay.alterations`.

    Raises:
        InputError: a file that cannot be used, a policy that does not fit robot, task or protocol,
        or one whose output is not
            finite.
    """
    chosen = load_policy(policy) if isinstance(policy, str | Path) else policy
    if protocol is None:
        protocol = protocol_for(chosen, task)
    run = load_protocol(protocol) if isinstance(protocol, str | Path) else protocol
    if isinstance(run, TTestProtocol):
        return evaluate_t_test(
            chosen, run, design=design, task=task, threads=threads, alterations=alterations
        )
    if isinstance(run, WalkProtocol):
        return evaluate_walk(
            chosen, run, design=design, task=task, threads=threads, alterations=alterations
        )
    raise InputError("evaluate", "protocol", run.name, "expects a WalkProtocol or a TTestProtocol")


def evaluate_designs(
    policy: Policy | str | Path,
    designs: RobotDesign,
    protocol: Protocol | str | Path | None = None,
    *,
    task: Task | None = None,
    threads: int | None = None,
) -> list[Evaluation]:
    """`evaluate` of every design of a batch, side by side; the same numbers to the last digit.

    Args:
        policy: as in `evaluate`.
        designs: robots with the same joints, motors and pads.
        protocol: as in `evaluate`.
        task: as in `evaluate`.
        threads: as in `evaluate`.

    Returns:
        One a design.

    Raises:
        InputError: as `evaluate`; where designs of the batch cannot stand, its `bad` says which.
    """
    chosen = load_policy(policy) if isinstance(policy, str | Path) else policy
    run = protocol_for(chosen, task) if protocol is None else protocol
    run = load_protocol(run) if isinstance(run, str | Path) else run
    if isinstance(run, TTestProtocol):
        return evaluate_t_tests(chosen, run, design=designs, task=task, threads=threads)
    if isinstance(run, WalkProtocol):
        return evaluate_walks(chosen, run, design=designs, task=task, threads=threads)
    raise InputError("evaluate", "protocol", run.name, "expects a WalkProtocol or a TTestProtocol")


def protocol_for(policy: Policy, task: Task | None = None) -> Protocol:
    """The shipped protocol that suits a task, a policy's own by default: `t_test` for waypoints,
    else `walk`.
    """
    commands = getattr(task or getattr(policy, "task", None), "commands", None)
    return load_protocol("t_test" if isinstance(commands, WaypointCommands) else "walk")


def evaluate_many(
    policies: Sequence[str | Path],
    protocol: Protocol | str | Path | None = None,
    *,
    workers: int = 2,
    kept: int | Sequence[int] = 1,
    overrides: Sequence[Mapping[str, Any]] | None = None,
    designs: Sequence[RobotDesign | None] | None = None,
    alterations: Alterations | None = None,
    progress: Callable[[Evaluation], None] | None = None,
) -> list[Evaluation]:
    """Evaluate ONNX files, each in a process of one thread.

    Args:
        policies: shipped names or files.
        protocol: as in `evaluate`; where it is None, each policy has what suits its task.
        workers: processes; one works in this process.
        kept: trials of each policy whose signals are kept, one number for all or one for each.
        overrides: parameters of the robot to change, by path, for each policy; none by default.
        designs: the robot for each policy; its own by default.
        alterations: as in `evaluate`, of all policies; they must pickle.
        progress: called with each evaluation as it comes, in order.

    Returns:
        In the order of the policies; the same for any number of workers.

    Raises:
        InputError: as `evaluate`, of the first policy that fails.
    """
    if workers < 1:
        raise InputError("evaluate", "workers", workers, "expects at least 1")
    run = load_protocol(protocol) if isinstance(protocol, str | Path) else protocol
    mapping = None if run is None else protocol_mapping(run)
    for policy in dict.fromkeys(policies):
        load_policy(policy)  # a broken file is told before hours of work
    count = len(policies)
    jobs = list(
        zip(
            policies,
            [mapping] * count,
            [kept] * count if isinstance(kept, int) else kept,
            overrides or [{}] * count,
            designs or [None] * count,
            [alterations] * count,
            strict=True,
        ),
    )
    evaluations = []
    if workers == 1 or count < 2:
        for job in jobs:
            evaluations.append(_evaluated(job))
            if progress is not None:
                progress(evaluations[-1])
        return evaluations
    import multiprocessing

    with ProcessPoolExecutor(
        min(workers, count), mp_context=multiprocessing.get_context("spawn")
    ) as pool:
        try:
            for evaluation in pool.map(_evaluated, jobs):
                evaluations.append(evaluation)
                if progress is not None:
                    progress(evaluation)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return evaluations


def _evaluated(
    job: tuple[
        str | Path,
        dict[str, object] | None,
        int,
        Mapping[str, Any],
        RobotDesign | None,
        Alterations | None,
    ],
) -> Evaluation:
    name, protocol, kept, overrides, design, alterations = job
    run = None if protocol is None else protocol_from_mapping(protocol, "protocol")
    policy = load_policy(name)
    if overrides:
        design = (design or policy.design).with_values(dict(overrides), "overrides")
    return evaluate(policy, run, design=design, threads=1, alterations=alterations).light(kept)
