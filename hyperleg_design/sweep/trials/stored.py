"""Trials of evaluated sweeps that are committed, so that a page shows them without hours of work.

    sweeps/walked/NAME.parquet   one row a trial, as `trial_runs` writes it, the measures that
                                 pages of sweeps show, in single precision

The file's metadata name the definition, protocols and policies that it is of, by digest.
"""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.measures import OUTCOMES
from hyperleg_design.sweep.run import SweepResult
from hyperleg_design.sweep.space import load_sweep
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.trial_runs import TRIALS, evaluate_batch, trials_state
from hyperleg_design.sweep.trial_table import SHOWN
from hyperleg_design.sweep.trials.trial_plan import Plan, kind_of
from hyperleg_design.writing import write_bytes

if TYPE_CHECKING:
    import pandas as pd

WALKED = "walked"
"""Folder of committed trials in `sweeps/`."""
RERUN = 3
"""Designs that a page runs again, spread evenly over the sweep."""
_HEAD = ("sample", "variant", "protocol", "policy", "seed", "trained", "outside", "trial")
_LIMITS = ("outcome", "reason", "speed_use")
_COST = "cost_of_transport"


@dataclass(frozen=True, eq=False)
class Stored:
    """Committed trials of a sweep."""

    sweep: Sweep
    trials: pd.DataFrame
    plan: str
    """Digest of the protocols and policies that ran."""
    commit: str
    """Of the code that ran them."""


@dataclass(frozen=True)
class Rerun:
    """How some trials, run again, compare with the committed ones."""

    designs: int
    trials: int
    policy: str
    """Training whose last policy ran."""
    same_outcomes: int
    """Trials that ended in the same way."""
    largest_difference: float
    """Largest relative difference of a design's mean cost of transport; NaN where all fell."""


def stored_names() -> list[str]:
    """List the shipped sweeps with committed trials.

    Returns:
        Their names, sorted.
    """
    return sorted(path.stem for path in _folder().glob("*.parquet"))


def _folder() -> Path:
    return resources.content_folder("sweeps") / WALKED


def store(result: SweepResult, target: str | Path) -> Path:
    """Write the trials of an evaluated sweep in the form that is committed.

    Args:
        result: a sweep after `run_trials`.
        target: file to write, `sweeps/walked/NAME.parquet`.

    Returns:
        The path of the file.

    Raises:
        InputError: the sweep has no trials, or those of another definition.
    """
    import pandas as pd
    import pyarrow as pa
    import pyarrow.parquet as pq

    path = result.folder / TRIALS
    state = trials_state(path)
    if not isinstance(state, dict) or state.get("sweep") != result.sweep.digest():
        raise InputError(str(path), "", None, "expects the trials of this sweep: evaluate it first")
    trials = pd.read_parquet(path)
    mapped = {m.measure.split(".", 1)[1] for m in result.sweep.trial_maps}
    aimed = {name.split(".", 1)[1] for name in result.sweep.trial_objectives if "." in name}
    shown = {name for names in SHOWN.values() for name in names} | mapped | aimed | set(OUTCOMES)
    wanted = [c for c in trials if c in _HEAD or c in _LIMITS or c in shown]
    small = trials[wanted]
    floats = {c: np.float32 for c in small if small[c].dtype == np.float64}
    table = pa.Table.from_pandas(small.astype(floats), preserve_index=False)
    origin = {**state, "commit": result.summary["commit"]}
    metadata = {**(table.schema.metadata or {}), b"hyperleg_trials": json.dumps(origin).encode()}
    stream = io.BytesIO()
    pq.write_table(table.replace_schema_metadata(metadata), stream, compression="zstd")
    return write_bytes(target, stream.getvalue())


def stored(name: str) -> Stored:
    """Read the committed trials of a shipped sweep.

    Args:
        name: of the sweep.

    Returns:
        The trials, with the sweep and the plan that they are of.

    Raises:
        InputError: they are of another definition than the shipped one, or cannot be read.
    """
    import pandas as pd

    path = _folder() / f"{name}.parquet"
    state = trials_state(path)
    sweep = load_sweep(name)
    if not isinstance(state, dict):
        raise InputError(f"sweeps/{WALKED}/{path.name}", "", None, "cannot be read")
    if state.get("sweep") != sweep.digest():
        raise InputError(
            f"sweeps/{WALKED}/{path.name}",
            "",
            None,
            f"is of another definition than sweeps/{name}.yaml: run the sweep and store it again",
        )
    trials = pd.read_parquet(path)
    return Stored(sweep, trials, str(state["plan"]), str(state.get("commit") or "unknown"))


def rerun(committed: Stored, wanted: Plan, count: int = RERUN) -> Rerun:
    """Run the first policy of a plan on some designs again.

    Args:
        committed: the trials to compare with.
        wanted: protocols and policies; the first protocol, variant and policy run.
        count: designs, spread evenly over those that were simulated.

    Returns:
        The new trials beside the committed ones.
    """
    import pandas as pd

    from hyperleg_design.evaluation.protocol import protocol_mapping

    protocol = wanted.protocols[0]
    variant = committed.sweep.variants[0]
    policy = wanted.policies[kind_of(protocol), variant][0]
    rows = committed.trials
    own = rows[
        (rows["protocol"] == kind_of(protocol))
        & (rows["variant"] == variant)
        & (rows["policy"] == policy.training)
        & (rows["trial"] >= 0)
    ]
    there = np.unique(own["sample"])
    places = (np.arange(count) + 0.5) * len(there) / count
    samples = there[np.unique(places.astype(int))]
    mapping: dict[str, Any] = protocol_mapping(protocol)
    again = pd.read_parquet(
        io.BytesIO(evaluate_batch(committed.sweep, variant, samples, mapping, policy.path, 1))
    )
    both = own.merge(again, on=["sample", "trial"], suffixes=("", ".again"))
    walked = both[~(both["fell"] > 0) & ~(both["fell.again"] > 0)]
    means = walked.groupby("sample")[[_COST, f"{_COST}.again"]].mean()
    difference = (means[f"{_COST}.again"] / means[_COST] - 1).abs()
    return Rerun(
        designs=len(samples),
        trials=len(both),
        policy=policy.training,
        same_outcomes=int((both["outcome"] == both["outcome.again"]).sum()),
        largest_difference=float(difference.max()),
    )
