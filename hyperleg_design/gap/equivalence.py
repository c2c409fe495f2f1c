"""Causes that data cannot tell apart: rivals that predict held-out data alike, or leave traces alike beside the calibration errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from hyperleg_design.gap.base import Base
    from hyperleg_design.gap.judge import Judge, Model


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
        behind = _score(chosen) - _score(model)
        short = best - judge.closed(model.held, rows, chosen.held)
        difference = chosen.held.likelihood - model.held.likelihood
        doubtful = behind < 1.5 * float(np.sqrt(len(difference)) * difference.std())
        if (behind < rules.alike or (doubtful and behind < 3 * rules.alike)) and short < rules.alike_closed:
            found.append(model)
    return sorted(found, key=lambda m: (-m.gain, m.names))


def _score(model: Model) -> float:
    from hyperleg_design.gap.judge import plausible

    return model.gain + plausible(model)


def sine(base: Base, weight: np.ndarray, one: np.ndarray, other: np.ndarray) -> float:
    """Sine of the smallest angle between two blocks of traces, calibration errors taken out of both: 0 alike, 1 nothing in common.

    Args:
        base: residual and calibration errors.
        weight: of the groups `(G,)`.
        one: traces `(k, S)`, weighted.
        other: traces `(l, S)`, weighted.
    """
    root = np.sqrt(weight)[base.samples.group]
    errors = base.errors * root
    normal = errors @ errors.T + np.eye(len(errors))
    blocks = []
    for columns in (one * root, other * root):
        left = columns - (np.linalg.solve(normal, errors @ columns.T)).T @ errors
        q, r = np.linalg.qr(left.T)
        size = np.abs(np.diag(r))
        blocks.append(q[:, size > 1e-9 * max(float(size.max(initial=0.0)), 1e-300)])
    if not blocks[0].shape[1] or not blocks[1].shape[1]:
        return 1.0
    cosine = float(np.linalg.svd(blocks[0].T @ blocks[1], compute_uv=False)[0])
    return float(np.sqrt(max(1 - min(cosine, 1.0) ** 2, 0.0)))
