"""Which causes are named: by what they predict of data that they were not fitted to, never by the fit itself.

One cause must beat none on held-out blocks by `evident`, close `worth` of the excess gap and be `visible` over the floor; a further
one must do so beside those before it. What no list of effects explains is `unknown`. All rules are `thresholds.Thresholds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap import nuisance, screen, shape
from hyperleg_design.gap.effects.friction import sliding
from hyperleg_design.gap.episodes import together
from hyperleg_design.gap.fit import Base, Cause, Design, Fit, Held, predict

if TYPE_CHECKING:
    from hyperleg_design.gap.signals import Signals
    from hyperleg_design.gap.thresholds import Thresholds

FINALISTS = 10
"""Candidates that are judged on held-out data."""
REFINED = 24
"""Candidates that are fitted to the end before that."""
ROUNDS = 8
MOST_CAUSES = 3
EXCESSIVE = 0.25
"""A row counts for the gap from this share of the largest excess of any row."""
JUDGED_SHAPES = 5
"""Shapes that are judged on held-out data."""
PER_PARAMETER = 0.5
"""Log prior odds against each parameter, beside what held-out data say."""
RARE = {"transmission_ratio": -1.0, "voltage_sag": -1.0, "thermal_derating": -0.5}
"""Log prior odds of effects that look like another and are rarer (assumed: belts and gears have the ratio of their teeth)."""
LARGEST_ERROR, HEAVIER, OWN_MASS = 0.8, 5.0, 0.1
"""Error over a link's own mass from which it is rather something that hangs there; log odds for as much again; the usual error."""
NEGATIVE = 8.0
"""Log prior odds against a load that weighs less than nothing, beyond what is declared."""
TURNING = ("coulomb_friction", "stribeck_friction", "load_dependent_friction")
"""Effects whose trace turns over with the motion; how, nobody knows better than of the model's own friction."""
GENTLE = 0.05
"""Least speed over which it may do so [rad/s]."""
OWN_ROWS = 0.3
"""Rows are a cause's own where its trace has this share of its largest square over the floor."""
EXPLAINED = 0.5
"""Share of the squares in episodes that a model leaves at most, if they are to count."""
SURE = 3.0
"""Gain of a further cause over the least one, from which episodes count for it."""
AT_LIMITS = ("torque_saturation", "voltage_sag")
"""Effects of which that is not so: healthy drives reach limits too, which models often do not know."""
PASSES = 2.0
"""Gain that is stated, over the least that tells, of a shape that does for several causes."""
SMALL_EXCESS, QUIET = 1.2, 3.0
"""Gap over floor up to which a shape must be so many times more evident to be told, as no cause was named."""
SHAPED_ROWS = 4
"""Rows with the largest excess whose shape is looked at."""


