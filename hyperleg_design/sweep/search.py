"""Search for good designs with Optuna: designs are asked for in batches, evaluated together, and
told.

The axes of a sweep are the space: ranges become numbers, lists become choices. Objectives are any
measures of `registry`; constraints hold arrivals, heat and torque within bounds. The study lies in
a database (SQLite beside the results, or PostgreSQL for many machines), so a search goes on where
it was killed, and `optuna-dashboard` shows it while it runs.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError, OutputError
from hyperleg_design.evaluation.protocol import protocol_mapping
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.jobs import completed
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import evaluate_samples
from hyperleg_design.sweep.searching.constraint import (
    Constraint,
    earlier_constraints,
    read_constraint,
    usual_constraints,
)
from hyperleg_design.sweep.searching.study_database import (
    DATABASE,
    OWN,
    OWNER,
    clear_errors,
    open_study,
    owner_of,
    take_up,
)
from hyperleg_design.sweep.space import with_columns
from hyperleg_design.sweep.spaces.definition import Sweep
from hyperleg_design.sweep.trial_runs import BATCH, evaluate_values
from hyperleg_design.sweep.trial_table import design_table
from hyperleg_design.sweep.trials.trial_plan import Plan, kind_of
from hyperleg_design.writing import MARKER, check_output_folder, plain

if TYPE_CHECKING:
    import optuna

VARIANT = "variant"
"""Parameter that chooses the toe, where there are several."""
REASON, ROW = "reason", "row"
"""Attributes of a trial: why it failed, and all that was measured."""


@dataclass(frozen=True)
class Search:
    """Space, objectives and constraints of a search."""

    sweep: Sweep
    """Its axes are the space; its grid or samples are not used."""
    plan: Plan
    objectives: tuple[str, ...]
    """Full names of measures."""
    constraints: tuple[Constraint, ...]

    @property
    def protocols(self) -> list[str]:
        """Kinds of the plan's protocols."""
        return [kind_of(p) for p in self.plan.protocols]

    @property
    def directions(self) -> list[str]:
        """`minimize` or `maximize` for each objective."""
        better = [registry.entry(name).better for name in self.objectives]
        return ["maximize" if b == "high" else "minimize" for b in better]

    def digest(self) -> str:
        """Fingerprint of all that decides a trial's numbers."""
        described = [
            self.sweep.digest(),
            self.plan.digest,
            self.objectives,
            [vars(c) for c in self.constraints],
        ]
        return hashlib.sha256(json.dumps(described).encode()).hexdigest()


def search_of(
    sweep: Sweep,
    plan: Plan,
    objectives: Sequence[str] = (),
    constraints: Sequence[str] = (),
) -> Search:
    """A search over a sweep's axes.

    Args:
        sweep: the space.
        plan: protocols and policies.
        objectives: names of measures; the sweep's own by default, those of trials first.
        constraints: texts such as `walk.fell<=0.1`; `usual_constraints` by default.

    Raises:
        InputError: no objective, or a name that is no measure at hand.
    """
    protocols = [kind_of(p) for p in plan.protocols]
    names = objectives or (*sweep.trial_objectives, *sweep.objectives)
    chosen = tuple(registry.resolve(n, protocols, "--objective").name for n in names)
    if not chosen:
        remedy = (
            f"{sweep.source} names no objectives; give --objective, of `hyperleg list measures`"
        )
        raise InputError("search", "objectives", None, remedy)
    if len(set(chosen)) < len(chosen):
        raise InputError("search", "objectives", list(names), "expects different measures")
    bounds = tuple(read_constraint(text, protocols) for text in constraints)
    bounds = bounds or usual_constraints(protocols)
    named = [*chosen, *(bound.name for bound in bounds)]
    needed = with_columns(sweep.measures, named, sweep.base)
    space = dataclasses.replace(sweep, measures=needed)
    at_hand = measures.columns(needed, sweep.base)
    for name in named:
        if not registry.entry(name).protocol and name not in at_hand:
            known = measures.columns(measures.measures_of(sweep.base), sweep.base)
            remedy = parameters.unknown(name, sorted(known), "measure")
            raise InputError("search", "", name, remedy)
    return Search(space, plan, chosen, bounds)


