"""Finalists of a search: the best designs are evaluated again before one of them is named.

The values that a search ranks its designs by are the best of many noisy ones, so they flatter the
winner. Finalists therefore run the same protocols again, from other starting states and with more
trials; where asked, each first gets policies that are fine-tuned to it. Only these values decide.

    OUT/finalists/NUMBER/        design, trainings and logs of a finalist; see `fine_tuning`
    OUT/finalists/finalists.json all values, and the winners
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.protocol import MOST_TRIALS, Protocol, protocol_mapping
from hyperleg_design.sweep.pareto import nondominated
from hyperleg_design.sweep.search import ROW, Search
from hyperleg_design.sweep.trial_runs import evaluate_values
from hyperleg_design.sweep.trial_table import design_table
from hyperleg_design.sweep.trials.trial_plan import kind_of
from hyperleg_design.sweep.tunings.fine_tuning import FineTuning, check_trainable, fine_tune
from hyperleg_design.writing import plain, write_json

if TYPE_CHECKING:
    import optuna
    import pandas as pd

    from hyperleg_design.robot.parameters.described import RobotDesign

FINALISTS = 3
"""Number of finalists by default."""
FOLDER, TABLE = "finalists", "finalists.json"
TRIALS_FACTOR = 3
"""Trials of a finalist over those of the search's protocol."""
SEED_SHIFT = 1_000_003
"""Added to the protocol's seed, so that finalists start from states that the search did not see."""

Row = dict[str, Any]
"""A design with its values on the axes and its measures, by name."""


@dataclass(frozen=True)
class Finalist:
    """One of the best designs of a search, evaluated again."""

    number: int
    """Number of the design in the search."""
    searched: Row
    """What the search measured of it."""
    before: Row
    """The same measures from new trials, with the policies that the search used."""
    after: Row | None
    """The same measures from the same starting states as `before`, with policies that were
    fine-tuned to the design; None without fine-tuning."""

    @property
    def decisive(self) -> Row:
        """The measures that the finalist is judged by."""
        return self.before if self.after is None else self.after


@dataclass(frozen=True)
class Final:
    """Outcome of a search, from measures that the search did not choose."""

    finalists: tuple[Finalist, ...]
    winners: tuple[int, ...]
    """Numbers of the finalists that hold all constraints and that no other such finalist beats in
    every objective, the best by the first objective first; empty where none holds them."""
    steps: int
    """Policy steps of each fine-tuning; 0 without."""

    def winner(self) -> Finalist | None:
        """The first of the winners."""
        by_number = {finalist.number: finalist for finalist in self.finalists}
        return by_number[self.winners[0]] if self.winners else None

    def to_mapping(self) -> dict[str, Any]:
        """All values as JSON takes them."""
        return {
            "steps": self.steps,
            "winners": list(self.winners),
            "finalists": [dict(vars(finalist)) for finalist in self.finalists],
        }


def check_fine_tuning(search: Search) -> None:
    """Check, before hours of work, that the policies of a search can be fine-tuned.

    Args:
        search: whose policies are meant.

    Raises:
        InputError: no protocol is evaluated, the extra `learning` is missing, or a policy cannot be
            the start of a training.
    """
    if not search.plan.protocols:
        raise InputError(
            "--finetune", "", None, "needs a protocol that the designs run (--evaluate walk)"
        )
    for policies in search.plan.policies.values():
        for policy in policies:
            check_trainable(policy.path)


def run_finalists(
    search: Search,
    study: optuna.Study,
    out: str | Path,
    *,
    count: int = FINALISTS,
    steps: int = 0,
    workers: int = 1,
    threads: int | None = None,
    progress: bool = True,
) -> Final:
    """Evaluate the best designs of a search again, and name the winners.

    A run that was killed goes on with the same call: finished trainings are not repeated, others go
    on from their checkpoints.

    Args:
        search: what was looked for.
        study: of `run_search`.
        out: folder of the search.
        count: finalists, at most.
        steps: policy steps by which the search's policies are fine-tuned to each finalist, each of
            them; 0 for no fine-tuning.
        workers: trainings side by side, of one thread each.
        threads: of each simulation.
        progress: show bars.

    Returns:
        The finalists, by their first objective in the search, and the winners.

    Raises:
        InputError: a policy that cannot be fine-tuned, or a training that failed.
        OutputError: the folder holds finalists of another search.
    """
    from tqdm import tqdm

    if steps:
        check_fine_tuning(search)
    rows = chosen_finalists(search, study, count)
    folder = Path(out) / FOLDER
    tuned: dict[tuple[int, str, str], Path] = {}
    if steps and rows:
        trainings = {
            (row["sample"], kind, policy.training): FineTuning(
                policy.path, _design(search, row), steps, folder / str(row["sample"])
            )
            for row in rows
            for kind in search.protocols
            for policy in search.plan.policies[kind, row["variant"]]
        }
        fine_tune(list(trainings.values()), workers=workers, progress=progress)
        tuned = {key: training.result for key, training in trainings.items()}
    finalists = tuple(
        Finalist(
            row["sample"],
            row,
            _evaluated(search, row, {}, threads),
            _evaluated(search, row, tuned, threads) if tuned else None,
        )
        for row in tqdm(rows, disable=not progress, unit="design", desc="finalists", delay=2.0)
    )
    final = Final(finalists, winners(search, [f.decisive for f in finalists]), steps)
    write_json(folder / TABLE, final.to_mapping())
    return final


