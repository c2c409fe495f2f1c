"""A finished sweep in short: counts, ranges of the measures, Pareto fronts."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from hyperleg_design.sweep import table
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.pareto import nondominated
from hyperleg_design.sweep.spaces.definition import Sweep

_SHOWN_REASONS = 10
_SHOWN_FRONT = 200
"""Designs of a front that the summary names; the table has all."""


def summarise(sweep: Sweep, path: Path) -> dict[str, Any]:
    """Summarise the table of a finished sweep.

    Args:
        sweep: the definition.
        path: of the finished table.

    Returns:
        `description`, `seed`, `sampling`, `samples`, `designs`, `rejected`, `rejected_because`
        (counts by reason), `base` (measures of the unchanged design, by variant), `range` (by
        variant and measure: smallest, median, largest) and, where the sweep has objectives, `front`
        (by variant: `designs` on it, and the numbers of the first samples). Measures that a variant
        lacks are left out.
    """
    head = table.read(path, ["sample", "variant", "rejected"])
    variant, rejected = head["variant"], head["rejected"] != ""
    reasons = Counter(map(str, head["rejected"][rejected]))
    summary: dict[str, Any] = {
        "description": sweep.description,
        "seed": sweep.seed,
        "sampling": sweep.sampling,
        "samples": sweep.count,
        "designs": len(variant),
        "rejected": int(rejected.sum()),
        "rejected_because": dict(reasons.most_common(_SHOWN_REASONS)),
        "variants": list(sweep.variants),
        "objectives": {c: measures.measure_of(c).better for c in sweep.objectives},
        "base": {name: base_values(sweep, name) for name in sweep.variants},
        "range": {name: {} for name in sweep.variants},
    }
    # one at a time, to hold little in memory
    for column in measures.columns(sweep.measures, sweep.base):
        values = table.read(path, [column])[column]
        for name in sweep.variants:
            real = values[(variant == name) & ~np.isnan(values)]
            if real.size:
                summary["range"][name][column] = [
                    float(v) for v in (real.min(), np.median(real), real.max())
                ]
    if sweep.objectives:
        summary["front"] = {}
        columns = table.read(path, list(sweep.objectives))
        values = np.stack([columns[c] for c in sweep.objectives], -1)
        for name in sweep.variants:
            rows = np.flatnonzero(variant == name)
            front = rows[
                nondominated(
                    values[rows], [measures.measure_of(c).better for c in sweep.objectives]
                )
            ]
            summary["front"][name] = {
                "designs": int(front.size),
                "samples": head["sample"][front[:_SHOWN_FRONT]].tolist(),
            }
    return summary


def base_values(sweep: Sweep, variant: str) -> dict[str, float]:
    """Compute the measures of the sweep's unchanged design as one variant.

    Args:
        sweep: the definition.
        variant: name of the ablation.

    Returns:
        Values by column; measures that the variant lacks are left out.
    """
    values = measures.evaluate(sweep.ablated(sweep.base, variant), sweep.measures)
    return {column: float(v[0]) for column, v in values.items() if np.isfinite(v[0])}