def run_search(
    search: Search,
    out: str | Path,
    trials: int,
    *,
    storage: str = "",
    name: str = "",
    batch: int = BATCH,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool = True,
) -> optuna.Study:
    """Search until the study holds so many finished trials.

    Args:
        search: what is looked for.
        out: folder that marks this process's own trials, and holds the database by default.
        trials: finished ones in all, those of earlier and other runs included.
        storage: URL of the database; SQLite in `out` by default.
        name: of the study; the sweep's by default.
        batch: designs asked for and evaluated at a time; a killed run repeats at most those.
        executor: evaluates on other processes or machines; this process by default.
        threads: of each simulation.
        progress: show a bar.

    Returns:
        The study. Each trial has all that was measured as the attribute `row`; failed ones say why.

    Raises:
        InputError: the database refuses, or a policy does not fit.
        OutputError: the folder holds something else, or the database another search under this
            name.
    """
    import optuna
    from tqdm import tqdm

    folder = Path(out)
    _check(folder)
    if not storage:  # the database lies in the folder
        _make(folder)
    url = storage or f"sqlite:///{(folder / DATABASE).resolve()}"
    study = open_study(
        url,
        name or search.sweep.name,
        objectives=search.objectives,
        directions=search.directions,
        seed=search.sweep.seed,
        digest=search.digest(),
        remedies=_remedies(search),
    )
    _make(folder)
    owner = owner_of(folder)
    done = (optuna.trial.TrialState.COMPLETE, optuna.trial.TrialState.FAIL)
    with clear_errors(url):
        take_up(study, owner)
        finished = len(study.get_trials(deepcopy=False, states=done))
        with tqdm(
            total=trials, initial=min(finished, trials), disable=not progress, unit="design"
        ) as bar:
            while finished < trials:
                asked = [study.ask() for _ in range(min(batch, trials - finished))]
                for trial in asked:
                    trial.set_user_attr(OWN, owner)
                _evaluate(search, study, asked, executor, threads)
                before = finished
                finished = len(study.get_trials(deepcopy=False, states=done))
                bar.update(finished - before)
    return study


def _remedies(search: Search) -> dict[str, str]:
    """How a search goes on that was begun with the usual constraints of earlier versions."""
    bounds = earlier_constraints(search.protocols)
    options = " ".join(f"--constraint '{bound.text}'" for bound in bounds)
    earlier = dataclasses.replace(search, constraints=bounds).digest()
    return {
        earlier: "was begun with the constraints that were usual then, on falls rather than "
        f"arrivals; go on with them by {options}, or choose another --name"
    }


def _check(folder: Path) -> None:
    """Refuse a folder that holds anything but a search; older ones have no marker."""
    if (folder / OWNER).is_file():
        return
    folder = check_output_folder(folder)
    if folder.is_dir() and {entry.name for entry in folder.iterdir()} - {MARKER, DATABASE}:
        raise OutputError(
            f"{folder}: holds a result of hyperleg that is no search; choose an empty or new folder"
        )


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / MARKER).touch()
    except OSError as error:
        raise OutputError(
            f"{folder}: cannot be made ({error.strerror}); choose another --out"
        ) from None


def _suggested(search: Search, trial: optuna.Trial) -> tuple[str, dict[str, Any]]:
    """Variant and value of each axis."""
    values: dict[str, Any] = {}
    for axis in search.sweep.axes:
        values[axis.name] = (
            trial.suggest_categorical(axis.name, list(axis.levels))
            if axis.levels
            else trial.suggest_float(axis.name, axis.low, axis.high, log=axis.log)
        )
    variants = search.sweep.variants
    variant = trial.suggest_categorical(VARIANT, variants) if len(variants) > 1 else variants[0]
    return str(variant), values


