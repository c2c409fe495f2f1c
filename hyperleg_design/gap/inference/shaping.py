"""Shapes beside the named causes, and instead of them: what speaks against the catalogue."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hyperleg_design.gap.inference import nuisance, screen, shape
from hyperleg_design.gap.inference.detectors.unsettled import unsettled
from hyperleg_design.gap.inference.fit import Design
from hyperleg_design.gap.inference.held_out import Held, predict
from hyperleg_design.gap.inference.judge import ROUNDS, Judge
from hyperleg_design.gap.inference.model import Model
from hyperleg_design.gap.signals.sliding import sliding

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.thresholds import Thresholds
    from hyperleg_design.gap.signals.signals import Signals

JUDGED_SHAPES = 5
"""Shapes that are judged on held-out data."""
TURNING = ("coulomb_friction", "stribeck_friction", "load_dependent_friction")
"""Effects whose trace turns over with the motion; how, nobody knows better than of the model's own
friction."""
GENTLE = 0.05
"""Least speed over which it may do so [rad/s]."""
PASSES = 2.0
"""Gain that is stated, over the least that tells, of a shape that does for several causes."""
PRECISE = 0.03
"""What models of effects get wrong of their traces, root mean square over the trace's (assumed)."""
SHAPED_ROWS = 4
"""Rows with the largest excess whose shape is looked at."""


class Told(NamedTuple):
    """A shape and what it is worth."""

    shape: shape.Shape
    gain: float
    """Held-out log-likelihood over what it is compared with."""
    closed: float
    """Share of the squares left over that it closes."""
    faint: bool = False
    """Whether it is less beside the causes than what a model of them gets wrong."""


def beside(judge: Judge, chosen: Model, rows: np.ndarray) -> tuple[Told, ...]:
    """Shapes beside the chosen causes, in the rows with most excess left or before."""
    base = judge.base
    before = judge.rows(chosen.held.bare)
    shaken = unsettled(
        base.samples
    )  # friction that is averaged over a swing of doubtful size has shapes of its own
    order = np.argsort(-before, kind="stable")
    order = order[
        [base.samples.rows[row % len(base.samples.rows)].name not in shaken for row in order]
    ]
    looked = np.array(
        list(dict.fromkeys((order[rows[order]] % len(base.samples.rows)).tolist()))[:SHAPED_ROWS],
        int,
    )

    companions = _companions(judge, chosen)
    plain = Design(base, chosen.causes, ridge=companions) if companions is not None else None
    start, known = chosen.gain, chosen.held
    left = float(judge.gap(known.square, rows)) ** 2
    explained = float(judge.gap(known.bare, rows)) ** 2 - left if chosen.causes else -np.inf
    if plain is not None:
        fit = plain.fit(scale=chosen.fit.scale, rounds=ROUNDS)
        known = predict(plain, fit=fit)
        start = judge.gain(fit, known)

    def rough(one: shape.Shape) -> tuple[shape.Shape, Design, float] | None:
        columns = shape.columns(base, judge.nothing.fit, one)
        if columns is None:
            return None
        design = Design(
            base,
            chosen.causes,
            ridge=columns if companions is None else np.concatenate([columns, companions]),
        )
        return one, design, design.fit(scale=chosen.fit.scale, rounds=1).evidence

    def judged(found: tuple[shape.Shape, Design, float]) -> Told:
        one, design, _ = found
        fit = design.fit(scale=chosen.fit.scale, rounds=ROUNDS)
        held = predict(design, fit=fit)
        closed = _beyond(judge, known, held, rows)
        return Told(
            one, judge.gain(fit, held) - start, closed, closed * left <= PRECISE**2 * explained
        )

    first = [
        t
        for t in screen.spread(rough, shape.shapes(base.samples, looked), judge.threads)
        if t is not None
    ]
    first.sort(key=lambda t: (-t[2], t[0].name, t[0].row))
    found = screen.spread(judged, first[:JUDGED_SHAPES], judge.threads)
    return tuple(sorted(found, key=lambda t: (t.faint, -t.gain, t.shape.name, t.shape.row)))


