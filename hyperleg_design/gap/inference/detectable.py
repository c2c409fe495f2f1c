"""How small an effect could have been and still been named from these logs: what `none` means.

Beside noise and discrepancy, a trace x has the Fisher information I = x' Sigma^-1 x of its size. A
size f is expected to gain f^2 I / 2 nats over nothing, with standard deviation f sqrt(I); it must
gain its prior odds. It is named nine times in ten where

    f sqrt(I) >= sqrt(2 odds) + 1.28,

and where it is as clearly larger than a usual calibration error u: f >= u + 1.28 / sqrt(I).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS, UNLISTED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.inference.effect_traces import NotJudged
from hyperleg_design.gap.inference.hypotheses.cause_prior import usual_error
from hyperleg_design.gap.inference.hypotheses.hypothesis import Hypothesis
from hyperleg_design.gap.inference.hypotheses.search import Search
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.model.subject import Subject

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


def detectable(search: Search, beside: Hypothesis | None = None) -> tuple[Detectable, ...]:
    """State the smallest fault that logs would have shown nine times in ten, by effect and place.

    Args:
        search: that was made on the logs.
        beside: hypothesis whose noise and discrepancy a fault would have had to stand out of; by
            default that of no cause, in which a gap that a cause explains counts as discrepancy.

    Returns:
        Of each effect and place that the logs show: for each size of a linear effect, and for the
        size of a nonlinear one that has a single size, whatever its choices are.
    """
    scales = (beside or search.fits.null).scales
    subject = search.evidence.signals[0].subject
    entries: list[tuple[str, str, int, float, float, float]] = []
    for (name, place, standing), traced in search.traces.items():
        if standing or isinstance(traced, NotJudged) or name in UNLISTED:
            continue
        effect = EFFECTS[name]
        most = np.abs(effect.bounds(place, subject) - effect.nulls).max(0)
        of_mass = [p.unit == "kg" for p in effect.parameters]  # no robot bears more than itself
        most = np.where(of_mass, np.minimum(most, subject.tree.mass), most)
        sizes = [i for i, p in enumerate(effect.parameters) if not p.shape]
        information = search.proposer.information((name, place, standing), scales)
        if isinstance(traced, list):
            for i in sizes:
                entries.append((name, place, i, traced[0].usual[i], most[i], information[i]))
        elif len(sizes) == 1:
            i = sizes[0]
            change = np.abs(traced.values[:, i] - effect.nulls[i])
            moved = change > 0
            plain = moved & usual_shape(effect, place, subject, traced.values)
            tried = plain if plain.any() else moved
            for first in _smallest(
                np.where(tried, change, np.inf), _choices(effect, traced.values)
            ):
                entries.append((name, place, i, float(change[first]), most[i], information[first]))
    rules = search.rules.cause
    chance = rules.changed if search.evidence.references else rules.probability
    least: dict[tuple[str, str, int, float], float] = {}
    for name, place, i, unit_size, limit, own in entries:
        hypotheses = len(search.count) * search.count[name]
        odds = float(np.log(hypotheses / chance))
        deviation = unit_size / np.sqrt(max(own, LEAST))
        usual = usual_error(search.evidence, search.rules, (name, place, i))
        beyond = usual + OFTEN * search.rules.posterior.interval * deviation
        size = max((np.sqrt(2 * odds) + OFTEN) * deviation, beyond)
        # nobody knows which choice holds: what logs show is shown whichever does
        key = name, place, i, limit
        least[key] = max(least.get(key, 0.0), size)
    sizes_shown = []
    for (name, place, i, limit), size in least.items():
        parameter = EFFECTS[name].parameters[i]
        if 0 < size <= limit:
            unit = unit_at(subject, EFFECTS[name].kind, place, parameter.unit)
            sizes_shown.append(Detectable(name, place, parameter.name, float(size), unit))
    return tuple(sizes_shown)


def _choices(effect: Effect, values: np.ndarray) -> np.ndarray:
    """Choices among parameters of an effect `(k, choices)`, of values `(k, parameters)`."""
    return values[:, [place for place, p in enumerate(effect.parameters) if p.choices]]


def _smallest(change: np.ndarray, choices: np.ndarray) -> list[int]:
    """Find the smallest finite change `(k,)` of each set of choices `(k, choices)`."""
    order = np.argsort(change, kind="stable")
    _, first = np.unique(choices[order], axis=0, return_index=True)
    return sorted(int(place) for place in order[first] if np.isfinite(change[place]))


def usual_shape(effect: Effect, place: str, subject: Subject, values: np.ndarray) -> np.ndarray:
    """Tell which values of an effect have the shape of its example.

    A start that was fitted to a log may have any shape: a load of some grams a metre away from its
    link, which shows at a hundredth of the mass of a load on the link.

    Args:
        effect: the effect.
        place: where it acts.
        subject: the robot.
        values: of its parameters `(k, parameters)`.

    Returns:
        `(k,)`.
    """
    shape = [i for i, p in enumerate(effect.parameters) if p.shape and not p.choices]
    return np.asarray(
        np.isclose(values[:, shape], effect.example(place, subject)[shape], atol=1e-9).all(1)
    )
