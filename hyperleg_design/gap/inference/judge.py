"""Models of some causes, and what they are compared on: held-out likelihood, gap over the floor,
prior odds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.inference.base import Base
from hyperleg_design.gap.inference.detectors.holding import share
from hyperleg_design.gap.inference.fit import Cause, Design, Fit
from hyperleg_design.gap.inference.held_out import Held, doubt, predict
from hyperleg_design.gap.inference.model import Model
from hyperleg_design.gap.inference.screen import SURE

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.thresholds import Thresholds

ROUNDS = 8
"""Of setting the noise's scales in a fit to the end."""
EXCESSIVE = 0.25
"""A row counts for the gap from this share of the largest excess of any row."""
PER_PARAMETER = 0.5
"""Log prior odds against each parameter, beside what held-out data say."""
RARE = {
    "transmission_ratio": -0.5,
    "voltage_sag": -1.0,
    "thermal_derating": -0.5,
    "controller_gain": -1.5,
    "link_com": -1.0,
}
"""Log prior odds of effects that look like another and are rarer (assumed: belts have the ratio of
their teeth, controllers the gains that they were told, links the centre of mass of their drawing,
while zeros of encoders slip)."""
LARGEST_ERROR, HEAVIER, OWN_MASS = 0.8, 5.0, 0.1
"""Error over a link's own mass from which it is rather something that hangs there; log odds for as
much again; the usual error."""
UNSEEN = {"voltage_sag": 6.0, "thermal_derating": 1.0}
"""Log prior odds against what follows a signal that nobody logged: a model of it fits much."""
NEGATIVE = 8.0
"""Log prior odds against a load that weighs less than nothing, beyond what is declared."""
INWARD, OUTERMOST = 3.0, 2.0
"""Log prior odds against a load far from the ends of a robot, and for one on a link that carries
none, or on a base (assumed: loads hang on hands and lie on backs)."""
GONE, MISSING, HALF = ("coulomb_friction", "viscous_friction", "rotor_inertia"), 4.0, 0.5
"""Effects of which a model may have too much, and log odds against more than this share of the
model's being missing (assumed: friction that nobody described is usual, and joints run in, but none
runs freely, nor is a rotor without inertia)."""
CHATTERS = 12.0
"""Log odds for what can make control loops unstable, where one chatters that was damped (assumed:
healthy loops are)."""
PRESENT = 0.05
"""Share of the time of the row that is known longest, for which a row must be known to count for
the gap."""
OWN_ROWS = 0.3
"""Rows are a cause's own where its trace has this share of its largest square over the floor."""
EXPLAINED = 0.5
"""Share of the squares in episodes that a model leaves at most, also of what nuisance parameters
alone leave, if they are to count."""