@dataclass(frozen=True, eq=False)
class Model:
    """Some causes together, and how they predict held-out blocks."""

    causes: tuple[Cause, ...]
    fit: Fit
    held: Held
    gain: float
    """Log-likelihood of held-out blocks over that of no cause, and how much more plausible the calibration errors are."""

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Effects and locations."""
        return tuple(c.name for c in self.causes)

    def values(self, place: int) -> np.ndarray:
        """Fitted parameters of one cause."""
        start = sum(len(c.nulls) for c in self.causes[:place])
        cause = self.causes[place]
        return np.clip(cause.nulls + self.fit.phi[start : start + len(cause.nulls)] * cause.usual, cause.low, cause.high)


@dataclass(frozen=True, eq=False)
class Judge:
    """Everything that models are compared on."""

    base: Base
    thresholds: Thresholds
    threads: int

    @cached_property
    def nothing(self) -> Model:
        """Calibration errors alone."""
        design = Design(self.base)
        fit = design.fit()
        return Model((), fit, predict(design, fit=fit), 0.0)

    @cached_property
    def floor(self) -> np.ndarray:
        """Mean square that is expected of each group `(G,)`, in its unit."""
        samples = self.base.samples
        return np.bincount(samples.group, samples.floor**2, samples.groups) / np.maximum(np.bincount(samples.group, minlength=samples.groups), 1)

    @cached_property
    def counts(self) -> np.ndarray:
        """Samples by block and group `(B, G)`."""
        samples = self.base.samples
        cell = samples.block * samples.groups + samples.group
        return np.bincount(cell, minlength=self.base.blocks * samples.groups).reshape(self.base.blocks, samples.groups)

    def rows(self, square: np.ndarray, blocks: np.ndarray | None = None) -> np.ndarray:
        """Mean square of each row over its floor, then of each row's episodes `(2 rows,)`; of drawn blocks `(k, B)`, `(k, 2 rows)`.

        Args:
            square: sums by block and group `(B, G)`, as of `fit.Held`.
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
    def row_floor(self) -> np.ndarray:
        """Mean square that is expected of each row and of its episodes `(2 rows,)`."""
        return np.bincount(self.group_row, self.floor, 2 * len(self.base.samples.rows))

    def model(self, causes: Sequence[Cause]) -> Model:
        """Fit causes together to the end and predict held-out blocks."""
        design = Design(self.base, causes)
        fit = design.fit(scale=self.nothing.fit.scale, rounds=ROUNDS)
        held = predict(design, fit=fit)
        return Model(tuple(causes), fit, held, self.gain(fit, held))

    def gain(self, fit: Fit, held: Held) -> float:
        """Log-likelihood of held-out blocks over that of no cause, the cost of the calibration errors taken into account."""
        return held.total - self.nothing.held.total + self.nothing.fit.implausible - fit.implausible

    def shown(self, model: Model, place: int) -> np.ndarray:
        """Mean square of one cause's trace in each row, and in its episodes, over the floor `(2 rows,)`."""
        cause, samples = model.causes[place], self.base.samples
        phi = (model.values(place) - cause.nulls) / cause.usual
        trace = phi @ cause.columns + (0.0 if cause.linear else cause.constant)
        mean = np.bincount(samples.group, trace**2, samples.groups) / np.maximum(np.bincount(samples.group, minlength=samples.groups), 1)
        return np.bincount(self.group_row, mean, 2 * len(samples.rows)) / np.maximum(self.row_floor, 1e-300)

    def excess_rows(self, model: Model) -> np.ndarray:
        """Rows that count for the gap `(2 rows,)` of bool: those with much excess when a model's causes are left out.

        Episodes count where the model explains them.
        """
        bare, left = self.rows(model.held.bare), self.rows(model.held.square)
        excess = np.maximum(bare - 1, 0.0)
        episode = np.arange(len(excess)) >= len(self.base.samples.rows)
        excess[episode & (left > EXPLAINED * bare)] = 0.0
        found = excess >= max(EXCESSIVE * float(excess.max(initial=0.0)), 1e-9)
        for place in range(len(model.causes) if len(model.causes) > 1 else 0):
            shown = self.shown(model, place)
            found |= (shown >= OWN_ROWS * shown.max()) & (excess > 0.5)
        return found if found.any() else ~episode

    def gap(self, square: np.ndarray, rows: np.ndarray, blocks: np.ndarray | None = None) -> np.ndarray:
        """Root mean square over some rows, each over its floor `()` or `(k,)`; squares as of `fit.Held`."""
        return np.asarray(np.sqrt(self.rows(square, blocks)[..., rows].mean(-1)))

    def closed(self, held: Held, rows: np.ndarray, before: Held) -> float:
        """Share of the excess gap of some rows that a model closes; the gap is the one without the causes of `before`."""
        first, after = float(self.gap(before.bare, rows)), float(self.gap(held.square, rows))
        lowest = min(1.0, after)
        return (first - after) / (first - lowest) if first > lowest + 1e-9 else 0.0


@dataclass(frozen=True, eq=False)
class Decision:
    """What was found."""

    verdict: str
    model: Model
    rows: np.ndarray
    """That count for the gap `(rows,)` of bool."""
    singles: tuple[Model, ...]
    """Best first: each cause alone, or, with several causes, each beside the others."""
    slots: tuple[tuple[Model, ...], ...]
    """For each named cause its rivals in its place, itself among them."""
    shaped: tuple[tuple[shape.Shape, float, float], ...]
    """Shapes with their gain over the model and the further share of the excess gap that they close, best first."""
    together: float
    """Share of the time in which most drives at once do not do what they were told, beside the causes."""
    not_judged: tuple[screen.NotJudged, ...]


