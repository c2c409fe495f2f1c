"""Tables of evaluations: trials, motors and gait cycles, and the files that hold them."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.protocol import protocol_mapping
from hyperleg_design.evaluation.result import Evaluation, counted
from hyperleg_design.provenance import git_commit, versions
from hyperleg_design.writing import output_folder, write_bytes, write_json, write_text

if TYPE_CHECKING:
    import pandas as pd


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


def policy_table(evaluations: Sequence[Evaluation]) -> pd.DataFrame:
    """Tabulate the means of each policy.

    Args:
        evaluations: whose trials are averaged.

    Returns:
        One row for each policy, design and protocol: the number of trials, the shares that ended in
        each way, and the mean of each measure over the trials that did not fall (`counted`).
    """
    keys = ["policy", "variant", "design", "seed", "steps", "trained", "outside", "protocol"]
    rows = trial_table(evaluations).drop(columns=["trial", "outcome", "end_time"])
    for measure in rows.columns.difference(keys):
        rows[measure] = counted(rows, measure)
    groups = rows.groupby(keys, sort=False)
    table = groups.mean().reset_index()
    table.insert(len(keys), "trials", groups.size().to_numpy())
    return table


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

    The files are `policies.csv`, `trials.parquet`, `motors.parquet`, `cycles.parquet`,
    `paths.parquet` and `evaluation.json`. The last one holds the protocols, what each policy states
    about itself, versions and commit, and no date.

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
        policies = policy_table(evaluations).to_csv(index=False, float_format="%.6g")
        write_text(place / "policies.csv", policies)
        write_json(place / "evaluation.json", described)
    return Path(folder)


def _parquet(table: pd.DataFrame) -> bytes:
    stream = io.BytesIO()
    table.to_parquet(stream, index=False)
    return stream.getvalue()
