"""Evaluations as rows of estimates, for a terminal and for programs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from hyperleg_design.evaluation.measure_interval import measure_interval
from hyperleg_design.evaluation.measures import OUTCOMES, measure_of
from hyperleg_design.evaluation.result import by_checkpoint, counted
from hyperleg_design.evaluation.result_tables import trial_table
from hyperleg_design.evaluation.statistics import Estimate
from hyperleg_design.report.lacking_text import lacking_text
from hyperleg_design.report.text import table
from hyperleg_design.writing import plain

if TYPE_CHECKING:
    from hyperleg_design.evaluation.result import Evaluation

FIRST_READ = (
    "arrived",
    "fell",
    "time",
    "steady_speed",
    "mean_speed",
    "peak_speed",
    "mean_deviation",
    "peak_deviation",
    "steady_cost_of_transport",
    "cost_of_transport",
    "power",
    "joule_power",
    "grf_peak_body_weights",
    "cadence",
    "flight",
    "continuous_use",
)
"""Measures that a terminal shows at first, of walks and T-tests, in this order."""
OVERHEATS = (
    "continuous_use above 1: the motor used most gives more than its rated torque (RMS), and "
    "overheats where this goes on"
)
"""What a terminal says below a table in which a motor is used beyond its rated torque."""
HEAD = ("measure", "unit", "mean", "low", "high", "seeds", "missing")


def evaluation_rows(evaluations: Sequence[Evaluation]) -> list[dict[str, Any]]:
    """Summarise evaluations: the mean of every measure, with its interval over seeds and trials.

    Means are over the trials that did not fall, but for how trials ended; see `counted`.

    Args:
        evaluations: trials of one or more policies.

    Returns:
        One row for each protocol, variant, design and measure, with `variant`, `design`,
        `trained` (see `TrainingFit`), `protocol`, `measure`, `unit` (empty for a number without
        unit), `mean`, `low` and `high` (None where there is no interval), `seeds`, `trials`, and
        `missing`, the number of trials without a value, those that fell among them.
    """
    trials = trial_table(evaluations)
    rows = []
    keys = ["protocol", "variant", "design", "trained"]
    for (protocol, variant, design, trained), part in trials.groupby(keys, sort=False):
        first = next(e for e in evaluations if e.protocol.name == protocol)
        for measure in first.measures[0]:
            values = by_checkpoint(part.assign(**{measure: counted(part, measure)}), measure)
            interval = measure_interval(measure, list(values.values()))
            rows.append(
                {
                    "variant": str(variant),
                    "design": str(design),
                    "trained": str(trained),
                    "protocol": str(protocol),
                    "measure": measure,
                    "unit": measure_of(measure).unit,
                    **_plain(interval),
                }
            )
    return rows


def _plain(value: Estimate) -> dict[str, Any]:
    numbers = {k: getattr(value, k) for k in ("mean", "low", "high")}
    return {
        **plain(numbers),
        "seeds": value.seeds,
        "trials": value.trials,
        "missing": value.missing,
    }


def evaluation_text(rows: Sequence[dict[str, Any]], *, everything: bool = False) -> str:
    """Write the rows of `evaluation_rows` for a terminal: how trials ended, and a table for each
    protocol, variant and design.

    Measures that no trial has, such as those of a knee that a robot lacks, are only named below it,
    with the reason where it is known.

    Args:
        rows: one for each of these and each measure.
        everything: show every measure, not only those of `FIRST_READ`.

    Returns:
        The text.
    """
    groups: dict[tuple[str, ...], dict[str, dict[str, Any]]] = {}
    for row in rows:
        key = tuple(row[name] for name in ("variant", "trained", "protocol", "design"))
        groups.setdefault(key, {})[row["measure"]] = row
    texts = []
    for (variant, trained, protocol, design), own in groups.items():
        trials = next(iter(own.values()))
        ends = [
            f"{round(own[name]['mean'] * own[name]['trials'])} {name.replace('_', ' ')}"
            for name in OUTCOMES
            if name in own and (own[name]["mean"] or name in ("arrived", "fell"))
        ]
        count = f"{trials['trials'] + trials['missing']} trials"
        shown = list(own) if everything else [name for name in FIRST_READ if name in own]
        lacking = [name for name in shown if own[name]["mean"] is None]
        texts.append(
            f"{variant or design}, {trained}, {protocol}: {', '.join([count, *ends])}\n"
            + table(HEAD, [_cells(own[name]) for name in shown if name not in lacking])
        )
        if "continuous_use" in shown and (own["continuous_use"]["mean"] or 0.0) > 1.0:
            texts[-1] += f"\n{OVERHEATS}"
        if lacking:
            texts[-1] += f"\n{lacking_text(own, lacking)}"
        if len(shown) < len(own):
            texts[-1] += f"\n{len(own) - len(shown)} more measures with --all"
    return "\n\n".join(texts)


def _cells(row: dict[str, Any]) -> list[Any]:
    numbers = ["" if row[k] is None else row[k] for k in ("mean", "low", "high")]
    return [row["measure"], row["unit"] or "-", *numbers, row["seeds"], row["missing"]]