def decide(base: Base, thresholds: Thresholds, wanted: Sequence[tuple[str, str]], threads: int = 1) -> tuple[Judge, Decision]:
    """Name the causes.

    Args:
        base: residual and calibration errors.
        thresholds: fixed rules.
        wanted: effects and locations that are tried.
        threads: that share the work.
    """
    judge = Judge(base, thresholds, threads)
    nothing = judge.nothing
    singles, not_judged = _finalists(judge, wanted, ())
    rows = judge.excess_rows(singles[0] if singles else nothing)
    chosen = nothing
    slots: list[tuple[Model, ...]] = []
    best = next((m for m in singles if _named(judge, m, 0, nothing)), None)
    if best is not None:
        chosen, slots = best, [tuple(singles)]
        rows = judge.excess_rows(best)
        while len(chosen.causes) < MOST_CAUSES:
            more, _ = _finalists(judge, wanted, chosen.causes)
            further = next((m for m in more if _further(judge, m, chosen)), None)
            if further is None:
                break
            chosen, slots = further, [*slots, tuple(more)]
            if len(chosen.causes) == 2:
                chosen, slots = _swapped(judge, wanted, chosen, slots)
            rows = judge.excess_rows(chosen)
    shaped = _better_shape(judge, chosen, rows) or _shaped(judge, chosen, rows)
    lost = together(base.samples, chosen.held.left)
    verdict = "unknown" if lost > thresholds.together else _verdict(judge, chosen, rows, shaped)
    return judge, Decision(verdict, chosen, rows, tuple(singles), tuple(slots), shaped, lost, tuple(not_judged))


def _finalists(judge: Judge, wanted: Sequence[tuple[str, str]], beside: Sequence[Cause]) -> tuple[list[Model], list[screen.NotJudged]]:
    """Best candidates beside given causes, as models on held-out blocks, best first."""
    taken = {c.name for c in beside}
    base = judge.base
    start = judge.nothing.fit if not beside else Design(base, beside).fit(scale=judge.nothing.fit.scale, rounds=ROUNDS)
    found = screen.screen(base, start, [w for w in wanted if w not in taken], judge.threads, beside)
    candidates = [c for c in found if isinstance(c, screen.Candidate)]
    candidates.sort(key=lambda c: (-c.gain, c.name))
    refined = screen.spread(lambda c: (_refined(base, c, start, beside), c), candidates[:REFINED], judge.threads)
    refined.sort(key=lambda pair: (-pair[0], pair[1].name))
    models = screen.spread(lambda pair: judge.model([*beside, pair[1].cause]), refined[:FINALISTS], judge.threads)
    models.sort(key=lambda m: (-_rank(m), m.names))
    return models, [c for c in found if isinstance(c, screen.NotJudged)]


def _refined(base: Base, candidate: screen.Candidate, start: Fit, beside: Sequence[Cause]) -> float:
    return Design(base, [*beside, candidate.cause]).fit(scale=start.scale, rounds=ROUNDS).evidence


def _rank(model: Model) -> float:
    """Held-out likelihood and what is plausible before any log."""
    return model.gain + plausible(model)


def plausible(model: Model) -> float:
    """Log prior of the last cause of a model, over that of any other."""
    cause = model.causes[-1]
    found = -PER_PARAMETER * len(cause.nulls) + RARE.get(cause.effect, 0.0)
    if cause.effect == "link_mass":
        found -= HEAVIER * max(abs(float(model.values(len(model.causes) - 1)[0])) * OWN_MASS / float(cause.usual[0]) - LARGEST_ERROR, 0.0)
    if cause.effect == "payload" and model.values(len(model.causes) - 1)[0] < -cause.declared:
        found -= NEGATIVE
    return found


def _named(judge: Judge, model: Model, place: int, before: Model) -> bool:
    """Whether the first cause is worth its name: by all rows with excess or, where it is beyond doubt, by those where it shows."""
    rules = judge.thresholds
    gain = model.gain - before.gain
    if gain < rules.evident or float(np.sqrt(judge.shown(model, place).max())) < rules.visible:
        return False
    if judge.closed(model.held, judge.excess_rows(model), model.held) >= rules.worth:
        return True
    return gain >= SURE * rules.second_evident and _closes_own(judge, model, before, rules.required)


