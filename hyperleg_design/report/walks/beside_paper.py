"""Rows beside the paper and differences with their intervals, as cells and tables of a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from hyperleg_design.evaluation import paper, statistics
from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.plans.analysis_plan import ONLY_COMPLETE, counted
from hyperleg_design.evaluation.result import by_checkpoint
from hyperleg_design.evaluation.statistics import AGREES, DIFFERS, Estimate
from hyperleg_design.evaluation.versus_paper import NOT_REPRODUCED, VARIANTS, PaperRow, paper_rows
from hyperleg_design.report.page import Cell, Details, Table
from hyperleg_design.report.walks.evaluated import T_TEST, WALK, Evaluated
from hyperleg_design.writing import plain

SUMMARY = {
    WALK: (
        "power",
        "joule_power",
        "mechanical_power",
        "battery_power",
        "cost_of_transport",
        "steady_cost_of_transport",
        "steady_battery_cost_of_transport",
        "time",
        "steady_speed",
        "grf_peak",
        "grf_loading_rate",
        "grf_impulse",
        "cadence",
        "step_length",
        "duty_factor",
        "double_support",
        "slip_per_step",
        "foot_drift",
        "thermal_peak",
        "limit_share",
    ),
    T_TEST: (
        "time",
        "mean_speed",
        "peak_speed",
        "mean_deviation",
        "peak_deviation",
        "mean_leg_deviation",
        "peak_leg_deviation",
        "energy",
        "power",
        "cost_of_transport",
        "grf_peak",
        "slip_per_step",
        "thermal_peak",
        "limit_share",
    ),
}
"""Measures of the table of differences, by kind of protocol."""
_MARK = {AGREES: "good", DIFFERS: "bad", statistics.NOT_TOLD_APART: "note", NOT_REPRODUCED: "bad"}
_ONE_SEED = "Rests on fewer than three trainings a side, so it tells nothing about the toe."


def rows_beside_paper(evaluated: Evaluated) -> dict[str, list[PaperRow]]:
    """Put every printed number beside ours, by table and group; groups that lack one of the paper's
    two robots are left out.

    Args:
        evaluated: the policies with their trials.

    Returns:
        Rows by table and group.
    """
    rows_by_table = {}
    for kind, place, printed in (
        (WALK, "Table III", (*paper.TABLE_THREE, *paper.RIGHT_LEG_POWER)),
        (T_TEST, "Table IV", paper.TABLE_FOUR),
    ):
        for group in evaluated.groups(kind):
            if set(VARIANTS) <= set(evaluated.designs(group)):
                rows_by_table[f"{place}, {group}"] = paper_rows(evaluated.table(group), printed)
    return rows_by_table


def row_facts(row: PaperRow) -> dict[str, Any]:
    """Write a row as plain numbers and texts.

    Args:
        row: the row.

    Returns:
        Values by name, None where there is none.
    """

    def side(estimate: Estimate) -> dict[str, Any]:
        numbers = {
            "mean": plain(estimate.mean),
            "low": plain(estimate.low),
            "high": plain(estimate.high),
        }
        return {
            **numbers,
            "seeds": estimate.seeds,
            "trials": estimate.trials,
            "missing": estimate.missing,
        }

    return {
        "place": row.printed.place,
        "quantity": row.printed.quantity,
        "unit": row.printed.unit,
        "measure": row.printed.measure,
        "toe": {"paper": row.printed.toe, **side(row.toe), "verdict": row.toe_verdict},
        "ablation": {
            "paper": row.printed.ablation,
            **side(row.ablation),
            "verdict": row.ablation_verdict,
        },
        "change": {
            "paper": row.printed.change,
            "mean": plain(row.difference.relative),
            "low": plain(row.difference.relative_low),
            "high": plain(row.difference.relative_high),
            "verdict": row.change_verdict,
            "ours": row.difference.verdict,
            "hedges_g": plain(row.difference.hedges_g),
            "cliffs_delta": plain(row.difference.cliffs_delta),
        },
        "why": row.why,
    }


def beside(rows: Sequence[PaperRow], caption: str) -> list[Any]:
    """Tabulate printed numbers, ours and verdicts, and explain below why some differ.

    Args:
        rows: of one table and group.
        caption: of the table.

    Returns:
        Parts of a page.
    """
    cells: list[list[Any]] = []
    for row in rows:
        printed, change = row.printed, row.difference
        words = {"toe": row.toe_verdict, "ablation": row.ablation_verdict, "Δ": row.change_verdict}
        same = set(words.values())
        cells.append(
            [
                f"{printed.quantity} [{printed.unit}]" if printed.unit else printed.quantity,
                printed.toe,
                Cell(short(row.toe), _MARK.get(row.toe_verdict, "note")),
                printed.ablation,
                Cell(short(row.ablation), _MARK.get(row.ablation_verdict, "note")),
                f"{100 * printed.change:+.1f} %",
                Cell(
                    percent(change.relative, change.relative_low, change.relative_high),
                    _MARK.get(row.change_verdict, "note"),
                ),
                same.pop()
                if len(same) == 1
                else "; ".join(f"{side} {word}" for side, word in words.items()),
            ]
        )
    head = ["", "toe: paper", "ours", "ablation: paper", "ours", "Δ paper", "Δ ours", "verdict"]
    first = rows[0]
    trials = [side.trials + side.missing for side in (first.toe, first.ablation)]
    content: list[Any] = [
        Table(
            head,
            cells,
            f"{caption}: {first.toe.seeds} and {first.ablation.seeds} seeds, {trials[0]} and "
            f"{trials[1]} trials.",
        )
    ]
    reasons = [[row.printed.quantity, row.why] for row in rows if row.why]
    return (
        [
            *content,
            Details(
                "Why numbers differ or cannot be reproduced",
                [Table(["", "known reasons"], reasons)],
            ),
        ]
        if reasons
        else content
    )


def toe_sentence(rows: Sequence[PaperRow]) -> str:
    """State in one paragraph what can be concluded about the toe from a table.

    Args:
        rows: of the table.

    Returns:
        The paragraph.
    """
    if any(row.difference.verdict == statistics.TOO_FEW_SEEDS for row in rows):
        return _ONE_SEED
    different = [r for r in rows if r.difference.verdict == statistics.DIFFERS]
    same = [r.printed.quantity for r in rows if r.difference.verdict == statistics.NOT_TOLD_APART]
    parts_of = []
    if different:
        parts_of.append(
            "With the toe "
            + ", ".join(
                f"{r.printed.quantity} changes by {100 * r.difference.relative:+.1f} %"
                for r in different
            )
            + "."
        )
    if same:
        parts_of.append(f"Cannot be told apart: {', '.join(same)}.")
    return " ".join(parts_of)


def differences(evaluated: Evaluated, group: str, kind: str) -> Details:
    """Compare the toe with its ablation in many measures, unpaired and paired by seed.

    Args:
        evaluated: the policies with their trials.
        group: of trainings.
        kind: of protocol.

    Returns:
        A table that is folded away.
    """
    table = evaluated.table(group)
    rows = []
    for name in SUMMARY[kind]:
        if name not in table:
            continue
        some = counted(table, name)
        first, second = (by_checkpoint(some[some["variant"] == v], name) for v in VARIANTS)
        a, b = (statistics.estimate(list(side.values())) for side in (first, second))
        apart = statistics.difference(list(first.values()), list(second.values()))
        common = sorted(set(first) & set(second))
        paired = (
            statistics.difference(
                [first[s] for s in common], [second[s] for s in common], paired=True
            )
            if common
            else None
        )
        rows.append(
            [
                name.replace("_", " "),
                measure_of(name).unit,
                "arrived" if name in ONLY_COMPLETE else "all",
                short(a),
                short(b),
                percent(apart.relative, apart.relative_low, apart.relative_high),
                verdict(apart.verdict),
                percent(paired.relative, paired.relative_low, paired.relative_high)
                if paired
                else "–",
                verdict(paired.verdict) if paired else "–",
                apart.hedges_g,
                apart.cliffs_delta,
            ]
        )
    head = [
        "measure",
        "unit",
        "trials",
        "toe",
        "toe removed, equal mass",
        "Δ",
        "verdict",
        "Δ paired by seed",
        "verdict",
        "Hedges' g",
        "Cliff's δ",
    ]
    return Details(
        f"Differences in all measures, group {group}",
        [
            Table(
                head,
                rows,
                "Δ: toe less ablation, over the ablation. Trials: whether all count, or those that "
                "arrived, because a run that ends early gives no such number.",
            )
        ],
    )


def short(estimate: Estimate) -> str:
    """Write mean, interval over trainings where there are several, and how many trials gave no
    value.

    Args:
        estimate: the estimate.

    Returns:
        The text.
    """
    if not math.isfinite(estimate.mean):
        return "–"
    low = estimate.low if estimate.speaks_of_seeds else math.nan
    return interval(estimate.mean, low, estimate.high, "") + (
        f" ({estimate.missing} missing)" if estimate.missing else ""
    )


def interval(mean: float, low: float, high: float, unit: str) -> str:
    """Write a mean with its interval, where there is one.

    Args:
        mean: the mean.
        low: lower end of the interval.
        high: upper end of the interval.
        unit: of the numbers.

    Returns:
        The text.
    """
    if not math.isfinite(mean):
        return "–"
    text = (
        f"{_digits(mean)} [{_digits(low)}, {_digits(high)}]"
        if math.isfinite(low)
        else _digits(mean)
    )
    return f"{text} {unit}".rstrip()


def percent(mean: float, low: float, high: float) -> str:
    """Write a relative change with its interval, where there is one.

    Args:
        mean: the change [-].
        low: lower end of the interval.
        high: upper end of the interval.

    Returns:
        The text, in per cent.
    """
    if not math.isfinite(mean):
        return "–"
    return f"{100 * mean:+.1f} %" + (
        f" [{100 * low:+.1f}, {100 * high:+.1f}]" if math.isfinite(low) else ""
    )


def verdict(text: str) -> Any:
    """Mark a verdict as a cell of a table.

    Args:
        text: the verdict.

    Returns:
        The cell.
    """
    return Cell(text, _MARK.get(text, "note")) if text else "–"


def _digits(value: float) -> str:
    """Three significant digits, all before the point."""
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"
