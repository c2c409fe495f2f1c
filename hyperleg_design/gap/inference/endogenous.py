"""Effects that scale the torque which the residual itself is made of, and what keeps them from
explaining noise away.

A closed loop gives whatever torque is needed, model errors e included. An effect that takes a share
of the believed torque for its own trace takes that share of e along, so that least squares would
always rather scale torques down. The density of the believed torque has the missing term: with u =
(1 + a phi) believed - needed, it is p(u) (1 + a phi), so the log-likelihood gains n mean log(1 + a
phi). Causes that scale the same torque add up in it: a smaller torque constant and another ratio
could together take away all of a torque of which each takes a part. A joint whose torque is less
than the floor gains nothing so: that would only tell that the floor is high.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.placing import is_measured
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.inference.shrinking import Shrinking, shrinking
from hyperleg_design.gap.signals.signals import Signals

FAINT = 0.5
"""Believed torque over the floor, root mean square, up to which a larger torque gains nothing; from
the floor on all of it."""
LEAST = 0.05
"""Factor below which the logarithm is cut."""
TICKS = 200
"""Ticks of a log that stand for all."""


@dataclass(frozen=True, eq=False)
class Factor:
    """How causes scale believed torques: 1 + slope phi, phi being one parameter of each."""

    parameter: int
    slope: np.ndarray
    """At some ticks `(causes, t)`, over the usual sizes of the parameters."""
    number: float
    """Independent numbers in the rows that it scales."""
    shows: float = 1.0
    """Share of a gain that counts."""
    row: int = 0
    """Row of the joint that it scales most."""

    def log(self, phi: np.ndarray) -> float:
        """N mean log of the factor, of parameters `(causes,)`."""
        found = self.number * float(np.mean(np.log(self._left(phi))))
        return self.shows * found if found > 0 else found

    def slopes(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First derivatives of `log` `(causes,)`, and its second ones with the sign turned."""
        ratio = self.slope / self._left(phi)
        return self.number * ratio.mean(1), self.number * (ratio @ ratio.T) / ratio.shape[1]

    def _left(self, phi: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(1 + phi @ self.slope, LEAST))


def joined(
    factors: Sequence[tuple[int, Factor | Shrinking]],
) -> list[tuple[list[int], Factor | Shrinking]]:
    """Factors of which those that scale the same torque are one.

    Args:
        factors: places of their parameters in a stack of causes, and they themselves.

    Returns:
        Places of the parameters of each, in the order that it takes them.
    """
    found: list[tuple[list[int], Factor | Shrinking]] = []
    same: dict[int, list[tuple[int, Factor]]] = {}
    for place, term in factors:
        if isinstance(term, Factor):
            same.setdefault(term.row, []).append((place, term))
        else:
            found.append(([place], term))
    for own in same.values():
        terms = [term for _, term in own]
        longest = max(terms, key=lambda term: (term.slope.shape[1], term.number))
        ticks = longest.slope.shape[1]  # logs under test come first in all of them
        slope = [np.pad(term.slope, ((0, 0), (0, ticks - term.slope.shape[1]))) for term in terms]
        whole = replace(
            longest, slope=np.concatenate(slope), shows=min(term.shows for term in terms)
        )
        found.append(([place for place, _ in own], whole))
    return found


def factor(
    samples: Samples,
    effect: str,
    location: str,
    usual: np.ndarray,
    values: np.ndarray | None = None,
) -> Factor | Shrinking | None:
    """Of an effect at a place, at its values where they matter; None where it scales no torque that
    the residual trusts.
    """
    subject = samples.filtered_logs[0].signals.subject
    scaling = WEIGHED[effect]
    if values is not None and (noise := shrinking(samples, scaling, location, usual, values)):
        return noise
    if scaling.scales == "motor":
        motor = subject.motors.index(location)
        joint = int(np.argmax(np.abs(subject.joint_from_motor[:, motor])))
    elif scaling.scales == "joint":
        joint = subject.joints.index(location)
        motor = int(np.argmax(np.abs(subject.joint_from_motor[joint])))
    else:
        return None
    rows = [
        i for i, r in enumerate(samples.rows) if r.residual_name == "motion" and r.column == joint
    ]
    if not rows:
        return None
    if not scaling.scales_measured and any(
        is_measured(s.signals, motor) for s in samples.filtered_logs
    ):
        return None
    number = float(samples.share[samples.row == rows[0]].sum())
    slopes = [_slope(s.signals, scaling, motor, joint) for s in samples.filtered_logs]
    slope = usual[0] * np.concatenate(slopes)[None]
    return Factor(0, slope, number, _shows(samples, rows[0], motor, joint), rows[0])


def _shows(samples: Samples, row: int, motor: int, joint: int) -> float:
    """How much of a gain counts, by the torque that a motor gives a joint over the floor of its
    row, 0 to 1.
    """

    def trace(signals: Signals) -> dict[str, np.ndarray]:
        given = np.zeros((1, *signals.position.shape))
        given[0, :, joint] = (
            np.nan_to_num(signals.believed[:, motor])
            * signals.subject.joint_from_motor[joint, motor]
        )
        return {"motion": given}

    columns = samples.columns(trace, 1)
    if columns is None:
        return 0.0
    own = samples.row == row
    over = float(
        np.sqrt(
            np.average(np.square(columns[0, own] / samples.floor[own]), weights=samples.share[own])
        )
    )
    return float(np.clip((over - FAINT) / (1 - FAINT), 0.0, 1.0))


def _slope(signals: Signals, effect: Effect, motor: int, joint: int) -> np.ndarray:
    """Change of the factor with the parameter, at some ticks."""
    slope = np.broadcast_to(effect.torque_slope(signals, motor, joint), signals.time.shape)
    return slope[:: max(len(signals.time) // TICKS, 1)]