def _further(judge: Judge, model: Model, before: Model) -> bool:
    """Whether one more cause is worth its name beside those before it: in the rows where it shows, over what they leave."""
    rules = judge.thresholds
    if model.gain - before.gain < rules.second_evident * len(before.causes):
        return False
    if float(np.sqrt(judge.shown(model, len(model.causes) - 1).max())) < rules.visible:
        return False
    return _closes_own(judge, model, before, rules.second_worth)


def _closes_own(judge: Judge, model: Model, before: Model, worth: float) -> bool:
    """Whether the last cause closes a share of the excess squares in the rows where it shows."""
    shown = judge.shown(model, len(model.causes) - 1)
    calm = np.arange(len(shown)) < len(judge.base.samples.rows)
    sure = model.gain - before.gain >= SURE * judge.thresholds.second_evident
    if sure and model.causes[-1].effect not in AT_LIMITS:
        calm |= ~calm  # episodes alone are too little, unless they speak clearly
    own = (shown >= OWN_ROWS * shown.max()) & (shown > 0) & calm
    if not own.any():
        return False
    left, less = judge.rows(before.held.square)[own].mean(), judge.rows(model.held.square)[own].mean()
    return bool(left - less >= worth * max(left - min(1.0, less), 1e-9))


def _swapped(judge: Judge, wanted: Sequence[tuple[str, str]], pair: Model, slots: list[tuple[Model, ...]]) -> tuple[Model, list[tuple[Model, ...]]]:
    """Look for the first cause again beside the second: forward selection may have begun with what looked like both."""
    models, _ = _finalists(judge, wanted, pair.causes[1:])
    turned = [_turned(m) for m in models]
    if turned and turned[0].gain > pair.gain + 1e-6 and turned[0].names != pair.names:
        return turned[0], [tuple(turned), slots[1]]
    return pair, [tuple(turned) if any(t.names == pair.names for t in turned) else slots[0], slots[1]]


def _turned(model: Model) -> Model:
    """The last cause first."""
    size = len(model.causes[-1].nulls)
    order = np.r_[np.arange(len(model.fit.phi) - size, len(model.fit.phi)), np.arange(len(model.fit.phi) - size)]
    fit = replace(model.fit, phi=model.fit.phi[order], covariance=model.fit.covariance[np.ix_(order, order)])
    return replace(model, causes=(model.causes[-1], *model.causes[:-1]), fit=fit)


def _shaped(judge: Judge, chosen: Model, rows: np.ndarray) -> tuple[tuple[shape.Shape, float, float], ...]:
    """Shapes beside the chosen causes, in the rows with most excess left or before."""
    base = judge.base
    before = judge.rows(chosen.held.bare)
    order = np.argsort(-before, kind="stable")
    looked = np.array(list(dict.fromkeys((order[rows[order]] % len(base.samples.rows)).tolist()))[:SHAPED_ROWS], int)

    beside = _companions(judge, chosen)
    plain = Design(base, chosen.causes, ridge=beside) if beside is not None else None
    start, known = chosen.gain, chosen.held
    if plain is not None:
        fit = plain.fit(scale=chosen.fit.scale, rounds=ROUNDS)
        known = predict(plain, fit=fit)
        start = judge.gain(fit, known)

    def rough(one: shape.Shape) -> tuple[shape.Shape, Design, float] | None:
        columns = shape.columns(base, judge.nothing.fit, one)
        if columns is None:
            return None
        design = Design(base, chosen.causes, ridge=columns if beside is None else np.concatenate([columns, beside]))
        return one, design, design.fit(scale=chosen.fit.scale, rounds=1).evidence

    def judged(found: tuple[shape.Shape, Design, float]) -> tuple[shape.Shape, float, float]:
        one, design, _ = found
        fit = design.fit(scale=chosen.fit.scale, rounds=ROUNDS)
        held = predict(design, fit=fit)
        return one, judge.gain(fit, held) - start, _beyond(judge, known, held, rows)

    first = [t for t in screen.spread(rough, shape.shapes(base.samples, looked), judge.threads) if t is not None]
    first.sort(key=lambda t: (-t[2], t[0].name, t[0].row))
    found = screen.spread(judged, first[:JUDGED_SHAPES], judge.threads)
    return tuple(sorted(found, key=lambda t: (-t[1], t[0].name, t[0].row)))


