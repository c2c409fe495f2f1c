"""What an evaluation gives: trials, measures, and how they become tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, meant
from hyperleg_design.evaluation.measures import OUTCOMES
from hyperleg_design.evaluation.motion.bearing import headings
from hyperleg_design.evaluation.policy import OnnxPolicy, Policy, policy_name
from hyperleg_design.evaluation.protocols.course import in_start_frame
from hyperleg_design.evaluation.rollout import ARRIVED
from hyperleg_design.evaluation.training_fit import (
    UNKNOWN,
    ZERO_SHOT,
    TrainingFit,
    training_fit,
)

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.motion.motor_use import MotorUse
    from hyperleg_design.evaluation.motion.power import CyclePower
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.robot.parameters.described import RobotDesign


ORIGIN = ("command", "commit", "versions", "deviations")
"""Metadata of a policy that results carry."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Trials of one policy under one protocol, and what was measured on each."""

    policy: str
    """Name of the policy."""
    variant: str
    """Ablation of the design."""
    design: str
    """Name of the design."""
    seed: int
    """Seed of the training; -1 where unknown."""
    steps: int
    """Policy steps of the training; -1 where unknown."""
    origin: Mapping[str, Any]
    """What an ONNX policy says of its training: command, commit, versions, deviations from the
    paper; empty for others."""
    protocol: Any
    """The `WalkProtocol` or `TTestProtocol`."""
    outcomes: list[str]
    """How each trial ended, of `rollout.OUTCOMES`."""
    end_times: list[float]
    """Time at which each trial ended [s]."""
    paths: list[np.ndarray]
    """Pelvis over the floor in the frame of the start, x ahead, once a policy step [m], `(t, 2)` of
    each trial."""
    measures: list[dict[str, float]]
    """Measures of each trial, the same names in all; NaN where a trial gives no such number."""
    motors: list[MotorUse | None]
    """How the motors were used in each trial; None where a trial gives no such numbers."""
    cycles: list[CyclePower | None] = field(default_factory=list)
    """Power of the right leg over the steady strides of each walk; None where there is none."""
    robot: RobotDesign | None = None
    """The design that was simulated."""
    trained: TrainingFit = field(default_factory=lambda: TrainingFit(UNKNOWN))
    """Whether the policy was trained for this design."""
    trials: list[Trial] = field(default_factory=list)
    """All signals, of some trials where others were let go by `light`."""

    def light(self, kept: int = 1) -> Evaluation:
        """Copy the evaluation without the signals of most trials; those of one trial fill some 4
        MB.

        Args:
            kept: number of trials whose signals are kept, those that arrived first.

        Returns:
            The copy.
        """
        return dataclasses.replace(
            self, trials=sorted(self.trials, key=lambda trial: trial.outcome != ARRIVED)[:kept]
        )

    def values(self, measure: str) -> np.ndarray:
        """Collect a measure of all trials.

        Args:
            measure: its name.

        Returns:
            The values, `(n,)`; NaN where a trial gives none.

        Raises:
            InputError: no such measure.
        """
        if measure not in self.measures[0]:
            raise InputError("evaluation", "measure", measure, meant(measure, self.measures[0]))
        return np.array([row[measure] for row in self.measures])


def evaluation_of(
    policy: Policy,
    design: RobotDesign,
    protocol: Any,
    trials: list[Trial],
    measures: list[dict[str, float]],
    motors: list[MotorUse | None],
    cycles: Sequence[CyclePower | None] = (),
) -> Evaluation:
    """Put the results of one design together with what the policy's file states about itself.

    Args:
        policy: the policy that was run.
        design: the robot.
        protocol: under which the trials were run.
        trials: their records.
        measures: of each trial, by name.
        motors: use of the motors in each trial.
        cycles: power over the gait cycle of each trial, for walks.

    Returns:
        The evaluation.
    """
    known = policy if isinstance(policy, OnnxPolicy) else None
    return Evaluation(
        policy=policy_name(policy),
        variant=design.variant,
        design=design.name,
        seed=known.seed if known else -1,
        steps=known.steps if known else -1,
        origin={key: known.metadata[key] for key in ORIGIN if key in known.metadata}
        if known
        else {},
        protocol=protocol,
        outcomes=[trial.outcome for trial in trials],
        end_times=[trial.end_time for trial in trials],
        paths=[_path(trial) for trial in trials],
        trials=trials,
        measures=measures,
        motors=motors,
        cycles=list(cycles),
        robot=design,
        trained=training_fit(policy, design),
    )


