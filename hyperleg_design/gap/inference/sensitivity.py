"""How small an effect could have been and still been named from these logs: what `none` means, and
what no analysis can find.

Around no effect, with nuisance parameters free within their priors in every session, a trace x (over
the floor, weighted) has the
Fisher information  I = x (1 - Z (Z'Z + P)^-1 Z') x'  of its size, where Z are the errors' traces and P their prior precision. A
size f has the expected log-likelihood f^2 I / 2 over none, with standard deviation f sqrt(I). It is
named nine times in ten where

    f sqrt(I) >= sqrt(2 (evident + PAID)) + OFTEN

and its trace is `visible` over the floor in one row. The noise is the floor's: where more is left
that nothing explains, it hides more. Rivals are left aside: what is seen may still look like
something else.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import screen
from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.samples import BLOCKS

if TYPE_CHECKING:
    from hyperleg_design.gap.effects.effect import Effect
    from hyperleg_design.gap.inference.judge import Judge
    from hyperleg_design.gap.signals.signals import Signals

PAID = 1.0
"""Log-likelihood that a parameter costs on held-out data: half for its fit, half for its prior."""
OFTEN = 1.28
"""Standard deviations above which nine in ten of a normal distribution lie."""
RARELY = ("torque_saturation", "voltage_sag")
"""Effects that act in rare moments and then wholly: no size is small."""
LEAST = 1e-12
"""Information below which nothing shows."""


@dataclass(frozen=True)
class Smallest:
    """Least change of a parameter from where nothing is wrong that these logs would have shown."""

    effect: str
    location: str
    parameter: str
    change: float
    """To either side, in the parameter's unit."""
    unit: str

    def mapping(self) -> dict[str, object]:
        """As `diagnosis.json` holds it."""
        return {
            "effect": self.effect,
            "location": self.location,
            "parameter": self.parameter,
            "change": self.change,
            "unit": self.unit,
        }


@dataclass(frozen=True, eq=False)
class _Probes:
    """Traces of an effect at some sizes of one parameter."""

    parameter: str
    unit: str
    change: np.ndarray
    """Of the parameter `(k,)`."""
    columns: np.ndarray
    """`(k, S)`"""
    linear: bool
    most: float
    """Largest change that is possible."""


def smallest(judge: Judge, wanted: Sequence[tuple[str, str]]) -> tuple[Smallest, ...]:
    """Of each effect and place that the logs can show in a size that is possible, and of each
    parameter that is a size.

    Args:
        judge: of the logs.
        wanted: effects and places.
    """
    found = screen.spread(
        lambda name: _of(judge, *name),
        [name for name in wanted if name[0] not in RARELY],
        judge.threads,
    )
    return tuple(one for group in found for one in group)


def _of(judge: Judge, effect: str, location: str) -> list[Smallest]:
    found = []
    for probes in _probes(judge, EFFECTS[effect], location):
        factor = _factors(judge, EFFECTS[effect], probes.columns)
        known = np.isfinite(factor)
        if not known.any():
            continue
        change, factor = probes.change[known], factor[known]
        # a trace that is not linear is taken at the size nearest to the one that just shows; of
        # several shapes, the usual one
        size = (
            float(np.median(factor * change))
            if probes.linear
            else float((factor * change)[np.argmin(np.abs(np.log(factor)))])
        )
        if size <= probes.most:
            found.append(Smallest(effect, location, probes.parameter, size, probes.unit))
    return found


def _probes(judge: Judge, effect: Effect, location: str) -> list[_Probes]:
    traced = screen.traced(judge.base, effect, location)
    if isinstance(traced, screen.NotJudged):
        return []
    sizes = [i for i, p in enumerate(effect.parameters) if not p.shape]
    subject = judge.base.samples.filtered_logs[0].signals.subject
    bounds = effect.bounds(location, subject)
    if isinstance(traced, list):
        return [
            _probe(
                effect,
                i,
                bounds,
                [c.usual[i] for c in traced],
                np.stack([c.columns[i] for c in traced]),
                linear=True,
            )
            for i in sizes
        ]
    starts, columns = traced
    if len(sizes) == 1:
        choices = [i for i, p in enumerate(effect.parameters) if p.choices]
        alike = (starts[:, choices] == starts[0, choices]).all(
            1
        )  # one of several ways in which it may act, the first
        return [
            _probe(
                effect,
                sizes[0],
                bounds,
                starts[alike, sizes[0]] - effect.nulls[sizes[0]],
                columns[alike],
            )
        ]
    found = []
    for i in sizes:
        # the others stay as the model has them; what only shapes the trace, as a first look would
        # have it
        values = np.where([p.shape for p in effect.parameters], starts[0], effect.nulls)
        step = effect.usual(location, subject)[i]
        low, high = bounds[:, i]
        values[i] = values[i] + step if values[i] + step <= high else max(values[i] - step, low)
        own = judge.base.samples.columns(partial(_trace, effect, location, values), 1)
        if own is not None:
            found.append(_probe(effect, i, bounds, [values[i] - effect.nulls[i]], own))
    return found


def _trace(
    effect: Effect, location: str, values: np.ndarray, signals: Signals
) -> Mapping[str, np.ndarray]:
    return effect.trace(signals, location, values[None])


def _probe(
    effect: Effect,
    place: int,
    bounds: np.ndarray,
    change: Sequence[float] | np.ndarray,
    columns: np.ndarray,
    linear: bool = False,
) -> _Probes:
    parameter = effect.parameters[place]
    most = float(np.abs(bounds[:, place] - effect.nulls[place]).max())
    return _Probes(
        parameter.name, parameter.unit, np.abs(np.asarray(change, float)), columns, linear, most
    )


def _factors(judge: Judge, effect: Effect, columns: np.ndarray) -> np.ndarray:
    """By how much traces `(k, S)` must be multiplied to be named `(k,)`; infinite where they show
    nothing.
    """
    rules, base = judge.thresholds, judge.base
    floating = base.samples.filtered_logs[0].signals.subject.floating
    unsure = (floating and not base.prior.told) or effect.doubtful(effect.nulls)
    least = np.sqrt(2 * ((rules.evident_doubtful if unsure else rules.evident) + PAID)) + OFTEN
    told = _information(judge, columns)
    shown = np.sqrt([judge.in_rows(column).max(initial=0.0) for column in columns])
    with np.errstate(divide="ignore"):
        factor = np.maximum(
            least / np.sqrt(np.maximum(told, 0.0)),
            (rules.visible_afoot if floating else rules.visible) / shown,
        )
    return np.where(told > LEAST, factor, np.inf)


def _information(judge: Judge, columns: np.ndarray) -> np.ndarray:
    """Fisher information of each trace's size, nuisance parameters free `(k,)`."""
    from scipy.linalg import cho_solve

    base = judge.base
    weight = np.ones(base.samples.groups)
    design = Design(base, ridge=columns * base.samples.weight)
    size, k = len(base.errors), len(columns)
    found = np.zeros(k)
    for session in range(base.samples.sessions):
        of_base, own, cross = design.gathered(BLOCKS, None, session, False)
        _, factor, _ = base.normal(of_base, weight, b"sensitivity" + bytes([session]))
        between = np.tensordot(weight, cross, 1)[:k, :size]
        found += np.diag(np.tensordot(weight, own, 1))[:k] - np.einsum(
            "kp,pk->k", between, cho_solve(factor, between.T, check_finite=False)
        )
    return found
