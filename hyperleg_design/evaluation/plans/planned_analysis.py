"""The analysis that a plan wrote down, on the trials that there are.

One training is one observation: the mean over its policies of their means over trials. Arms are
compared by Welch's t test on these means, so interval, p value, equivalence and smallest detectable
difference of a row all rest on the same standard error. Measures of trials that arrived leave the
others out, and say how many; measures of all trials leave out only what a trial could not give.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.plans import planned_tests
from hyperleg_design.evaluation.result import arrivals_only, by_checkpoint
from hyperleg_design.evaluation.statistics import FEWEST_SEEDS

if TYPE_CHECKING:
    import pandas as pd

    from hyperleg_design.evaluation.plans.analysis_plan import AnalysisPlan, Outcome

DIFFERENT, EQUIVALENT, UNDECIDED = "different", "equivalent", "undecided"
TOO_FEW, NOT_MEASURED = "too few trainings", "not measured"
VERDICTS = (DIFFERENT, EQUIVALENT, UNDECIDED, TOO_FEW, NOT_MEASURED)
"""What a row can say."""


@dataclass(frozen=True)
class PlannedRow:
    """One outcome of a plan; relative numbers are over the magnitude of the compared arm's mean."""

    outcome: Outcome
    primary: bool
    active: float
    """Mean of the active arm's trainings."""
    compared: float
    """Mean of the compared arm's trainings."""
    trainings: tuple[int, int]
    """With a value, of both arms."""
    missing: tuple[int, int]
    """Trials without a value, or left out because they did not arrive, of both arms."""
    change: float
    """Active less compared, relative [-]."""
    low: float
    """Lower end of its interval of 1 - level, relative [-]."""
    high: float
    """Upper end of its interval of 1 - level, relative [-]."""
    p_value: float
    """Two-sided, before correction."""
    corrected: float
    """Corrected by Holm's method within the secondary outcomes; as it is for a primary one."""
    detectable: float
    """Smallest relative difference that the test would have found with the plan's power [-]."""
    verdict: str
    """One of `VERDICTS`; `EQUIVALENT` only where the plan states a margin."""


def training_means(
    table: pd.DataFrame, design: str, measure: str, trials: str
) -> tuple[np.ndarray, int]:
    """Mean of each training of a design.

    Args:
        table: of `result.trial_table`, `variant` and `seed` as the trainings' folders say.
        design: arm.
        measure: column.
        trials: `arrived` to leave other trials out, or `all`.

    Returns:
        Means over the policies of their trials' means `(n,)`, of trainings that have any; and the
        number of trials without a value.
    """
    part = table[table["variant"] == design]
    if not len(part) or measure not in part:
        return np.empty(0), 0
    values = arrivals_only(part, measure) if trials == "arrived" else part
    seeds = [
        [own[~np.isnan(own)] for own in policies]
        for policies in by_checkpoint(values, measure).values()
    ]
    means = [
        np.mean([own.mean() for own in some if len(own)]) for some in seeds if any(map(len, some))
    ]
    return np.array(means), int(values[measure].isna().sum())


def planned_analysis(
    plan: AnalysisPlan, tables: Mapping[str, pd.DataFrame | None]
) -> list[PlannedRow]:
    """Analyse all outcomes of a plan: the primary ones, then the secondary ones with Holm's
    correction.

    Args:
        plan: what is compared.
        tables: trials by protocol, `walk` and `t_test`; None or missing where there are none, whose
            outcomes are rows that say so and still count in the correction.

    Returns:
        One row for each outcome, in the order of the plan.
    """
    primary = [_row(plan, outcome, tables, plan.level, True) for outcome in plan.primary]
    strictest = plan.level / max(len(plan.secondary), 1)
    rows = [_row(plan, outcome, tables, strictest, False) for outcome in plan.secondary]
    corrected = planned_tests.holm([row.p_value for row in rows])
    for i, (row, value) in enumerate(zip(rows, corrected, strict=True)):
        verdict = row.verdict
        if verdict == UNDECIDED and value < plan.level:
            verdict = DIFFERENT
        rows[i] = dataclasses.replace(row, corrected=float(value), verdict=verdict)
    return [*primary, *rows]


def _row(
    plan: AnalysisPlan,
    outcome: Outcome,
    tables: Mapping[str, pd.DataFrame | None],
    level: float,
    primary: bool,
) -> PlannedRow:
    """A row; `level` is that of the smallest detectable difference."""
    table = tables.get(outcome.protocol)
    (x, missing_x), (y, missing_y) = (
        (np.empty(0), 0)
        if table is None
        else training_means(table, design, outcome.measure, outcome.trials)
        for design in (plan.active, plan.compared)
    )
    mean, error, freedom = welch(x, y)
    base = float(y.mean()) if len(y) else np.nan
    scale = abs(base) if base else np.nan
    p = planned_tests.p_value(mean, error, freedom)
    reach = planned_tests.interval_reach(error, freedom, plan.level)
    if not len(x) or not len(y):
        verdict = NOT_MEASURED
    elif min(len(x), len(y)) < FEWEST_SEEDS or not np.isfinite(p):
        verdict = TOO_FEW
    elif primary and p < plan.level:
        verdict = DIFFERENT
    elif primary and planned_tests.equivalent(
        mean, error, freedom, outcome.margin * scale, plan.level
    ):
        verdict = EQUIVALENT
    else:
        verdict = UNDECIDED
    return PlannedRow(
        outcome=outcome,
        primary=primary,
        active=float(x.mean()) if len(x) else np.nan,
        compared=base,
        trainings=(len(x), len(y)),
        missing=(missing_x, missing_y),
        change=mean / scale,
        low=(mean - reach) / scale,
        high=(mean + reach) / scale,
        p_value=p,
        corrected=p,
        detectable=planned_tests.smallest_detectable(error, freedom, level, plan.power) / scale,
        verdict=verdict,
    )


def welch(
    first: Sequence[float] | np.ndarray, second: Sequence[float] | np.ndarray
) -> tuple[float, float, int]:
    """Compare two means by Welch's method.

    Args:
        first: values of one side, `(n,)`.
        second: values of the other side, `(m,)`.

    Returns:
        Difference of the means, its standard error, and Welch's degrees of freedom rounded down.
        The standard error is NaN and the degrees of freedom are zero if a side has fewer than two
        values.
    """
    x, y = np.asarray(first, float), np.asarray(second, float)
    mean = float(x.mean() - y.mean()) if len(x) and len(y) else np.nan
    if min(len(x), len(y)) < 2:
        return mean, np.nan, 0
    a, b = x.var(ddof=1) / len(x), y.var(ddof=1) / len(y)
    if a + b == 0:
        return mean, 0.0, len(x) + len(y) - 2
    freedom = (a + b) ** 2 / (a**2 / (len(x) - 1) + b**2 / (len(y) - 1))
    return mean, float(np.sqrt(a + b)), int(freedom + 1e-9)