@dataclass(frozen=True, eq=False)
class Judge:
    """Everything that models are compared on."""

    base: Base
    thresholds: Thresholds
    threads: int

    @cached_property
    def holds(self) -> Mapping[str, float]:
        """Joints that hold more than all known friction, see `holding` [Nm]."""
        return self.base.samples.holds

    @cached_property
    def nothing(self) -> Model:
        """Nuisance parameters alone."""
        design = Design(self.base)
        fit = design.fit()
        return Model((), fit, predict(design, fit=fit), 0.0)

    @cached_property
    def floor(self) -> np.ndarray:
        """Mean square that is expected of each group in data held out `(G,)`, in its unit."""
        return self._means(self.base.samples.floor**2 * (1 + doubt(self.base)))

    def _means(self, values: np.ndarray) -> np.ndarray:
        """Of samples `(S,)`, by group `(G,)`."""
        samples = self.base.samples
        return np.asarray(
            np.bincount(samples.group, values, samples.groups)
            / np.maximum(np.bincount(samples.group, minlength=samples.groups), 1)
        )

    @cached_property
    def counts(self) -> np.ndarray:
        """Samples by block and group `(B, G)`."""
        samples = self.base.samples
        cell = samples.block * samples.groups + samples.group
        return np.bincount(cell, minlength=self.base.blocks * samples.groups).reshape(
            self.base.blocks, samples.groups
        )

    def rows(self, square: np.ndarray, blocks: np.ndarray | None = None) -> np.ndarray:
        """Mean square of each row over its floor, then of each row's episodes `(2 rows,)`; of drawn
        blocks `(k, B)`, `(k, 2 rows)`.

        Args:
            square: sums by block and group `(B, G)`, as of `held_out.Held`.
            blocks: how often each block is drawn.
        """
        count = self.counts
        if blocks is not None:
            square, count = blocks @ square, blocks @ count
        else:
            square, count = square.sum(0), count.sum(0)
        mean = square / np.maximum(count, 1)
        found = np.zeros((*mean.shape[:-1], 2 * len(self.base.samples.rows)))
        for group, row in enumerate(self.group_row):
            found[..., row] += mean[..., group]
        return found / np.maximum(self.row_floor, 1e-300)

    @cached_property
    def group_row(self) -> np.ndarray:
        """Row of each group, episodes after all rows `(G,)`."""
        samples = self.base.samples
        return samples.group_row + np.where(samples.episodic, len(samples.rows), 0)

    @cached_property
    def present(self) -> np.ndarray:
        """Rows that are known for long enough to count for the gap `(rows,)` of bool."""
        samples = self.base.samples
        known = np.zeros(len(samples.rows))
        keys = [(r.residual_name, r.column) for r in samples.rows]
        for filtered_log in samples.filtered_logs:
            for row, mask in zip(filtered_log.rows, filtered_log.mask, strict=True):
                known[keys.index((row.residual_name, row.column))] += mask.sum()
        return known >= PRESENT * known.max(initial=0.0)

    @cached_property
    def row_floor(self) -> np.ndarray:
        """Mean square that is expected of each row and of its episodes `(2 rows,)`."""
        return np.bincount(self.group_row, self.floor, 2 * len(self.base.samples.rows))

    def model(self, causes: Sequence[Cause]) -> Model:
        """Fit causes together to the end and predict held-out blocks."""
        design = Design(self.base, causes)
        fit = design.fit(scale=self.nothing.fit.scale, rounds=ROUNDS)
        held = predict(design, fit=fit)
        model = Model(tuple(causes), fit, held, self.gain(fit, held))
        if self.holds:
            model = replace(
                model,
                gain=model.gain + sum(SURE * self.held(model, joint) ** 2 for joint in self.holds),
            )
        return replace(
            model, below=held.total - held.over - (self.nothing.held.total - self.nothing.held.over)
        )

    def held(self, model: Model, joint: str) -> float:
        """Share of what a joint holds that a model explains."""
        kept = self._shares.setdefault(model, {})
        if joint not in kept:
            kept[joint] = share(
                model,
                joint,
                self.holds[joint],
                [s.signals for s in self.base.samples.filtered_logs],
            )
        return kept[joint]

    @cached_property
    def _shares(self) -> WeakKeyDictionary[Model, dict[str, float]]:
        return WeakKeyDictionary()

    def gain(self, fit: Fit, held: Held) -> float:
        """Log-likelihood of held-out blocks over that of no cause, the cost of the calibration
        errors taken into account.
        """
        return held.total - self.nothing.held.total + self.nothing.fit.implausible - fit.implausible

    def shown(self, model: Model, place: int) -> np.ndarray:
        """Mean square of one cause's trace in each row, and in its episodes, over the floor `(2
        rows,)`.
        """
        return self._over_rows(self._traced(model, place))

    def in_rows(self, trace: np.ndarray) -> np.ndarray:
        """Mean square of a trace `(S,)`, in its unit, in each row, and in its episodes, over the
        floor `(2 rows,)`.
        """
        return self._over_rows(self._means(trace**2))

    def _over_rows(self, squares: np.ndarray) -> np.ndarray:
        """Mean squares by group `(G,)` as such of rows over the floor `(2 rows,)`."""
        return np.bincount(self.group_row, squares, 2 * len(self.base.samples.rows)) / np.maximum(
            self.row_floor, 1e-300
        )

    def shown_in_bands(self, model: Model, place: int) -> np.ndarray:
        """As `shown`, of each band of a row by itself `(G,)`: what is slow may be clear where the
        row's fast noise is large.
        """
        return self._traced(model, place) / np.maximum(self.floor, 1e-300)

    def _traced(self, model: Model, place: int) -> np.ndarray:
        """Mean square of one cause's trace in each group `(G,)`, in its unit."""
        cause = model.causes[place]
        return self._means(cause.trace((model.values(place) - cause.nulls) / cause.usual) ** 2)

    @cached_property
    def calm(self) -> np.ndarray:
        """Rows that are no episodes `(2 rows,)` of bool."""
        return np.repeat([True, False], len(self.base.samples.rows))

    def own(self, model: Model, place: int) -> np.ndarray:
        """Rows, their episodes left out, in which one cause shows most `(2 rows,)` of bool."""
        shown = self.shown(model, place)
        return self.calm & (shown > 0) & (shown >= OWN_ROWS * shown[self.calm].max())

    def excess_rows(self, model: Model) -> np.ndarray:
        """Rows that count for the gap `(2 rows,)` of bool: those with much excess when a model's
        causes are left out.

        Episodes count where the model explains them.
        """
        bare, left = self.rows(model.held.bare), self.rows(model.held.square)
        excess = np.maximum(bare - 1, 0.0)
        excess[
            ~self.calm & (left > EXPLAINED * np.minimum(bare, self.rows(self.nothing.held.square)))
        ] = 0.0
        excess[~np.tile(self.present, 2)] = 0.0
        found = excess >= max(EXCESSIVE * float(excess.max(initial=0.0)), 1e-9)
        for place in range(len(model.causes) if len(model.causes) > 1 else 0):
            shown = self.shown(model, place)
            found |= (shown >= OWN_ROWS * shown.max()) & (excess > 0.5)
        return found if found.any() else self.calm & np.tile(self.present, 2)

    def gap(
        self, square: np.ndarray, rows: np.ndarray, blocks: np.ndarray | None = None
    ) -> np.ndarray:
        """Root mean square over some rows, each over its floor `()` or `(k,)`; squares as of
        `held_out.Held`.
        """
        return np.asarray(np.sqrt(self.rows(square, blocks)[..., rows].mean(-1)))

    def closed(
        self, held: Held, rows: np.ndarray, before: Held, blocks: np.ndarray | None = None
    ) -> float:
        """Share of the excess gap of some rows, in all blocks or some `(B,)`, that a model closes;
        the gap is that without `before`'s causes.
        """
        first, after = (
            float(self.gap(before.bare, rows, blocks)),
            float(self.gap(held.square, rows, blocks)),
        )
        lowest = min(1.0, after)
        return (first - after) / (first - lowest) if first > lowest + 1e-9 else 0.0


