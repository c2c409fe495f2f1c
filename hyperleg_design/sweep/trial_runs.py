"""Evaluation of a sweep's designs: shipped policies run the protocols on every design, many designs
side by side.

    OUT/trials.parquet      one row a trial: sample, variant, protocol, policy, outcome, measures
    OUT/trial_chunks/       while it runs, or after it was killed: finished batches

A batch is the trials of one policy under one protocol on some designs of one variant. A killed run
loses the batches in flight; what was finished is not run again, and a batch that cannot be read is.
"""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.evaluate import evaluate_designs
from hyperleg_design.evaluation.policy import OnnxPolicy, load_policy
from hyperleg_design.evaluation.protocol import (
    Protocol,
    protocol_from_mapping,
    protocol_mapping,
)
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sweep.jobs import completed
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.trials.trial_plan import Plan, kind_of
from hyperleg_design.sweep.trials.trial_plan import plan as plan
from hyperleg_design.writing import write_bytes, write_json

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.result import Evaluation
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.sweep.run import SweepResult

TRIALS, CHUNKS, STATE = "trials.parquet", "trial_chunks", "state.json"
BATCH = 16
"""Designs side by side: with ten trials each some 1 GB of signals."""
REJECTED = "rejected"
"""Outcome of a design that no trial could be run on; `reason` says why."""


def run_trials(
    result: SweepResult,
    wanted: Plan,
    *,
    batch: int = BATCH,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool = True,
) -> Path:
    """Run a plan on every design of a finished sweep that makes a robot.

    Args:
        result: the sweep.
        wanted: the plan.
        batch: designs side by side.
        executor: runs batches on other processes or machines; in this process by default.
        threads: of each simulation.
        progress: show a bar.

    Returns:
        The table of all trials.

    Raises:
        InputError: a policy that does not fit, or whose output is not finite.
        OutputError: the folder holds trials of another plan.
    """
    from tqdm import tqdm

    sweep, folder = result.sweep, result.folder
    state = {"sweep": sweep.digest(), "plan": wanted.digest, "batch": batch}
    chunks, target = folder / CHUNKS, folder / TRIALS
    if trials_state(target) == state:
        return target
    if (chunks / STATE).exists() and _read_state(chunks / STATE) not in (state, None):
        raise OutputError(
            f"{folder}: holds trials of other protocols or policies; choose another folder, or "
            f"restart (--restart) to replace them"
        )
    chunks.mkdir(exist_ok=True)
    write_json(chunks / STATE, state)
    head = result.columns(["sample", "variant", "rejected"])
    jobs: list[tuple[Path, tuple[Any, ...]]] = []
    every: list[Path] = []
    for protocol in wanted.protocols:
        kind, mapping = kind_of(protocol), protocol_mapping(protocol)
        for variant in sweep.variants:
            good = head["sample"][(head["variant"] == variant) & (head["rejected"] == "")]
            for policy in wanted.policies[kind, variant]:
                for start in range(0, len(good), batch):
                    samples = good[start : start + batch]
                    path = chunks / f"{kind}-{variant}-{policy.training}-{start:08d}.parquet"
                    every.append(path)
                    if not _readable(path):
                        job = (sweep, variant, samples, mapping, policy.path, threads)
                        jobs.append((path, job))
    with tqdm(
        total=len(every),
        initial=len(every) - len(jobs),
        disable=not progress,
        desc=f"{sweep.name}: trials",
        unit="batch",
    ) as bar:
        for path, content in completed(evaluate_batch, jobs, executor):
            write_bytes(path, content)
            bar.update()
    write_bytes(target, _joined(every, state))
    shutil.rmtree(chunks)
    return target


def evaluate_batch(
    sweep: Sweep,
    variant: str,
    samples: np.ndarray,
    protocol: dict[str, Any],
    policy: Path,
    threads: int | None = None,
) -> bytes:
    """Run one policy on some designs of a sweep.

    Args:
        sweep: the definition.
        variant: name of the ablation.
        samples: numbers of the designs, `(n,)`.
        protocol: as `protocol_mapping` gives it.
        policy: ONNX file.
        threads: of the simulation.

    Returns:
        The trials, as a Parquet file.
    """
    values = {name: column[samples] for name, column in sweep.samples().items()}
    return _parquet(evaluate_values(sweep, variant, values, samples, protocol, policy, threads))


def evaluate_values(
    sweep: Sweep,
    variant: str,
    values: Mapping[str, np.ndarray],
    samples: np.ndarray,
    protocol: dict[str, Any],
    policy: Path,
    threads: int | None = None,
) -> pd.DataFrame:
    """Run one policy on designs that are given by their values on the axes.

    Args:
        sweep: the definition.
        variant: ablation.
        values: by axis, `(n,)`.
        samples: numbers of the designs, `(n,)`.
        protocol: as `protocol_mapping` gives it.
        policy: ONNX file.
        threads: of the simulation.

    Returns:
        The trials, as `trial_rows` tabulates them.
    """
    designs = sweep.design(values, variant).rows(np.arange(len(samples)))
    run = protocol_from_mapping(protocol, "protocol")
    evaluations, rejected = evaluate_all(load_policy(policy), designs, run, threads)
    return trial_rows(evaluations, rejected, samples, variant, run, policy)


