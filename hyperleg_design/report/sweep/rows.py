"""Rows of the fronts of a sweep, and levels of its unchanged design."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.evaluate import Columns
from hyperleg_design.sweep.pareto import nondominated
from hyperleg_design.sweep.run import SweepResult
from hyperleg_design.sweep.spaces.axis import Axis
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED, Sweep


def fronts_of(result: SweepResult) -> tuple[Columns, dict[str, np.ndarray]]:
    """Find the Pareto front of each variant; variants that lack an objective are left out.

    Args:
        result: the finished sweep.

    Returns:
        The table, and the indices of the rows on each variant's front.

    Raises:
        InputError: no design has all objectives.
    """
    sweep = result.sweep
    table = result.columns(["variant", *(axis.name for axis in sweep.axes), *sweep.objectives])
    values = np.stack([table[c] for c in sweep.objectives], -1)
    better = [measures.measure_of(c).better for c in sweep.objectives]
    fronts = {}
    for variant in sweep.variants:
        rows = np.flatnonzero(table["variant"] == variant)
        front = rows[nondominated(values[rows], better)]
        if front.size:
            fronts[variant] = front
    if not fronts:
        raise InputError(
            sweep.source, "objectives", list(sweep.objectives), "no design has all of them"
        )
    return table, fronts


def thinned(count: int, most: int) -> np.ndarray:
    """Choose evenly spread positions.

    Args:
        count: number of positions.
        most: how many are chosen at most.

    Returns:
        Their indices.
    """
    return np.arange(count) if count <= most else np.linspace(0, count - 1, most).astype(int)


def base_value(axis: Axis, sweep: Sweep) -> Any:
    """Look up where the unchanged design lies on an axis; 1 for an axis of factors.

    Args:
        axis: of the sweep.
        sweep: the definition.

    Returns:
        The value.
    """
    return 1.0 if axis.scaled else sweep.base[axis.paths[0]]


def base_level(axis: Axis, sweep: Sweep) -> Any:
    """Find the level of a grid's axis that is nearest to the unchanged design.

    Args:
        axis: of the sweep.
        sweep: the definition.

    Returns:
        The level.
    """
    value = base_value(axis, sweep)
    if not axis.numeric:
        return value if value in axis.levels else axis.levels[0]
    return min(axis.levels, key=lambda level: abs(level - value))


def without_variants(
    heads: Sequence[str], rows: Sequence[Sequence[Any]]
) -> tuple[list[str], list[list[Any]]]:
    """Leave the column `variant` out of a table of designs that have none.

    Args:
        heads: of the columns, `variant` among them.
        rows: of cells.

    Returns:
        Heads and rows.
    """
    place = heads.index("variant")
    if any(row[place] != AS_DESCRIBED for row in rows):
        return list(heads), [list(row) for row in rows]
    return _without(heads, place), [_without(row, place) for row in rows]


def _without(cells: Sequence[Any], place: int) -> list[Any]:
    return [*cells[:place], *cells[place + 1 :]]
