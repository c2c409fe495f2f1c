"""Robustness: what policies do as one condition of their walk moves away from what they know.

Each condition changes one thing over several levels; everything else is the protocol's. Curves are
means over trainings and trials with intervals (`statistics`), by toe layout or robot, of the share
of trials that arrive and of the cost of transport of those that did.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.evaluate import evaluate_many, evaluation_pool, protocol_for
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Protocol, TTestProtocol, WalkProtocol
from hyperleg_design.evaluation.result import arrivals_only, by_checkpoint
from hyperleg_design.evaluation.result_tables import trial_table
from hyperleg_design.evaluation.shipped import check_different, find_policy
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.settings import Randomisation
from hyperleg_design.simulation.surroundings import Slope, TorqueConstants

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.statistics import Estimate
    from hyperleg_design.robot.parameters.described import RobotDesign

PUSH_INTERVAL = 2.0
"""Mean time between pushes [s]; assumed."""
SHOWN = {"walk": ("arrived", "steady_cost_of_transport"), "t_test": ("arrived", "time")}
"""Measures of the curves, by kind of protocol."""


@dataclass(frozen=True)
class Setting:
    """What one level of a condition changes."""

    design: Callable[[RobotDesign], Mapping[str, Any]] | None = None
    """Leaves to replace, of a robot."""
    protocol: Mapping[str, Any] = field(default_factory=dict)
    """Fields of the protocol to replace."""
    alterations: tuple[Alteration, ...] = ()
    """Of the simulation."""
    ahead: bool = False
    """Whether robots must start along x."""


@dataclass(frozen=True)
class Condition:
    """One thing that is varied."""

    label: str
    """With its unit, for axes."""
    levels: tuple[float, ...]
    """By default; one of them is what the protocol has."""
    setting: Callable[[float], Setting]
    walks_only: bool = False
    """Whether T-tests have no such thing."""
    missing: Callable[[RobotDesign], str] = lambda design: ""
    """What a robot lacks for this condition; empty where it has all."""


def _payload(mass: float) -> Setting:
    """A mass at the centre of mass of the root link; only an inertia that the design computes from
    the mass grows with it.
    """

    def leaves(design: RobotDesign) -> dict[str, Any]:
        path = f"{design.root_link}.mass"
        return {path: design[path] + mass} if mass else {}

    return Setting(design=leaves)


def _friction_leaves(design: RobotDesign) -> dict[str, Any]:
    """Coulomb and viscous friction of every joint, by path."""
    return {
        path: design[path]
        for path in design.rules
        if path.startswith("joints.") and path.endswith((".coulomb", ".viscous"))
    }


def _friction(factor: float) -> Setting:
    def leaves(design: RobotDesign) -> dict[str, Any]:
        return {path: value * factor for path, value in _friction_leaves(design).items()}

    return Setting(design=leaves)


def _frictionless(design: RobotDesign) -> str:
    return "" if any(map(np.any, _friction_leaves(design).values())) else "no friction in any joint"


def _pushed(speed: float) -> Setting:
    pushes = Randomisation(push_speed=speed, push_interval=PUSH_INTERVAL)
    return Setting(protocol={"randomisation": pushes})


CONDITIONS: dict[str, Condition] = {
    "speed": Condition(
        "commanded speed [m/s]",
        (0.6, 0.8, 1.0, 1.33, 1.6, 2.0),
        lambda level: Setting(protocol={"speed": level}),
        walks_only=True,
    ),
    "push": Condition("largest push, every 2 s [m/s]", (0.0, 0.2, 0.4, 0.6, 0.8), _pushed),
    "slope": Condition(
        "slope, uphill positive [deg]",
        (-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0),
        lambda level: Setting(alterations=(Slope(level),), ahead=True),
        walks_only=True,
    ),
    "floor_friction": Condition(
        "friction coefficient of the floor [-]",
        (0.2, 0.3, 0.4, 0.6, 0.8, 1.0),
        lambda level: Setting(design=lambda design: {"contact.friction": level}),
    ),
    "payload": Condition("payload at the root link [kg]", (0.0, 2.0, 4.0, 6.0, 8.0), _payload),
    "joint_friction": Condition(
        "joint friction over the nominal [-]",
        (0.8, 0.9, 1.0, 1.1, 1.2),
        _friction,
        missing=_frictionless,
    ),
    "torque_constant": Condition(
        "torque constant over the nominal [-]",
        (0.8, 0.9, 1.0, 1.1, 1.2),
        lambda level: Setting(alterations=(TorqueConstants(level),)),
    ),
    "uneven_floor": Condition(
        "height of bumps 0.2 m apart [m]",
        (0.0, 0.01, 0.02, 0.03, 0.05),
        lambda level: Setting(protocol={"randomisation": Randomisation(uneven_floor=level)}),
    ),
}
"""Conditions by name."""


@dataclass(frozen=True)
class CurvePoint:
    """A point of a robustness curve."""

    condition: str
    """One of `CONDITIONS`."""
    level: float
    """Of the condition."""
    variant: str
    """Toe layout; of a robot that has none, its name."""
    measure: str
    """One of `SHOWN`."""
    estimate: Estimate
    """Mean over trainings and trials, with its interval."""


def conditions_of(
    names: Sequence[str], protocol: Protocol, designs: Sequence[RobotDesign] = ()
) -> list[str]:
    """Choose the conditions that are varied.

    Args:
        names: of conditions; empty for all that the protocol and the robots have.
        protocol: under which the policies run.
        designs: the robots.

    Returns:
        The names of the conditions.

    Raises:
        InputError: no such condition, or one that the protocol or a robot does not have.
    """
    runs = isinstance(protocol, TTestProtocol)
    lacking = {
        name: f"{design.name} has {missing}"
        for name, condition in CONDITIONS.items()
        for design in designs
        if (missing := condition.missing(design))
    }
    fitting = [
        name
        for name, condition in CONDITIONS.items()
        if not (runs and condition.walks_only) and name not in lacking
    ]
    for name in names:
        if name not in fitting:
            remedy = meant(name, fitting)
            if name in CONDITIONS:
                why = lacking.get(name, "it is of walks only")
                remedy = f"means nothing here: {why}; there are {', '.join(fitting)}"
            raise InputError("robustness", "condition", name, remedy)
    return list(names) or fitting


def robustness(
    policies: Sequence[str | Path],
    conditions: Sequence[str] = (),
    *,
    protocol: Protocol | None = None,
    levels: Mapping[str, Sequence[float]] | None = None,
    workers: int = 2,
    pool: Executor | None = None,
    progress: Callable[[int, int, str], None] | None = None,
) -> pd.DataFrame:
    """Evaluate policies over the levels of conditions.

    Args:
        policies: ONNX files or names of shipped trainings, all of one kind of task.
        conditions: names, of `CONDITIONS`; all that fit protocol and robots by default.
        protocol: what suits the first policy's task by default.
        levels: of some conditions, in place of their own.
        workers: processes side by side.
        pool: of `evaluation_pool`; processes of its own by default.
        progress: called before each level and at the end with how many of how many levels are done,
            and the condition.

    Returns:
        One row a trial: those of `trial_table`, with `condition` and `level` in front.

    Raises:
        InputError: a policy that cannot be used, the same one twice, or a condition that is unknown
            or that protocol or robot does not have.
    """
    import pandas as pd

    check_different(map(find_policy, policies), "robustness")
    protocol = protocol or protocol_for(load_policy(policies[0]))
    designs = [load_policy(policy).design for policy in policies]
    chosen = {
        name: tuple((levels or {}).get(name, CONDITIONS[name].levels))
        for name in conditions_of(conditions, protocol, designs)
    }
    count, done, tables = sum(map(len, chosen.values())), 0, []
    with nullcontext(pool) if pool else evaluation_pool(workers) as processes:
        for name, values in chosen.items():
            for level in values:
                if progress is not None:
                    progress(done, count, name)
                setting = CONDITIONS[name].setting(float(level))
                evaluations = evaluate_many(
                    policies,
                    _under(protocol, setting),
                    workers=workers,
                    pool=processes,
                    kept=0,
                    overrides=[dict(setting.design(d)) if setting.design else {} for d in designs],
                    alterations=setting.alterations or None,
                )
                table = trial_table(evaluations)
                table.insert(0, "condition", name)
                table.insert(1, "level", float(level))
                tables.append(table)
                done += 1
    if progress is not None:
        progress(done, count, name)
    return pd.concat(tables, ignore_index=True)


def curves(table: pd.DataFrame, kind: str = "walk") -> list[CurvePoint]:
    """Compute curves over the levels of each condition from a table of `robustness`.

    For the share that arrived, all trials count; for other measures, only those that arrived.

    Args:
        table: one row for each trial, with condition and level.
        kind: of protocol, `walk` or `t_test`.

    Returns:
        One point for each condition, level, variant and measure.
    """
    points = []
    robot = table["variant"].where(table["variant"] != "", table["design"])
    keys = [table["condition"], table["level"], robot]
    for (name, level, variant), part in table.groupby(keys, sort=True):
        for measure in SHOWN[kind]:
            values = part
            if measure != "arrived":
                values = arrivals_only(part, measure)
            groups = list(by_checkpoint(values, measure).values())
            estimator = statistics.share if measure == "arrived" else statistics.estimate
            points.append(
                CurvePoint(
                    str(name),
                    float(str(level)),
                    str(variant),
                    measure,
                    estimator(groups, resamples=1000),
                )
            )
    return points


def _under(protocol: Protocol, setting: Setting) -> Protocol:
    """A protocol with a level's changes; with enough time for a slower walk."""
    changes: dict[str, Any] = dict(setting.protocol)
    if setting.ahead:
        changes["start"] = dataclasses.replace(protocol.start, yaw=0.0)
    if isinstance(protocol, WalkProtocol) and "speed" in changes:
        slower = protocol.speed / changes["speed"]
        changes["time_limit"] = protocol.time_limit * max(1.0, slower)
    return protocol.changed(**changes)
