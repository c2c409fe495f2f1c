"""Soft ground: how much lower pads stand under more load.

The height of the floor is not known to a millimetre, and errors of encoders and links shift the
height of a foot by about as much at all loads. But the slope of height over load is the compliance
of ground and sole in series, whatever the masses and drives are. A damped ground lags behind its
load, so what goes with the rate at which the pad goes down is taken out of both first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hyperleg_design.gap.effects.ground.ground_compliance import USUAL, GroundCompliance
from hyperleg_design.gap.inference.detectors.underfoot import Underfoot
from hyperleg_design.gap.inference.intervals import NORMAL
from hyperleg_design.gap.inference.rules import GroundRules
from hyperleg_design.gap.results.diagnosis import Value
from hyperleg_design.gap.signals.ground import LOADED, Footing, footings
from hyperleg_design.gap.signals.nominal_ground import Law
from hyperleg_design.gap.signals.signals import Signals

EFFECT = GroundCompliance.identifier
SINKS = "sinks"
DEEPEST = 0.05
"""Depth up to which the nominal ground's force is tabulated [m]."""
FINEST = 1e-4
"""Scatter of a height below which it tells no more [m] (assumed)."""


@dataclass(frozen=True, eq=False)
class Bearing:
    """A pad under load in a log."""

    load: np.ndarray
    height: np.ndarray
    """Over the origin [m]."""
    sink: np.ndarray
    """Rate at which it goes down [m/s]."""
    nominal: np.ndarray
    """Of the nominal ground under that load, from any height [m]; `(k,)` each."""

    def cut(self, part: slice) -> Bearing:
        """Take a part of its ticks.

        Args:
            part: of the ticks.
        """
        return Bearing(self.load[part], self.height[part], self.sink[part], self.nominal[part])

    @cached_property
    def _at_one_rate(self) -> tuple[np.ndarray, np.ndarray]:
        """Load and height about their means, without what goes with the rate of sinking."""
        beside = np.stack([np.ones_like(self.sink), self.sink], 1)
        both = np.stack([self.load, self.height], 1)
        load, height = (both - beside @ np.linalg.lstsq(beside, both, rcond=None)[0]).T
        return load, height

    @property
    def slope(self) -> float:
        """Way down over load, at one rate [m/N]."""
        load, height = self._at_one_rate
        return -float(load @ height / (load @ load))

    @property
    def nominal_slope(self) -> float:
        """Sinking over load by the model's own floor [m/N]."""
        load = self.load - self.load.mean()
        return -float(load @ self.nominal / (load @ load))

    @property
    def weight(self) -> float:
        """What it tells of the slope: 1 over the square of its error [N^2/m^2]."""
        load, height = self._at_one_rate
        left = height + self.slope * load
        return float(load @ load / max(np.mean(left**2), FINEST**2))


def sinks(
    signals: Sequence[Signals], references: Sequence[Signals], rules: GroundRules
) -> tuple[Underfoot, ...]:
    """Feet whose ground gives more than it should, those that sink most first.

    A stiffer ground is not told: models are as soft as their step allows, robots' floors are not.

    Args:
        signals: logs to be diagnosed.
        references: logs of the healthy robot; a ground that gave as much under it, too, is none of
            these.
        rules: from when on a foot sinks.
    """
    feet_that_sink = [
        _sink(foot, place, signals, references, rules)
        for place, foot in enumerate(signals[0].subject.feet)
    ]
    return tuple(
        sorted(
            (foot for foot in feet_that_sink if foot is not None),
            key=lambda foot: (-foot.size, foot.foot),
        )
    )