def _companions(judge: Judge, chosen: Model) -> np.ndarray | None:
    """Ways on which the friction of causes may turn over, as that of the model, weighted `(k, S)`."""
    samples = judge.base.samples
    subject = samples.sieves[0].signals.subject
    found = []
    for place, cause in enumerate(chosen.causes):
        if cause.effect not in TURNING:
            continue
        joint = subject.joints.index(cause.location)
        size = float(np.sqrt(judge.shown(chosen, place).max()))

        def trace(signals: Signals, joint: int = joint) -> dict[str, np.ndarray]:
            rows = np.zeros((len(nuisance.WAYS) + 1, *signals.position.shape))
            at_once = sliding(signals)[:, joint]
            rows[:-1, :, joint] = [nuisance.stop(signals.position[:, joint], way) - at_once for way in nuisance.WAYS]
            rows[-1, :, joint] = np.tanh(signals.velocity[:, joint] / max(float(subject.friction_speed[joint]), GENTLE)) - at_once
            return {"motion": rows}

        columns = samples.columns(trace, len(nuisance.WAYS) + 1)
        if columns is not None:
            level = samples.columns(lambda s, j=joint: {"motion": _only(s, j)}, 1)  # type: ignore[misc]
            assert level is not None
            unit = screen.reach(samples, level)
            found.append(columns * samples.weight * (nuisance.OF_WAY * size / max(unit, 1e-12)))
    return np.concatenate(found) if found else None


def _only(signals: Signals, joint: int) -> np.ndarray:
    rows = np.zeros((1, *signals.position.shape))
    rows[0, :, joint] = sliding(signals)[:, joint]
    return rows


def _beyond(judge: Judge, known: Held, held: Held, rows: np.ndarray) -> float:
    """Share of what the chosen causes leave, in squares over the rows with excess, that something further closes."""
    after, further = float(judge.gap(known.square, rows)), float(judge.gap(held.square, rows))
    return 1 - (further / max(after, 1e-12)) ** 2


def _better_shape(judge: Judge, chosen: Model, rows: np.ndarray) -> tuple[tuple[shape.Shape, float, float], ...]:
    """Shapes that predict more than the chosen causes do, without them: then the causes only stood for the shape.

    Several causes must each be worth it beside a shape, as they must beside each other.
    """
    if not chosen.causes:
        return ()
    rules = judge.thresholds
    needed = rules.beyond_evident if len(chosen.causes) == 1 else -rules.second_evident * (len(chosen.causes) - 1)
    alone = _shaped(judge, judge.nothing, rows)
    return tuple((one, max(gain - chosen.gain, PASSES * rules.beyond_evident), closed) for one, gain, closed in alone if gain - chosen.gain > needed)


def _verdict(judge: Judge, chosen: Model, rows: np.ndarray, shaped: Sequence[tuple[shape.Shape, float, float]]) -> str:
    rules = judge.thresholds
    excess = float(judge.gap(judge.nothing.held.square, rows))
    needed = rules.beyond_evident * (QUIET if not chosen.causes and excess < SMALL_EXCESS else 1.0)
    beyond = tells(rules, chosen, shaped) and shaped[0][1] > needed
    if not chosen.causes:
        return "unknown" if excess > rules.largest_excess or beyond else "none"
    if beyond or judge.closed(chosen.held, rows, chosen.held) < rules.required:
        return "unknown"
    return "explained"


def tells(rules: Thresholds, chosen: Model, shaped: Sequence[tuple[shape.Shape, float, float]]) -> bool:
    """Whether the best shape speaks against causes, or against none."""
    return bool(shaped) and shaped[0][1] > rules.beyond_evident and shaped[0][2] > rules.beyond * max(len(chosen.causes), 1)
