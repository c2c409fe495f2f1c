"""Evaluation of one policy, or of many side by side, under any protocol."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import rollout
from hyperleg_design.evaluation.policy import Policy, check_joints, load_policy
from hyperleg_design.evaluation.protocol import (
    Protocol,
    TTestProtocol,
    WalkProtocol,
    load_protocol,
    protocol_from_mapping,
    protocol_mapping,
)
from hyperleg_design.evaluation.protocols.t_test import t_test_run
from hyperleg_design.evaluation.protocols.walk import walk_run
from hyperleg_design.evaluation.result import Evaluation, evaluations_of
from hyperleg_design.evaluation.rollout import ProtocolRun
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.waypoint_commands import WaypointCommands

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.alteration import Alterations
    from hyperleg_design.simulation.tasks import Task


RUNS: dict[type[Protocol], Callable[[Task, Any], ProtocolRun]] = {
    WalkProtocol: walk_run,
    TTestProtocol: t_test_run,
}
"""How a task is run and measured, by the kind of protocol."""


def evaluate(
    policy: Policy | str | Path,
    protocol: Protocol | str | Path | None = None,
    *,
    design: RobotDesign | None = None,
    task: Task | None = None,
    threads: int | None = None,
    alterations: Alterations | None = None,
) -> Evaluation:
    """Run all trials of a protocol with a policy and one robot: deterministic, without assist.

    Args:
        policy: a callable from observations `(n, k)` to actions `(n, J)`, a shipped policy's name,
            or an ONNX file.
        protocol: a protocol, a shipped name, or a file; by default `t_test` for tasks with
            waypoints, else `walk`.
        design: the robot; an ONNX policy's own by default.
        task: gives observations, physics and control; an ONNX policy's own by default.
        threads: of the simulation; the result does not depend on it.
        alterations: of the simulated robot, or what makes them for a design, such as
            `Overlay.alterations`.

    Returns:
        The outcome, the measures and the signals of every trial.

    Raises:
        InputError: a batch of designs, a file that cannot be used, a policy that does not fit the
            robot, the task or the protocol, or one whose output is not finite.
    """
    if design is not None and design.batch_shape:
        raise InputError(design.name, "", None, "holds a batch of designs; use evaluate_designs")
    return _run(policy, protocol, design, task, threads, alterations)[0]


def evaluate_designs(
    policy: Policy | str | Path,
    designs: RobotDesign,
    protocol: Protocol | str | Path | None = None,
    *,
    task: Task | None = None,
    threads: int | None = None,
) -> list[Evaluation]:
    """Run all trials of a protocol with a policy and every design of a batch, side by side.

    The numbers are those of `evaluate` of each design, to the last digit.

    Args:
        policy: as in `evaluate`.
        designs: robots with the same joints, motors and pads.
        protocol: as in `evaluate`.
        task: as in `evaluate`.
        threads: as in `evaluate`.

    Returns:
        One evaluation for each design, in the order of the batch.

    Raises:
        InputError: as `evaluate`; where designs of the batch cannot be simulated, its `bad` marks
            those that have this reason.
    """
    return _run(policy, protocol, designs, task, threads, None)


def _run(
    policy: Policy | str | Path,
    protocol: Protocol | str | Path | None,
    design: RobotDesign | None,
    task: Task | None,
    threads: int | None,
    alterations: Alterations | None,
) -> list[Evaluation]:
    chosen = load_policy(policy) if isinstance(policy, str | Path) else policy
    rules = protocol_for(chosen, task) if protocol is None else protocol
    rules = load_protocol(rules) if isinstance(rules, str | Path) else rules
    if type(rules) not in RUNS:
        expected = " or ".join(kind.__name__ for kind in RUNS)
        raise InputError("evaluate", "protocol", rules.name, f"expects a {expected}")
    robot, task = rollout.resolved(chosen, design, task)
    check_joints(chosen, robot)
    run = RUNS[type(rules)](task, rules)
    environment = Environment(
        robot,
        run.task,
        simulations=int(rules.trials) * (robot.batch_shape or (1,))[0],
        seed=int(rules.seed),
        threads=threads,
        alterations=alterations,
        common_random_numbers=True,
    )
    try:
        trials = rollout.record(
            chosen, environment, rules.time_limit, arrived=run.arrived, before_step=run.before_step
        )
    finally:
        environment.close()
    measures, motors, cycles = zip(*map(run.measure, trials), strict=True)
    return evaluations_of(
        chosen, environment.designs, rules, trials, list(measures), list(motors), cycles
    )


def protocol_for(policy: Policy, task: Task | None = None) -> Protocol:
    """Load the shipped protocol that suits a task.

    Args:
        policy: its own task counts where none is given.
        task: whose commands decide.

    Returns:
        The protocol `t_test` for a task with waypoints, else `walk`.
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
    pool: Executor | None = None,
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
        pool: of `evaluation_pool`, to use the same processes for several calls; own ones by
            default.
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
    with nullcontext(pool) if pool else evaluation_pool(min(workers, count)) as processes:
        futures = [processes.submit(_evaluated, job) for job in jobs]
        try:
            for future in futures:
                evaluations.append(future.result())
                if progress is not None:
                    progress(evaluations[-1])
        finally:
            for future in futures:
                future.cancel()
    return evaluations


def evaluation_pool(workers: int) -> ProcessPoolExecutor:
    """Prepare processes for `evaluate_many`, which start when they are first needed.

    Args:
        workers: processes at most.

    Returns:
        The pool; a context that ends them.
    """
    import multiprocessing

    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


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
    name, protocol, trials_with_signals, overrides, design, alterations = job
    run = None if protocol is None else protocol_from_mapping(protocol, "protocol")
    policy = load_policy(name)
    if overrides:
        design = (design or policy.design).with_values(dict(overrides), "overrides")
    return evaluate(policy, run, design=design, threads=1, alterations=alterations).light(
        trials_with_signals
    )