def evaluate_all(
    policy: OnnxPolicy, designs: RobotDesign, protocol: Protocol, threads: int | None = None
) -> tuple[dict[int, Evaluation], dict[int, str]]:
    """Evaluate those designs of a batch that can be simulated.

    Args:
        policy: that runs.
        designs: the batch.
        protocol: under which it runs.
        threads: of the simulation.

    Returns:
        Evaluations, without signals, and reasons of rejection, by the design's number.
    """
    rows = np.arange((designs.batch_shape or (1,))[0])
    rejected: dict[int, str] = {}
    while len(rows):
        try:
            done = evaluate_designs(policy, designs.rows(rows), protocol, threads=threads)
        except InputError as error:
            bad = error.bad
            if bad is None or np.shape(bad) != (len(rows),) or not np.any(bad):
                raise
            rejected |= {int(i): f"{error.field} {error.remedy}".strip() for i in rows[bad]}
            rows = rows[~np.asarray(bad)]
            continue
        return {
            int(i): evaluation.light(0) for i, evaluation in zip(rows, done, strict=True)
        }, rejected
    return {}, rejected


def trial_rows(
    evaluations: dict[int, Evaluation],
    rejected: dict[int, str],
    samples: np.ndarray,
    variant: str,
    protocol: Protocol,
    policy: Path,
) -> pd.DataFrame:
    """Tabulate trials, and designs that were rejected.

    Besides the measures there are `speed_use`, the largest motor speed over the no-load speed, and
    `hardest_motor`, the motor with the largest continuous use.

    Args:
        evaluations: by position in `samples`.
        rejected: reasons by position in `samples`.
        samples: numbers of the designs, `(n,)`.
        variant: name of the ablation.
        protocol: under which the trials ran.
        policy: ONNX file, whose folder names the training.

    Returns:
        One row for each trial, and one for each design that was rejected.
    """
    import pandas as pd

    rows: list[dict[str, Any]] = []
    head = {"variant": variant, "protocol": kind_of(protocol), "policy": policy.parent.name}
    for i, evaluation in evaluations.items():
        for k, measures in enumerate(evaluation.measures):
            rows.append(
                {
                    "sample": int(samples[i]),
                    **head,
                    "seed": evaluation.seed,
                    "trained": evaluation.trained.kind,
                    "outside": ", ".join(evaluation.trained.outside),
                    "trial": k,
                    "outcome": evaluation.outcomes[k],
                    "reason": "",
                    "hardest_motor": "",
                    "speed_use": np.nan,
                    **measures,
                }
            )
            use = evaluation.motors[k]
            if use is not None:
                rows[-1] |= {
                    "hardest_motor": use.motors[int(np.argmax(use.continuous_use))],
                    "speed_use": _speed_use(evaluation.robot, use.peak_speed),
                }
    for i, reason in rejected.items():
        rows.append(
            {
                "sample": int(samples[i]),
                **head,
                "trial": -1,
                "outcome": REJECTED,
                "reason": reason,
            }
        )
    return pd.DataFrame(rows)


def _speed_use(design: RobotDesign | None, peak_speed: np.ndarray) -> float:
    if design is None:
        return float("nan")
    limbs = len(design.copies)
    free = motor_arrays(design).no_load_speed[: len(peak_speed) // limbs]
    return float(np.max(peak_speed / np.tile(free, limbs)))


def _parquet(rows: pd.DataFrame) -> bytes:
    stream = io.BytesIO()
    rows.to_parquet(stream, index=False)
    return stream.getvalue()


def _joined(paths: Sequence[Path], state: dict[str, Any]) -> bytes:
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

    parts = [pd.read_parquet(path) for path in paths]
    rows = pd.concat([p for p in parts if len(p)], ignore_index=True) if parts else pd.DataFrame()
    arrow_table = pa.Table.from_pandas(rows, preserve_index=False)
    metadata = {
        **(arrow_table.schema.metadata or {}),
        b"hyperleg_trials": json.dumps(state).encode(),
    }
    stream = io.BytesIO()
    pq.write_table(arrow_table.replace_schema_metadata(metadata), stream, compression="zstd")
    return stream.getvalue()


def trials_state(path: Path) -> Any:
    """Read what made a table of trials.

    Args:
        path: of the file.

    Returns:
        Digests of sweep and plan; None where the file cannot be read.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return json.loads((pq.read_schema(path).metadata or {})[b"hyperleg_trials"])
    except (OSError, pa.ArrowException, KeyError, ValueError):
        return None


def _read_state(path: Path) -> Any:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return None


def _readable(path: Path) -> bool:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        pq.read_table(path, columns=["sample"])
    except (OSError, pa.ArrowException):
        return False
    return True
