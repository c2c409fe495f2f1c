"""Causes that data cannot tell apart: rivals that predict held-out data alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.inference.judge import rank

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.judge import Judge
    from hyperleg_design.gap.inference.model import Model


def alike(judge: Judge, slot: Sequence[Model], chosen: Model, rows: np.ndarray) -> list[Model]:
    """Rivals in one place of a model that these data do not tell from it, most likely first.

    Args:
        judge: of the models.
        slot: models that differ from the chosen one in one cause.
        chosen: what was chosen.
        rows: that count for the gap.
    """
    rules = judge.thresholds
    best = judge.closed(chosen.held, rows, chosen.held)
    found = []
    for model in slot:
        if model.names == chosen.names:
            continue
        behind = rank(chosen) - rank(model)
        short = best - judge.closed(model.held, rows, chosen.held)
        difference = chosen.held.likelihood - model.held.likelihood
        doubtful = behind < 1.5 * float(np.sqrt(len(difference)) * difference.std())
        if (
            behind < rules.alike or (doubtful and behind < 3 * rules.alike)
        ) and short < rules.alike_closed:
            found.append(model)
    return sorted(found, key=lambda m: (-rank(m), m.names))
