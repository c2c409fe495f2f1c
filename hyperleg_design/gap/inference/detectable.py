"""How small an effect could have been and still been named from these logs: what `none` means.

Beside noise and discrepancy, a trace x has the Fisher information I = x' Sigma^-1 x of its size. A
size f is expected to gain f^2 I / 2 nats over nothing, with standard deviation f sqrt(I); it must
gain its prior odds. It is named nine times in ten where

    f sqrt(I) >= sqrt(2 odds) + 1.28.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference import screen

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.search import Search

OFTEN = 1.28
"""Standard deviations above which nine in ten of a normal distribution lie."""
LEAST = 1e-12
"""Information below which nothing shows."""


@dataclass(frozen=True)
class Detectable:
    """Least change of a parameter from where nothing is wrong that these logs would have shown."""

    effect: str
    location: str
    parameter: str
    change: float
    """To either side, in the parameter's unit."""
    unit: str

    def mapping(self) -> dict[str, object]:
        """As `diagnosis.json` holds it."""
        return dict(vars(self))


def detectable(search: Search) -> tuple[Detectable, ...]:
    """Of each effect and place with one parameter that is a size and a trace that grows with it."""
    entries: list[tuple[str, str, int, float, float, float]] = []
    for (name, place, standing), traced in search.traces.items():
        if standing or isinstance(traced, screen.NotJudged):
            continue
        effect = EFFECTS[name]
        subject = search.evidence.signals[0].subject
        most = np.abs(effect.bounds(place, subject) - effect.nulls).max(0)
        sizes = [i for i, p in enumerate(effect.parameters) if not p.shape]
        information = search.promises.information(
            (name, place, standing), search.fits.nothing.scales
        )
        if isinstance(traced, list):
            for i in sizes:
                entries.append((name, place, i, traced[0].usual[i], most[i], information[i]))
        elif len(sizes) == 1:
            i = sizes[0]
            change = np.abs(traced[0][:, i] - effect.nulls[i])
            if change.max() > 0:
                first = int(np.argmin(np.where(change > 0, change, np.inf)))
                entries.append((name, place, i, float(change[first]), most[i], information[first]))
    found = []
    for name, place, i, unit_size, limit, own in entries:
        hypotheses = len(search.count) * search.count[name]
        odds = float(np.log(hypotheses / search.rules.cause.probability))
        size = (np.sqrt(2 * odds) + OFTEN) / np.sqrt(max(own, LEAST)) * unit_size
        parameter = EFFECTS[name].parameters[i]
        if 0 < size <= limit:
            found.append(Detectable(name, place, parameter.name, float(size), parameter.unit))
    return tuple(found)