def _sink(
    foot: str,
    place: int,
    signals: Sequence[Signals],
    references: Sequence[Signals],
    rules: GroundRules,
) -> Underfoot | None:
    logs, before = (
        [_apart(bearings(log, place, rules), rules) for log in some]
        for some in (signals, references)
    )
    pads = [pad for own in logs for pad in own]
    given = _compliance(pads, rules)
    healthy = _compliance([pad for own in before for pad in own], rules)
    if given is None:
        return None
    scale, error = given
    if healthy is not None and healthy[0] > 0:
        error = float(np.hypot(error, scale * healthy[1] / healthy[0])) / healthy[0]
        scale = scale / healthy[0]
    if scale - rules.certain * error < 1 or scale < 1 + rules.soft * USUAL:
        return None
    nominal = float(
        np.average([pad.nominal_slope for pad in pads], weights=[pad.weight for pad in pads])
    )
    usual = nominal * (given[0] / scale)
    slope = nominal * given[0]
    spread = float(
        np.sqrt(np.mean(np.concatenate([(pad.load - pad.load.mean()) ** 2 for pad in pads])))
    )
    parts = logs
    if len(logs) < 2 or any(len(own) < rules.contacts for own in logs):
        parts = [
            [half for pad in pads if (half := _half(pad, late, rules))] for late in (False, True)
        ]
    others = [
        _compliance([pad for o in parts if o is not part for pad in o], rules) for part in parts
    ]
    off = [
        abs(nominal * other[0] - slope) if other is not None else slope - usual for other in others
    ]
    size, left = spread * (slope - usual), spread * float(np.sqrt(np.mean(np.square(off))))
    reach = NORMAL * float(np.hypot(error, rules.pads * scale))
    sentence = (
        f"sinks by {1e3 * slope * spread:.2g} mm with the usual changes of its pads' load, "
        f"{scale:.2g} times as much as it should"
    )
    value = Value(scale, max(scale - reach, 0.0), scale + reach, "")
    return Underfoot(
        EFFECT,
        foot,
        {"scale": value},
        SINKS,
        sentence,
        float(len(pads)),
        size,
        min(left, size),
        "m",
    )


def bearings(signals: Signals, place: int, rules: GroundRules) -> list[Bearing]:
    """Pads of a foot that bear it in a log, those that tell by their load.

    Args:
        signals: of a log.
        place: of the foot.
        rules: from when on a pad tells.
    """
    feet = footings(signals)
    if not feet:
        return []
    foot = feet[place]
    bearing_pads = []
    for pad in range(foot.height.shape[1]):
        load = foot.pad_force[:, pad, 2]
        used = (
            signals.valid
            & foot.settled
            & np.isfinite(foot.height[:, pad])
            & (np.nan_to_num(load) > LOADED)
        )
        if used.sum() >= rules.ticks and float(load[used].std()) >= rules.loads:
            bearing_pads.append(
                Bearing(
                    load[used],
                    foot.height[used, pad],
                    foot.sink[used, pad],
                    -_depth(foot, pad, load[used]),
                )
            )
    return bearing_pads


def _depth(foot: Footing, pad: int, load: np.ndarray) -> np.ndarray:
    """How deep a pad stands in the nominal ground [m]."""
    law, own_pad = foot.law, slice(pad, pad + 1)
    own = Law(
        law.spring[own_pad],
        law.damper[own_pad],
        law.weight[own_pad],
        law.impedance[own_pad],
        law.weakest,
    )
    depth = np.linspace(0, DEEPEST, 2001)
    return np.interp(load, own.force(depth[:, None], np.zeros((len(depth), 1))), depth)


def _compliance(pads: Sequence[Bearing], rules: GroundRules) -> tuple[float, float] | None:
    """Slope over the nominal one of some pads together, and its standard error; None where they are
    few.
    """
    if len(pads) < rules.contacts:
        return None
    weight = np.array([pad.weight for pad in pads])
    each = np.array([pad.slope / pad.nominal_slope for pad in pads])
    mean = float(np.average(each, weights=weight))
    share = weight / weight.sum()
    return mean, float(np.sqrt(np.sum(share**2 * (each - mean) ** 2) * len(pads) / (len(pads) - 1)))


def _apart(pads: Sequence[Bearing], rules: GroundRules) -> list[Bearing]:
    """Pads of a foot in a log, cut into stretches of time where they are too few for a scatter."""
    if not pads or len(pads) >= rules.contacts:
        return list(pads)
    count = -(-rules.contacts // len(pads))
    cut = [
        pad.cut(slice(part[0], part[-1] + 1))
        for pad in pads
        for part in np.array_split(np.arange(len(pad.load)), count)
    ]
    return [pad for pad in cut if float(pad.load.std()) >= rules.loads]


def _half(pad: Bearing, late: bool, rules: GroundRules) -> Bearing | None:
    """First or second half of a pad's ticks, where its load varies enough there."""
    part = slice(len(pad.load) // 2, None) if late else slice(len(pad.load) // 2)
    half = pad.cut(part)
    return half if float(half.load.std()) >= rules.loads else None
