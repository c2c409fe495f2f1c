"""Our measures beside the numbers that the paper prints for its two robots, a verdict each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import resampling, statistics
from hyperleg_design.evaluation.paper import Printed
from hyperleg_design.evaluation.result import arrivals_only, by_checkpoint
from hyperleg_design.evaluation.statistics import (
    AGREES,
    DIFFERS,
    TOO_FEW_SEEDS,
    Difference,
    Estimate,
)

if TYPE_CHECKING:
    import pandas as pd

NOT_REPRODUCED = "cannot be reproduced"
VARIANTS = ("toe", "toe_removed_matched")
"""What stands for the paper's two robots; the ratios of Table III fit equal mass best."""


@dataclass(frozen=True)
class PaperRow:
    """One printed number beside ours."""

    printed: Printed
    toe: Estimate
    """Ours with the active toe."""
    ablation: Estimate
    """Ours without."""
    difference: Difference
    """Ours, toe less ablation."""
    toe_verdict: str
    """`AGREES` where the printed number lies in our interval, `DIFFERS`, `TOO_FEW_SEEDS`, or
    `NOT_REPRODUCED`."""
    ablation_verdict: str
    """Verdict on the value without the toe."""
    change_verdict: str
    """Verdict of `change_verdict` on the relative change between the two."""
    why: str
    """Why it differs or cannot be reproduced, where that is known."""


def paper_rows(
    table: pd.DataFrame,
    printed: Sequence[Printed],
    variants: tuple[str, str] = VARIANTS,
    *,
    seed: int = 0,
) -> list[PaperRow]:
    """Put measured numbers beside those that the paper prints, which are of complete courses.

    A trial that did not arrive gives no value: its power is that of a fall.

    Args:
        table: of trials, as `result.trial_table` gives it; rows of one protocol.
        printed: such as `paper.TABLE_THREE`.
        variants: with the toe and without it.
        seed: of the bootstrap.

    Returns:
        One row for each printed number.

    Raises:
        InputError: a variant without trials, or a measure that the table does not have.
    """
    parts = {}
    for variant in variants:
        part = table[table["variant"] == variant]
        if part.empty:
            raise InputError(
                "comparison",
                "variant",
                variant,
                f"has no trials; there are {', '.join(sorted(set(table['variant'])))}",
            )
        measures = (item.measure for item in printed if item.measure in part)
        parts[variant] = arrivals_only(part, *measures)
    return [
        _row(
            item,
            {v: list(by_checkpoint(part, item.measure).values()) for v, part in parts.items()},
            variants,
            seed,
        )
        for item in printed
    ]


def _row(
    item: Printed, groups: Mapping[str, resampling.Groups], variants: tuple[str, str], seed: int
) -> PaperRow:
    toe, ablation = (statistics.estimate(groups[v], seed=seed) for v in variants)
    difference = statistics.difference(groups[variants[0]], groups[variants[1]], seed=seed)
    verdicts = [
        _plain(toe.against(item.toe)),
        _plain(ablation.against(item.ablation)),
        change_verdict(difference, item.change),
    ]
    lost = [
        f"{e.missing} of {e.missing + e.trials} trials of {v} gave no value"
        for e, v in zip((toe, ablation), variants, strict=True)
        if e.missing
    ]
    why = "; ".join([*lost, *([item.caveat] if item.caveat and set(verdicts) != {AGREES} else [])])
    return PaperRow(item, toe, ablation, difference, verdicts[0], verdicts[1], verdicts[2], why)


def change_verdict(difference: Difference, change: float) -> str:
    """Compare a measured difference with a relative change that the paper prints.

    The two agree if the printed change lies inside our interval and this interval leaves out zero.
    If zero lies inside, too, our result can be told neither from the printed change nor from no
    change.

    Args:
        difference: as measured.
        change: as printed, relative [-].

    Returns:
        The verdict.
    """
    if difference.verdict in (statistics.NOTHING_MEASURED, TOO_FEW_SEEDS):
        return _plain(difference.verdict)
    if not difference.relative_low <= change <= difference.relative_high:
        return DIFFERS
    return (
        statistics.NOT_TOLD_APART
        if difference.relative_low <= 0 <= difference.relative_high
        else AGREES
    )


def _plain(verdict: str) -> str:
    return NOT_REPRODUCED if verdict == statistics.NOTHING_MEASURED else verdict
