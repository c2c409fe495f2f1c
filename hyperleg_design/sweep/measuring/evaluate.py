"""Measures of a stretch of a sweep's samples; samples that make no design are told apart, not
dropped.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.spaces.definition import Sweep

Columns = dict[str, np.ndarray]
"""Columns of a table by name, equally long."""


def evaluate_range(
    sweep: Sweep, start: int, stop: int, samples: Mapping[str, np.ndarray] | None = None
) -> Columns:
    """Rows of the samples `start .. stop`, each sample once a variant.

    Args:
        sweep: the definition.
        start: first sample.
        stop: one past the last.
        samples: `sweep.samples()`, where that is at hand.

    Returns:
        `sample`, `variant`, an axis a column, `rejected` (why a sample makes no design; empty where
        it does), and the measures (nan where rejected).
    """
    samples = sweep.samples() if samples is None else samples
    part = {name: values[start:stop] for name, values in samples.items()}
    count, variants = stop - start, len(sweep.variants)
    names = measures.columns(sweep.measures, sweep.base)
    values = np.full((len(names), count, variants), np.nan)
    reasons = np.full((count, variants), "", dtype=object)
    for column, variant in enumerate(sweep.variants):
        values[:, :, column], reasons[:, column] = evaluate_samples(sweep, part, variant)
    columns: Columns = {
        "sample": np.repeat(np.arange(start, stop), variants),
        "variant": np.tile(np.asarray(sweep.variants, dtype=object), count),
    }
    columns |= {name: np.repeat(axis, variants) for name, axis in part.items()}
    columns["rejected"] = reasons.ravel()
    return columns | {name: values[i].ravel() for i, name in enumerate(names)}


def evaluate_samples(
    sweep: Sweep, samples: Mapping[str, np.ndarray], variant: str
) -> tuple[np.ndarray, np.ndarray]:
    """Compute the measures of some samples as one variant.

    A batch that holds an impossible design is refused as a whole. The error says which ones are
    impossible, and the others are tried again; where it does not, the batch is halved until those
    stand alone.

    Args:
        sweep: the definition.
        samples: values by axis, `(n,)` each.
        variant: ablation that all samples become.

    Returns:
        Measures `(columns, n)`, and reasons of rejection `(n,)`, empty where there is none.
    """
    count = len(next(iter(samples.values())))
    names = measures.columns(sweep.measures, sweep.base)
    values = np.full((len(names), count), np.nan)
    reasons = np.full(count, "", dtype=object)
    waiting = [np.arange(count)]
    while waiting:
        rows = waiting.pop()
        try:
            design = sweep.design({name: v[rows] for name, v in samples.items()}, variant)
            measured = measures.evaluate(design, sweep.measures)
        except InputError as error:
            bad = np.ones(1, bool) if len(rows) == 1 else _refused(error, len(rows))
            if bad is None:
                waiting += np.array_split(rows, 2)
            else:
                reasons[rows[bad]] = f"{error.field}: {error.remedy}"
                if not bad.all():
                    waiting.append(rows[~bad])
            continue
        values[:, rows] = [measured[name] for name in names]
    return values, reasons


def _refused(error: InputError, count: int) -> np.ndarray | None:
    """Find the designs of a batch that an error refuses, at least one; None where the error does
    not name any.
    """
    if (
        error.bad is None
        or np.shape(error.bad) not in ((), (1,), (count,))
        or not np.any(error.bad)
    ):
        return None
    return np.array(np.broadcast_to(error.bad, (count,)))
