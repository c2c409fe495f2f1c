"""What an evaluation gives: trials, measures, and how they become tables."""

from __future__ import annotations

import dataclasses
import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.bearing import headings
from hyperleg_design.evaluation.course import in_start_frame
from hyperleg_design.evaluation.measures import OUTCOMES
from hyperleg_design.evaluation.policy import OnnxPolicy, Policy, policy_name
from hyperleg_design.evaluation.protocol import protocol_mapping
from hyperleg_design.evaluation.rollout import ARRIVED
from hyperleg_design.evaluation.training_fit import (
    UNKNOWN,
    ZERO_SHOT,
    TrainingFit,
    training_fit,
)
from hyperleg_design.provenance import git_commit, versions
from hyperleg_design.writing import output_folder, write_bytes, write_json

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.motor_use import MotorUse
    from hyperleg_design.evaluation.power import CyclePower
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.robot.described import RobotDesign


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
            raise InputError(
                "evaluation", "measure", measure, f"there are {', '.join(self.measures[0])}"
            )
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


def trial_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """Tabulate all trials of some evaluations.

    Args:
        evaluations: whose trials are listed.

    Returns:
        One row for each trial: policy, variant, design, training seed, training steps, whether it
        was trained for this design, parameters outside of its trained range, protocol, trial,
        outcome, end time, and all measures.
    """
    import pandas as pd

    rows = []
    for evaluation in evaluations:
        head = {
            "policy": evaluation.policy,
            "variant": evaluation.variant,
            "design": evaluation.design,
            "seed": evaluation.seed,
            "steps": evaluation.steps,
            "trained": evaluation.trained.kind,
            "outside": ", ".join(evaluation.trained.outside),
        }
        for index, measures in enumerate(evaluation.measures):
            ended = {
                "trial": index,
                "outcome": evaluation.outcomes[index],
                "end_time": evaluation.end_times[index],
            }
            rows.append(head | {"protocol": evaluation.protocol.name} | ended | measures)
    return pd.DataFrame(rows)


def motor_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """Tabulate the use of all motors.

    Args:
        evaluations: whose motors are listed.

    Returns:
        One row for each motor and trial: policy, variant, training seed, trial, motor, and the
        fields of `MotorUse`.
    """
    import pandas as pd

    rows = []
    for evaluation in evaluations:
        for index, use in enumerate(evaluation.motors):
            if use is None:
                continue
            for k, motor in enumerate(use.motors):
                head = {
                    "policy": evaluation.policy,
                    "variant": evaluation.variant,
                    "seed": evaluation.seed,
                    "trial": index,
                    "motor": motor,
                }
                rows.append(
                    head
                    | {
                        name: float(values[k])
                        for name, values in vars(use).items()
                        if name != "motors"
                    }
                )
    return pd.DataFrame(rows)


def cycle_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """Tabulate the power over the gait cycle.

    Args:
        evaluations: of walks.

    Returns:
        One row for each policy, joint or motor, and point of the cycle. The columns are policy,
        variant, training seed, kind (`mechanical` for joints, `joule` for motors), part, share of
        the cycle, mean and deviation over all strides [W], and the number of strides.
    """
    import pandas as pd

    rows = []
    for evaluation in evaluations:
        cycles = [c for c in evaluation.cycles if c is not None and len(c.mechanical)]
        if not cycles:
            continue
        for kind, names in (("mechanical", cycles[0].joints), ("joule", cycles[0].motors)):
            power = np.concatenate([getattr(c, kind) for c in cycles])
            for k, name in enumerate(names):
                for point, share in enumerate(np.linspace(0, 1, power.shape[1])):
                    head = {
                        "policy": evaluation.policy,
                        "variant": evaluation.variant,
                        "seed": evaluation.seed,
                        "kind": kind,
                        "part": name,
                        "share": float(share),
                    }
                    values = power[:, point, k]
                    rows.append(
                        head
                        | {
                            "mean": float(values.mean()),
                            "deviation": float(values.std()),
                            "strides": len(values),
                        }
                    )
    return pd.DataFrame(rows)


def write_results(folder: str | os.PathLike[str], evaluations: Sequence[Evaluation]) -> Path:
    """Write evaluations to a folder.

    The files are `trials.parquet`, `motors.parquet`, `cycles.parquet`, `paths.parquet` and
    `evaluation.json`. The last one holds the protocols, what each policy states about itself,
    versions and commit, and no date.

    Args:
        folder: to be written; a folder of ours is replaced.
        evaluations: what is written.

    Returns:
        The folder.

    Raises:
        OutputError: the folder is somebody else's, or cannot be written; nothing half-written is
        left.
    """
    import pandas as pd

    paths = [
        {
            "policy": evaluation.policy,
            "variant": evaluation.variant,
            "seed": evaluation.seed,
            "trial": i,
            "step": k,
            "x": float(x),
            "y": float(y),
        }
        for evaluation in evaluations
        for i, path in enumerate(evaluation.paths)
        for k, (x, y) in enumerate(path)
    ]
    tables = {"trials": trial_table, "motors": motor_table, "cycles": cycle_table}
    contents = {name: build(evaluations) for name, build in tables.items()} | {
        "paths": pd.DataFrame(paths)
    }
    described = {
        "protocols": [
            protocol_mapping(p)
            for p in {
                id(evaluation.protocol): evaluation.protocol for evaluation in evaluations
            }.values()
        ],
        "policies": [
            {
                "policy": evaluation.policy,
                "variant": evaluation.variant,
                "seed": evaluation.seed,
                "steps": evaluation.steps,
                "trained": evaluation.trained.text(),
                **evaluation.origin,
            }
            for evaluation in evaluations
        ],
        "versions": versions(("hyperleg-design", "numpy", "scipy", "mujoco", "onnxruntime")),
        "commit": git_commit(),
    }
    with output_folder(folder) as place:
        for name, table in contents.items():
            write_bytes(place / f"{name}.parquet", _parquet(table))
        write_json(place / "evaluation.json", described)
    return Path(folder)


def _parquet(table: pd.DataFrame) -> bytes:
    stream = io.BytesIO()
    table.to_parquet(stream, index=False)
    return stream.getvalue()


def _path(trial: Trial) -> np.ndarray:
    if not trial.samples:
        return np.empty((0, 2))
    heading = headings(trial.base_orientation[0])
    return in_start_frame(
        trial.base_position[:: trial.substeps, :2], trial.base_position[0, :2], heading
    )


def by_seed(table: pd.DataFrame, measure: str) -> list[np.ndarray]:
    """Group a measure of a trial table by training seed; checkpoints of a seed are pooled.

    Policies that do not state their seed count as a seed each.

    Args:
        table: as `trial_table` makes it.
        measure: name of its column.

    Returns:
        One array of values for each seed.

    Raises:
        InputError: no such column.
    """
    return [np.concatenate(seed) for seed in by_checkpoint(table, measure).values()]


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
        raise InputError(
            "evaluation", "measure", measure, f"there are {', '.join(map(str, table.columns))}"
        )
    key = table["seed"].astype(str).where(table["seed"] >= 0, table["policy"])
    return {
        str(seed): [own[measure].to_numpy(float) for _, own in part.groupby("policy", sort=True)]
        for seed, part in table.groupby(key, sort=True)
    }