def _evaluate(
    search: Search,
    study: optuna.Study,
    asked: list[optuna.Trial],
    executor: Executor | None,
    threads: int | None,
) -> None:
    """Evaluate what was asked for, and tell."""
    import pandas as pd

    sweep = search.sweep
    points = [_suggested(search, trial) for trial in asked]
    rows: dict[int, dict[str, Any]] = {}
    reasons: dict[int, str] = {}
    jobs: list[tuple[int, tuple[Any, ...]]] = []
    for variant in sweep.variants:
        own = [i for i, (v, _) in enumerate(points) if v == variant]
        if not own:
            continue
        values = {a.name: np.array([points[i][1][a.name] for i in own]) for a in sweep.axes}
        numbers, refused = evaluate_samples(sweep, values, variant)
        columns = measures.columns(sweep.measures, sweep.base)
        for k, i in enumerate(own):
            rows[i] = {"sample": asked[i].number, "variant": variant, **points[i][1]}
            rows[i] |= dict(zip(columns, numbers[:, k].tolist(), strict=True))
            if refused[k]:
                reasons[i] = str(refused[k])
        good = [k for k in range(len(own)) if not refused[k]]
        samples = np.array([asked[own[k]].number for k in good])
        accepted = {name: column[good] for name, column in values.items()}
        for protocol in search.plan.protocols if good else ():
            for policy in search.plan.policies[kind_of(protocol), variant]:
                job = (
                    sweep,
                    variant,
                    accepted,
                    samples,
                    protocol_mapping(protocol),
                    policy.path,
                    threads,
                )
                jobs.append((len(jobs), job))
    parts = dict(completed(evaluate_values, jobs, executor))
    measured: dict[int, dict[str, Any]] = {}
    if parts:
        trials = pd.concat([parts[k] for k in sorted(parts)], ignore_index=True)
        whole = pd.DataFrame([rows[i] for i in sorted(rows)])
        designs = design_table(sweep, trials, {str(c): whole[c].to_numpy() for c in whole})
        for row in designs.to_dict("records"):
            measured[int(row["sample"])] = {str(k): v for k, v in row.items()}
    for i, trial in enumerate(asked):
        _tell(search, study, trial, rows[i] | measured.get(trial.number, {}), reasons.get(i, ""))


def _tell(
    search: Search, study: optuna.Study, trial: optuna.Trial, row: dict[str, Any], reason: str
) -> None:
    import optuna

    trial.set_user_attr(ROW, plain(row))
    values = [float(row.get(name, np.nan)) for name in search.objectives]
    violations: dict[str, float] = {}  # the largest, where a measure has several bounds
    for constraint in search.constraints:
        violation = constraint.violation(float(row.get(constraint.name, np.nan)))
        violations[constraint.name] = max(violation, violations.get(constraint.name, -np.inf))
    for measure, violation in violations.items():
        trial.set_constraint(measure, min(violation, 1e6))
    refused = reason or next((str(row[k]) for k in row if k.endswith(".reason") and row[k]), "")
    if not refused and not np.isfinite(values).all():
        lost = [n for n, v in zip(search.objectives, values, strict=True) if not np.isfinite(v)]
        refused = f"gives no number for {', '.join(lost)}"
    if refused:
        trial.set_user_attr(REASON, refused)
        study.tell(trial, state=optuna.trial.TrialState.FAIL)
    else:
        study.tell(trial, values)


def found_designs(search: Search, study: optuna.Study) -> list[dict[str, Any]]:
    """The trials on the study's Pareto front that hold all constraints, by their first objective.

    Args:
        search: what was searched.
        study: its trials.

    Returns:
        Their `row`s. They are candidates: their policies were trained on other designs unless the
        row's `PROTOCOL.trained` says specialist.
    """
    rows = [trial.user_attrs[ROW] for trial in study.best_trials]
    first, reverse = search.objectives[0], search.directions[0] == "maximize"
    return sorted(rows, key=lambda row: row[first], reverse=reverse)
