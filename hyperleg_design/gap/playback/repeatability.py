"""How large residuals are when nothing is wrong: from references, repeats or a log's own split."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from hyperleg_design.gap.playback.sheets import Sheet, regime_names, regime_values, root_mean_square
from hyperleg_design.gap.signals.signals import Signals

SAME_TARGET = 0.002
"""Root-mean-square difference of targets up to which two logs are repeats [rad]."""


def repeatability_floors(
    signals: Sequence[Signals],
    sheets: Sequence[dict[tuple[str, str], Sheet]],
    reference: Sequence[dict[tuple[str, str], Sheet]],
) -> tuple[dict[tuple[str, str, str], np.ndarray], str]:
    """Compute the size that residuals have when nothing is wrong.

    Args:
        signals: the conditioned logs.
        sheets: their residuals by signal and kind of place.
        reference: the same of reference logs; empty where there are none.

    Returns:
        Root-mean-square floors by signal, kind of place and regime `(k,)`, where `all` stands in
        for regimes that are missing; and where they come from: `reference`, `repeats` or `split`.
    """
    if reference:
        return _pooled_floors(reference), "reference"
    repeats = _repeats(signals, sheets)
    if repeats:
        return repeats, "repeats"
    floors = {}
    for key in dict.fromkeys(k for each in sheets for k in each):
        own = [each[key].floor for each in sheets if key in each]
        floors[(*key, "all")] = np.sqrt(np.mean(np.square(own), 0))
    return floors, "split"


def _pooled_floors(
    sheets: Iterable[dict[tuple[str, str], Sheet]],
) -> dict[tuple[str, str, str], np.ndarray]:
    groups: dict[tuple[str, str], list[Sheet]] = {}
    for each in sheets:
        for key, sheet in each.items():
            groups.setdefault(key, []).append(sheet)
    floors = {}
    for key, group in groups.items():
        for regime in regime_names(group):
            floors[(*key, regime)] = root_mean_square(
                np.concatenate([regime_values(sheet, regime) for sheet in group])
            )
    return floors


def _repeats(
    signals: Sequence[Signals], sheets: Sequence[dict[tuple[str, str], Sheet]]
) -> dict[tuple[str, str, str], np.ndarray]:
    """Root of half of the mean square difference between logs that follow the same targets from
    their first tick on, by signal, kind of place and regime.
    """
    differences: dict[tuple[str, str, str], list[np.ndarray]] = {}
    for i, first in enumerate(signals):
        for j in range(i + 1, len(signals)):
            second = signals[j]
            length = min(len(first.time), len(second.time))
            if (
                first.target is None
                or second.target is None
                or not np.isclose(first.step, second.step, rtol=0.01)
                or first.target.shape[1] != second.target.shape[1]
            ):
                continue
            if length < 0.8 * max(len(first.time), len(second.time)):
                continue
            apart = first.target[:length] - second.target[:length]
            if not np.sqrt(np.nanmean(apart**2)) < SAME_TARGET:
                continue
            for key in sheets[i].keys() & sheets[j].keys():
                difference = (
                    sheets[i][key].residual[:length] - sheets[j][key].residual[:length]
                ) / np.sqrt(2)
                differences.setdefault((*key, "all"), []).append(difference)
                for regime, inside in sheets[i][key].regimes.items():
                    differences.setdefault((*key, regime), []).append(
                        np.where(inside[:length], difference, np.nan)
                    )
    return {key: root_mean_square(np.concatenate(parts)) for key, parts in differences.items()}