def chosen_finalists(search: Search, study: optuna.Study, count: int) -> list[Row]:
    """The best designs of a search that hold all constraints.

    The Pareto front comes first, then the front of the rest, and so on. Of the front that has more
    designs than are still wanted, those are taken that lie evenly spread along the first objective.

    Args:
        search: what was looked for.
        study: of `run_search`.
        count: designs, at most.

    Returns:
        Their rows, front by front, each front by the first objective.
    """
    import optuna

    complete = study.get_trials(deepcopy=False, states=(optuna.trial.TrialState.COMPLETE,))
    rows = [trial.user_attrs[ROW] for trial in complete]
    rows = [row for row in rows if holds_constraints(search, row)]
    chosen: list[Row] = []
    while rows and len(chosen) < count:
        on_front = _front(search, rows)
        front = _ordered(search, [r for r, is_on in zip(rows, on_front, strict=True) if is_on])
        rows = [r for r, is_on in zip(rows, on_front, strict=True) if not is_on]
        places = np.linspace(0, len(front) - 1, min(count - len(chosen), len(front)))
        chosen += [front[i] for i in np.round(places).astype(int)]
    return chosen


def winners(search: Search, rows: Sequence[Row]) -> tuple[int, ...]:
    """Numbers of the designs that hold all constraints and that no other such design beats in every
    objective, the best by the first objective first.

    Args:
        search: states objectives and constraints.
        rows: what was measured, one a design.

    Returns:
        The numbers.
    """
    feasible = [row for row in rows if holds_constraints(search, row)]
    if not feasible:
        return ()
    on_front = [r for r, is_on in zip(feasible, _front(search, feasible), strict=True) if is_on]
    return tuple(row["sample"] for row in _ordered(search, on_front))


def final_protocol(protocol: Protocol) -> Protocol:
    """The protocol of a search with more trials and other starting states, for its finalists.

    Args:
        protocol: of the search.

    Returns:
        The changed protocol.
    """
    return protocol.changed(
        trials=min(TRIALS_FACTOR * int(protocol.trials), MOST_TRIALS),
        seed=(int(protocol.seed) + SEED_SHIFT) % 2**31,
    )


def value_of(row: Mapping[str, Any], name: str) -> float:
    """A measure of a row; NaN where it could not be measured.

    Args:
        row: what was measured of a design.
        name: of the measure.

    Returns:
        The value.
    """
    value = row.get(name)
    return float("nan") if value is None else float(value)


def holds_constraints(search: Search, row: Row) -> bool:
    """Whether a design has all objectives and holds all constraints.

    Args:
        search: states objectives and constraints.
        row: what was measured of a design.

    Returns:
        True if so.
    """
    measured = all(np.isfinite(value_of(row, name)) for name in search.objectives)
    return measured and all(c.violation(value_of(row, c.name)) <= 0 for c in search.constraints)


def _front(search: Search, rows: Sequence[Row]) -> np.ndarray:
    values = np.array([[value_of(row, name) for name in search.objectives] for row in rows])
    return nondominated(values, ["high" if d == "maximize" else "low" for d in search.directions])


def _ordered(search: Search, rows: Sequence[Row]) -> list[Row]:
    first, reverse = search.objectives[0], search.directions[0] == "maximize"
    return sorted(rows, key=lambda row: value_of(row, first), reverse=reverse)


def _values(search: Search, row: Row) -> dict[str, np.ndarray]:
    """Value of each axis, `(1,)`."""
    return {axis.name: np.array([row[axis.name]]) for axis in search.sweep.axes}


def _design(search: Search, row: Row) -> RobotDesign:
    return search.sweep.design(_values(search, row), row["variant"]).take(0)


def _evaluated(
    search: Search, row: Row, tuned: Mapping[tuple[int, str, str], Path], threads: int | None
) -> Row:
    """A finalist's row with the measures of new trials; `tuned` policies stand in for the search's
    where there are any.
    """
    import pandas as pd

    if not search.plan.protocols:
        return row
    sample, variant = np.array([row["sample"]]), row["variant"]
    parts: list[pd.DataFrame] = []
    for protocol in search.plan.protocols:
        kind = kind_of(protocol)
        mapping = protocol_mapping(final_protocol(protocol))
        for policy in search.plan.policies[kind, variant]:
            path = tuned.get((row["sample"], kind, policy.training), policy.path)
            parts.append(
                evaluate_values(
                    search.sweep, variant, _values(search, row), sample, mapping, path, threads
                )
            )
    own = {
        name: np.array([value])
        for name, value in row.items()
        if name.split(".", 1)[0] not in search.protocols
    }
    table = design_table(search.sweep, pd.concat(parts, ignore_index=True), own)
    return dict(plain({name: values[0] for name, values in table.items()}))