def of_base(judge: Judge) -> tuple[Told, ...]:
    """Rhythms in the residual of a floating base, in which no joint's friction and no drive has a
    part: small pushes show there.
    """
    base = judge.base
    found = []
    for row, one in enumerate(base.samples.rows):
        if one.residual_name != "base":
            continue
        rhythm = shape.Shape(
            "rhythm",
            row,
            f"{one.name} of the base: a push that repeats in time, whatever the motion",
        )
        columns = shape.columns(base, judge.nothing.fit, rhythm)
        if columns is None:
            continue
        design = Design(base, ridge=columns)
        fit = design.fit(scale=judge.nothing.fit.scale, rounds=ROUNDS)
        held = predict(design, fit=fit)
        own = np.arange(2 * len(base.samples.rows)) == row
        found.append(
            Told(rhythm, judge.gain(fit, held), _beyond(judge, judge.nothing.held, held, own))
        )
    return tuple(sorted(found, key=lambda t: (-t.gain, t.shape.row)))


def _companions(judge: Judge, chosen: Model) -> np.ndarray | None:
    """Ways on which the friction of causes may turn over, as that of the model, weighted `(k,
    S)`.
    """
    samples = judge.base.samples
    subject = samples.filtered_logs[0].signals.subject
    found = []
    for place, cause in enumerate(chosen.causes):
        if cause.effect not in TURNING:
            continue
        joint = subject.joints.index(cause.location)
        size = float(np.sqrt(judge.shown(chosen, place).max()))

        def trace(signals: Signals, joint: int = joint) -> dict[str, np.ndarray]:
            rows = np.zeros((len(nuisance.WAYS) + 1, *signals.position.shape))
            at_once = sliding(signals)[:, joint]
            rows[:-1, :, joint] = [
                nuisance.stop(signals.position[:, joint], way) - at_once for way in nuisance.WAYS
            ]
            rows[-1, :, joint] = (
                np.tanh(
                    signals.velocity[:, joint] / max(float(subject.friction_speed[joint]), GENTLE)
                )
                - at_once
            )
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
    """Share of what the chosen causes leave, in squares over the rows with excess, that something
    further closes.
    """
    after, further = float(judge.gap(known.square, rows)), float(judge.gap(held.square, rows))
    return 1 - (further / max(after, 1e-12)) ** 2


def instead(judge: Judge, chosen: Model, rows: np.ndarray, single: float) -> tuple[Told, ...]:
    """Shapes that predict more than the chosen causes do, without them: then the causes only stood
    for the shape.

    Several causes must each be worth it beside a shape, as they must beside each other; a shape
    must be worth more than one cause. Causes that scale believed torques pay for it (`endogenous`),
    a share of the needed one does not: between these it does not count.

    Args:
        judge: of the models.
        chosen: causes.
        rows: that count for the gap.
        single: gain of the best cause alone.
    """
    if not chosen.causes:
        return ()
    rules = judge.thresholds
    needed = max(
        chosen.gain - rules.second_evident * (len(chosen.causes) - 1), single + rules.beyond_evident
    )
    paid = max(0.0, -Design(judge.base, chosen.causes).scaled(chosen.fit.phi))
    return tuple(
        t._replace(gain=max(t.gain - chosen.gain, PASSES * rules.beyond_evident))
        for t in beside(judge, judge.nothing, rows)
        if t.gain > needed + (paid if t.shape.name == shape.OF_LOAD else 0.0)
    )


def tells(rules: Thresholds, chosen: Model, shaped: Sequence[Told]) -> bool:
    """Whether the best shape speaks against causes, or against none."""
    if not shaped or shaped[0].faint:
        return False
    return shaped[0].gain > rules.beyond_evident and shaped[0].closed > rules.beyond * max(
        len(chosen.causes), 1
    )