def swapped(evaluation: Evaluation, swap: str) -> Evaluation:
    """Mark an evaluation as one of a swapped robot, for which the policy was not trained.

    Args:
        evaluation: as it was measured.
        swap: what was swapped, for the name.

    Returns:
        A copy with another name and with the training marked as zero-shot.
    """
    return dataclasses.replace(
        evaluation,
        policy=f"{evaluation.policy} with {swap}",
        trained=TrainingFit(ZERO_SHOT, evaluation.trained.changed, evaluation.trained.outside),
    )


def evaluations_of(
    policy: Policy,
    designs: Sequence[RobotDesign],
    protocol: Any,
    trials: list[Trial],
    measures: list[dict[str, float]],
    motors: list[MotorUse | None],
    cycles: Sequence[CyclePower | None] = (),
) -> list[Evaluation]:
    """Put the results of several designs together, whose trials follow each other.

    Args:
        policy: the policy that was run.
        designs: the robots, with equally many trials each.
        protocol: under which the trials were run.
        trials: records of all trials, design by design.
        measures: of each trial, by name.
        motors: use of the motors in each trial.
        cycles: power over the gait cycle of each trial, for walks.

    Returns:
        One evaluation for each design.
    """
    each = len(trials) // len(designs)
    parts = [slice(i * each, (i + 1) * each) for i in range(len(designs))]
    return [
        evaluation_of(
            policy, design, protocol, trials[own], measures[own], motors[own], cycles[own]
        )
        for design, own in zip(designs, parts, strict=True)
    ]


def _path(trial: Trial) -> np.ndarray:
    if not trial.samples:
        return np.empty((0, 2))
    heading = headings(trial.base_orientation[0])
    return in_start_frame(
        trial.base_position[:: trial.substeps, :2], trial.base_position[0, :2], heading
    )


def counted(table: pd.DataFrame, measure: str) -> pd.Series:
    """Choose the values of a measure that count in means over trials: NaN for trials that fell,
    except for how trials ended.

    A fall turns height into motion, so the cost of transport of a trial that fell may even be
    negative. Falls are counted beside the means.

    Args:
        table: as `trial_table` makes it.
        measure: name of its column.

    Returns:
        The values, one for each row.
    """
    values = table[measure]
    return values if measure in OUTCOMES else values.where(~(table["fell"] > 0))


def arrivals_only(table: pd.DataFrame, *measures: str) -> pd.DataFrame:
    """Leave out what trials that did not arrive give of some measures.

    Args:
        table: as `trial_table` makes it.
        measures: names of its columns.

    Returns:
        A copy in which these measures are NaN where the trial did not arrive.
    """
    arrived = table["outcome"] == ARRIVED
    return table.assign(**{name: table[name].where(arrived) for name in measures})


def by_checkpoint(table: pd.DataFrame, measure: str) -> dict[str, list[np.ndarray]]:
    """Group a measure of a trial table by training seed and checkpoint, as `statistics` takes it.

    Policies that do not state their seed count as a seed each.

    Args:
        table: as `trial_table` makes it.
        measure: name of its column.

    Returns:
        For each seed, one array of values for each checkpoint.

    Raises:
        InputError: no such column.
    """
    if measure not in table:
        raise InputError("evaluation", "measure", measure, meant(measure, map(str, table.columns)))
    key = table["seed"].astype(str).where(table["seed"] >= 0, table["policy"])
    return {
        str(seed): [own[measure].to_numpy(float) for _, own in part.groupby("policy", sort=True)]
        for seed, part in table.groupby(key, sort=True)
    }