def rank(model: Model) -> float:
    """Held-out likelihood over the floor, as less noise than that tells causes apart no better, and
    what is plausible before any log.
    """
    return model.over + plausible(model)


def plausible(model: Model) -> float:
    """Log prior of a model's causes, each over that of any other in its place; that loops chatter
    is explained once.
    """
    odds = sum(_odds(cause, model.values(place)) for place, cause in enumerate(model.causes))
    return odds + CHATTERS * any(cause.unsettling for cause in model.causes)


def _odds(cause: Cause, values: np.ndarray) -> float:
    free = int((~cause.shape).sum() if cause.linear else (cause.high > cause.low).sum())
    found = -PER_PARAMETER * free + RARE.get(cause.effect, 0.0) + cause.odds
    if cause.unseen:
        found -= UNSEEN[cause.effect]
    if cause.effect in GONE and values[0] < HALF * cause.low[0] < 0:
        found -= MISSING
    if cause.effect == "link_mass":
        found -= HEAVIER * max(
            abs(float(values[0])) * OWN_MASS / float(cause.usual[0]) - LARGEST_ERROR, 0.0
        )
    if cause.effect == "payload":
        found -= (
            NEGATIVE * (values[0] < -cause.declared)
            + INWARD * (cause.beyond > 1)
            - OUTERMOST * (cause.beyond == 0)
        )
    return found
