"""Slippery ground: the ratio of tangential force to load of feet that slide.

A pad that sticks may have any tangential force within its friction cone, and one that creeps, in
rubber as in soft contacts, has one that grows with its speed. But a foot that slides has the same
ratio of tangential force to load at any speed: the friction coefficient mu, which some tenths of a
second tell to a few per cent. Masses, drives and soles do not enter. The friction pyramid of a
simulator has another ratio in every direction, and one along its edges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects.ground.ground_friction import USUAL, GroundFriction
from hyperleg_design.gap.inference.detectors.underfoot import Underfoot
from hyperleg_design.gap.inference.intervals import NORMAL
from hyperleg_design.gap.inference.rules import GroundRules
from hyperleg_design.gap.results.diagnosis import Value
from hyperleg_design.gap.signals.ground import LOADED, footings
from hyperleg_design.gap.signals.signals import Signals

EFFECT = GroundFriction.identifier
SLIPS = "slips"


@dataclass(frozen=True, eq=False)
class _Sliding:
    """A foot's contacts at the ticks `k` at which they slide, in one log; of its loads, the larger
    half, which noise of forces changes least.
    """

    load: np.ndarray
    ratio: np.ndarray
    """Of tangential force to load; on a pyramid of friction, where that is more alike, of the sum
    of the force's parts along its edges, which is the same in all directions."""
    speed: np.ndarray
    """Against the tangential force [m/s]."""
    time: float
    """For which the foot slides [s]."""
    loaded: np.ndarray
    """Ratio at all loaded ticks `(n,)`."""


def slips(
    signals: Sequence[Signals], references: Sequence[Signals], rules: GroundRules
) -> tuple[Underfoot, ...]:
    """Feet that slide on another ground than the nominal one, those that do so longest first.

    Args:
        signals: logs to be diagnosed.
        references: logs of the healthy robot; a ground that they slid on, too, is none of these.
        rules: from when on a foot slides.
    """
    feet = signals[0].subject.feet
    feet_that_slide = [
        _slip(foot, place, signals, references, rules) for place, foot in enumerate(feet)
    ]
    return tuple(
        sorted(
            (foot for foot in feet_that_slide if foot is not None),
            key=lambda foot: (-foot.weight, foot.foot),
        )
    )


