"""Parallel coordinates of a sweep: a vertical line an axis or objective, a line across a design."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.report.style import figure_style, variant_colour
from hyperleg_design.report.sweep.rows import base_row, fronts_of, thinned, variant_title
from hyperleg_design.sweep import measures
from hyperleg_design.sweep.run import SweepResult
from hyperleg_design.sweep.space import Sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BACKGROUND_LINES = 300
_FRONT_LINES = 150
_INK = "#1d2129"


def parallel_figure(result: SweepResult) -> Figure:
    """Parallel coordinates of the front designs of all variants: axes first, then objectives, best
    at the top.

    Raises:
        InputError: the sweep has no objective.
    """
    sweep = result.sweep
    if not sweep.objectives:
        raise InputError(sweep.source, "objectives", [], "expects at least one measure")
    table, fronts = fronts_of(result)
    names = [*(axis.name for axis in sweep.axes), *sweep.objectives]
    good = np.all([~np.isnan(table[o]) for o in sweep.objectives], axis=0)
    rows = np.flatnonzero(good)
    with figure_style():
        import matplotlib.pyplot as plt
        from matplotlib.collections import LineCollection

        figure, panel = plt.subplots(figsize=(1.35 * len(names) + 2.0, 4.6), layout="constrained")
        scales = [_Scale.of(sweep, name, table[name][rows]) for name in names]
        height = np.stack(
            [scale.height(table[name]) for scale, name in zip(scales, names, strict=True)], -1
        )
        place = np.arange(len(names))

        def lines(chosen: np.ndarray, **look: Any) -> None:
            panel.add_collection(
                LineCollection([np.column_stack([place, height[i]]) for i in chosen], **look)
            )

        lines(
            rows[thinned(rows.size, _BACKGROUND_LINES)],
            colors="#c9ced6",
            linewidths=0.5,
            alpha=0.5,
            zorder=1,
        )
        for variant, front in fronts.items():
            lines(
                front[thinned(front.size, _FRONT_LINES)],
                colors=variant_colour(variant),
                linewidths=0.9,
                alpha=0.55,
                zorder=2,
            )
            panel.plot(
                [], [], color=variant_colour(variant), label=f"front, {variant_title(variant)}"
            )
        base = base_row(sweep)
        level = [
            scale.height(np.asarray([base[name]]))[0] if name in base else np.nan
            for scale, name in zip(scales, names, strict=True)
        ]
        panel.plot(place, level, color=_INK, linewidth=1.8, zorder=3, label="unchanged design")
        for x, scale in zip(place, scales, strict=True):
            panel.axvline(x, color="#6b7280", linewidth=0.8, zorder=0)
            for at, text in scale.ticks:
                panel.annotate(
                    text,
                    (x, at),
                    xytext=(3, 0),
                    textcoords="offset points",
                    fontsize=7.5,
                    va="center",
                    zorder=6,
                    bbox=_HALO,
                )
        panel.axvline(len(sweep.axes) - 0.5, color=_INK, linewidth=0.8, linestyle=":")
        panel.set_xticks(place, [scale.label for scale in scales], fontsize=8)
        panel.set(xlim=(-0.3, len(names) - 0.4), ylim=(-0.05, 1.05), yticks=[])
        panel.grid(False)
        panel.spines[["left", "bottom"]].set_visible(False)
        panel.tick_params(length=0)
        figure.legend(loc="outside upper center", ncols=len(fronts) + 1, fontsize=9)
        return figure


_HALO = {"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}


class _Scale:
    """Where values of one column stand between 0 and 1; an objective has its better end up."""

    def __init__(
        self, label: str, low: float, high: float, flip: bool, log: bool, texts: list[str] | None
    ) -> None:
        self.label, self._low, self._high, self._flip, self._log, self._texts = (
            label,
            low,
            high,
            flip,
            log,
            texts,
        )

    @classmethod
    def of(cls, sweep: Sweep, name: str, values: np.ndarray) -> _Scale:
        axis = next((a for a in sweep.axes if a.name == name), None)
        if axis is not None and not axis.numeric:
            texts = [str(v) for v in axis.levels]
            return cls(_wrapped(axis.label), 0.0, max(len(texts) - 1.0, 1.0), False, False, texts)
        if axis is not None:
            low, high = (
                (min(axis.levels), max(axis.levels)) if axis.levels else (axis.low, axis.high)
            )
            return cls(
                _wrapped(axis.label), low, high if high > low else low + 1.0, False, axis.log, None
            )
        low, high = float(values.min()), float(values.max())
        high = high if high > low else low + 1.0
        better = measures.measure_of(name).better
        log = low > 0 and high > 20 * low
        return cls(
            _wrapped(measures.label(name)) + f"\n(up: {better})",
            low,
            high,
            better == "low",
            log,
            None,
        )

    def height(self, values: np.ndarray) -> np.ndarray:
        """Places of values, `(n,)`."""
        if self._texts is not None:
            order = {text: i for i, text in enumerate(self._texts)}
            numbers = np.array([order.get(str(v), np.nan) for v in values], float)
        else:
            numbers = np.asarray(values, float)
        low, high = self._low, self._high
        at = (
            np.log(numbers / low) / np.log(high / low)
            if self._log
            else (numbers - low) / (high - low)
        )
        return 1.0 - at if self._flip else at

    @property
    def ticks(self) -> list[tuple[float, str]]:
        """Places and texts of the ticks."""
        if self._texts is not None:
            return list(
                zip(self.height(np.asarray(self._texts)).tolist(), self._texts, strict=True)
            )
        values = (
            np.geomspace(self._low, self._high, 5)
            if self._log
            else np.linspace(self._low, self._high, 5)
        )
        return [(float(self.height(np.asarray([v]))[0]), _short(v)) for v in values]


def _short(value: float) -> str:
    return f"{value:.0f}" if 1000 <= abs(value) < 1e6 else f"{value:.3g}"


def _wrapped(label: str) -> str:
    """A label over several lines, for narrow places."""
    name, bracket, unit = label.replace("actuators.", "").replace(".", " ").partition("[")
    return "\n".join(
        [*textwrap.wrap(name, 13, break_long_words=False), *([bracket + unit] if unit else [])]
    )