def _slip(
    foot: str,
    place: int,
    signals: Sequence[Signals],
    references: Sequence[Signals],
    rules: GroundRules,
) -> Underfoot | None:
    logs = _all_sliding(signals, place, rules)
    ratio = _coefficient(logs, rules)
    if ratio is None:
        return None
    ground = footings(signals[0])[place]
    ratios = np.concatenate([slides.ratio for slides in logs])
    healthy = _coefficient(_all_sliding(references, place, rules), rules)
    usual, unsure = (ground.friction, USUAL) if healthy is None else (healthy, rules.day * USUAL)
    scale = ratio / usual
    if abs(scale - 1) < rules.slippery * USUAL:
        return None
    parts = [(slides.load, slides.ratio) for slides in logs if slides.time >= rules.least_time]
    if len(parts) < 2:
        loads = np.concatenate([slides.load for slides in logs])
        parts = list(
            zip(*(np.split(values, [len(ratios) // 2]) for values in (loads, ratios)), strict=True)
        )
    load, own_ratios = (np.concatenate(values) for values in zip(*parts, strict=True))
    others = [
        float(np.median(np.concatenate([r for i, (_, r) in enumerate(parts) if i != left_out])))
        for left_out in range(len(parts))
    ]
    size = float(np.sqrt(np.mean((load * (own_ratios - usual)) ** 2)))
    left = float(
        np.sqrt(np.mean((load * (own_ratios - np.repeat(others, [len(r) for _, r in parts]))) ** 2))
    )
    reach = NORMAL * scale * float(np.hypot(unsure, _spread(own_ratios) / 2))
    value = Value(scale, max(scale - reach, 0.0), scale + reach, "")
    time = sum(slides.time for slides in logs)
    sentence = f"slides for {time:.2g} s with a tangential force of {ratio:.3g} times its load"
    return Underfoot(
        EFFECT, foot, {"scale": value}, SLIPS, sentence, time, size, min(left, size), "N"
    )


def _coefficient(logs: Sequence[_Sliding], rules: GroundRules) -> float | None:
    """The ratio of all that slides; None where that is little, or not one ratio, or less than what
    sticks.
    """
    if sum(slides.time for slides in logs) < rules.least_time:
        return None
    ratio, speed, loaded = (
        np.concatenate([getattr(slides, name) for slides in logs])
        for name in ("ratio", "speed", "loaded")
    )
    middle, (slower, faster) = float(np.median(ratio)), np.percentile(speed, [10, 90])
    if (
        faster < rules.speeds * slower
        or middle <= 0
        or _spread(ratio) > rules.same
        or float(np.mean(loaded > rules.beyond * middle)) > rules.seldom
    ):
        return None
    return middle


def _spread(values: np.ndarray) -> float:
    low, middle, high = np.percentile(values, [25, 50, 75])
    return float((high - low) / middle)


@dataclass(frozen=True, eq=False)
class Contacts:
    """A foot's `c` contacts with the ground at the ticks of a log: its pads, or itself where only
    its force is known.
    """

    load: np.ndarray
    ratio: np.ndarray
    """Of tangential force to load."""
    along_edges: np.ndarray
    """Parts of the force along a pyramid's edges over the load, as in `_Sliding`."""
    against: np.ndarray
    """Speed against the tangential force [m/s]."""
    slides: np.ndarray
    loaded: np.ndarray
    """Whether each contact slides, and whether it bears load `(t, c)` each."""


def contacts(signals: Signals, place: int, rules: GroundRules) -> Contacts | None:
    """How a foot is pushed and moves; None where forces or the base's velocity are unknown.

    Args:
        signals: of a log.
        place: of the foot.
        rules: from when on a contact slides.
    """
    feet = footings(signals)
    if not feet:
        return None
    foot = feet[place]
    by_pad = bool(np.isfinite(foot.pad_force[foot.judged]).any())
    force, slide = (
        (foot.pad_force, foot.pad_slide) if by_pad else (foot.force[:, None], foot.slide[:, None])
    )
    load, size = force[..., 2], np.linalg.norm(force[..., :2], axis=-1)
    known = np.isfinite(force).all(-1) & np.isfinite(slide).all(-1)
    known &= (signals.valid & foot.settled)[:, None]
    loaded = known & (np.nan_to_num(load) > LOADED)
    with np.errstate(divide="ignore", invalid="ignore"):
        way = force[..., :2] / size[..., None]
        against = -(slide * way).sum(-1)
        across = np.linalg.norm(slide + against[..., None] * way, axis=-1)
        slides = loaded & (against > rules.slides) & (against > rules.straight * across)
        edges = np.abs(force[..., :2]).sum(-1) / load
        in_contact = Contacts(load, size / load, edges, against, slides, loaded)
    return in_contact if loaded.any() else None


def _all_sliding(signals: Sequence[Signals], place: int, rules: GroundRules) -> list[_Sliding]:
    """When a foot slides in those logs in which it does."""
    logs = (_sliding(log, place, rules) for log in signals)
    return [sliding for sliding in logs if sliding is not None]


def _sliding(signals: Signals, place: int, rules: GroundRules) -> _Sliding | None:
    """When a foot slides in a log, if it does."""
    of = contacts(signals, place, rules)
    if of is None or not of.slides.any():
        return None
    large = of.load >= np.median(of.load[of.loaded])
    slides, loaded = of.slides & large, of.loaded & large
    time = float(slides.any(1).sum()) * signals.step
    if not time:
        return None
    pyramid = footings(signals)[place].law.weakest < 1
    by_edges = pyramid and _spread(of.along_edges[slides]) <= _spread(of.ratio[slides])
    ratio = of.along_edges if by_edges else of.ratio
    sliding = of.load[slides], ratio[slides], of.against[slides]
    return _Sliding(*sliding, time, ratio[loaded])
