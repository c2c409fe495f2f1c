"""The term of the likelihood for effects that scale the measured torque, which is an endogenous
regressor.

A closed loop gives whatever torque is needed, model errors e included. The trace of an effect that
takes a share of the believed torque contains that share of e, so that least squares would always
scale torques down. The change of variables supplies what is missing: with u = (1 + a phi) believed
- needed, the density of the believed torque is p(u) (1 + a phi), so the log-likelihood has the
further term n mean log(1 + a phi). Causes that scale one torque share one term, because a smaller
torque constant and another ratio could together take away all of a torque of which each takes a
part. Where a joint's torque is smaller than the expected noise, a larger torque gains nothing: the
gain would only show that the expected noise is too large.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.strength import motor_strength
from hyperleg_design.gap.inference.samples import Samples
from hyperleg_design.gap.inference.shrinking import Shrinking, shrinking
from hyperleg_design.gap.inference.smoothing import smoothing
from hyperleg_design.gap.signals.signals import Signals

FAINT = 0.5
"""Believed torque over the expected noise, root mean square, up to which a larger torque gains
nothing [-]; from 1 on it gains all, and linearly between."""
LEAST = 0.05
"""Least factor on a torque of which the logarithm is taken [-]."""
SMALL = 1e-3
"""Step of a command's finite difference over the torque that its motor is made for [-]."""
TICKS = 200
"""Ticks of a log, evenly spaced, over which the mean is taken."""


@dataclass(frozen=True, eq=False)
class Factor:
    """How causes scale believed torques: 1 + level + slope phi, phi being one parameter of each."""

    parameter: int
    slope: np.ndarray
    """At some ticks `(causes, t)`, over the usual sizes of the parameters."""
    number: float
    """Independent numbers in the rows that it scales."""
    shows: float = 1.0
    """Share of a gain that counts."""
    row: int = 0
    """Row of the joint that it scales most."""
    level: np.ndarray = field(default_factory=lambda: np.zeros(1))
    """At these ticks `(t,)` or `(1,)`."""
    alone: bool = False
    """Whether it is one of several of a cause, so that each counts in its own row alone."""

    def log(self, phi: np.ndarray) -> float:
        """Compute the term of the log-likelihood: n times the mean logarithm of the factor.

        Args:
            phi: parameters in usual sizes `(causes,)`.

        Returns:
            The term [nat]; of a gain only the share `shows`.
        """
        term = self.number * float(np.mean(np.log(self._left(phi))))
        return self.shows * term if term > 0 else term

    def slopes(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute derivatives of `log`.

        Args:
            phi: parameters in usual sizes `(causes,)`.

        Returns:
            The gradient `(causes,)`, and the negative Hessian `(causes, causes)`.
        """
        ratio = self.slope / self._left(phi)
        ticks = ratio.shape[1]
        return self.number * (ratio.sum(1) / ticks), self.number * (ratio @ ratio.T) / ticks

    def _left(self, phi: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(1 + self.level + phi @ self.slope, LEAST))


def joined(
    factors: Sequence[tuple[int, Factor | Shrinking]],
) -> list[tuple[list[int], Factor | Shrinking]]:
    """Factors of which those that scale the same torque are one.

    Args:
        factors: places of their parameters in a stack of causes, and they themselves.

    Returns:
        Places of the parameters of each, in the order that it takes them.
    """
    groups: list[tuple[list[int], Factor | Shrinking]] = []
    same: dict[int, list[tuple[int, Factor]]] = {}
    for place, term in factors:
        if isinstance(term, Factor):
            same.setdefault(term.row, []).append((place, term))
        else:
            groups.append(([place], term))
    for own in same.values():
        terms = [term for _, term in own]
        longest = max(terms, key=lambda term: (term.slope.shape[1], term.number))
        ticks = longest.slope.shape[1]  # logs under test come first in all of them
        level, slope = np.zeros(ticks), np.zeros((sum(len(t.slope) for t in terms), ticks))
        row = 0
        for term in terms:
            level[: term.slope.shape[1]] += term.level
            slope[row : row + len(term.slope), : term.slope.shape[1]] = term.slope
            row += len(term.slope)
        whole = replace(longest, slope=slope, level=level, shows=min(term.shows for term in terms))
        groups.append(([place for place, _ in own], whole))
    return groups


def factors_of(
    samples: Samples,
    effect: str,
    location: str,
    usual: np.ndarray,
    values: np.ndarray | None = None,
) -> tuple[Factor | Shrinking, ...]:
    """Compute the terms of the likelihood of an effect at a place: how it scales torques that the
    residual of motion trusts, holds them back, or takes noise along in its trace.

    Args:
        samples: of the logs.
        effect: its identifier.
        location: its place.
        usual: sizes of its parameters `(k,)`.
        values: of its parameters, on which the terms of a nonlinear effect depend `(k,)`.

    Returns:
        The terms; none where it does nothing of this.
    """
    subject = samples.filtered_logs[0].signals.subject
    scaling = WEIGHED[effect]
    if values is not None:
        for term in (shrinking, smoothing):
            if (noise := term(samples, scaling, location, usual, values)) is not None:
                return (noise,)
    if values is not None and scaling.holds_back:
        return held_back(samples, scaling, location, values)
    if scaling.scales == "motor":
        motor = subject.motors.index(location)
        joint = subject.main_joint(motor)
    elif scaling.scales == "joint":
        joint = subject.joints.index(location)
        motor = int(np.argmax(np.abs(subject.joint_from_motor[joint])))
    else:
        return ()
    row = samples.motion_row(joint)
    if row is None or (not scaling.scales_measured and samples.measures(motor)):
        return ()
    if values is not None and not _moves(samples, scaling, location, values, joint):
        return ()
    number = float(samples.share[samples.row == row].sum())
    slopes = [_slope(s.signals, scaling, motor, joint) for s in samples.filtered_logs]
    slope = usual[0] * np.concatenate(slopes)[None]
    return (Factor(0, slope, number, _shows(samples, row, motor, joint), row),)


def _moves(
    samples: Samples, scaling: Effect, location: str, values: np.ndarray, joint: int
) -> bool:
    """Whether an effect at a motor shows in the motion of a joint, as it does unless the torque is
    measured behind the gear.
    """
    logs = [log.signals for log in samples.filtered_logs]
    if all(signals.behind_gears is None for signals in logs):
        return True
    usual = scaling.usual(location, logs[0].subject)
    shape = [parameter.shape for parameter in scaling.parameters]
    tried = np.where(shape, values, values + usual)[None]
    traces = (scaling.trace(signals, location, tried).get("motion") for signals in logs)
    return any(trace is not None and np.nan_to_num(trace[..., joint]).any() for trace in traces)


def held_back_in_all(
    samples: Samples, effect: Effect, location: str, values: np.ndarray
) -> list[Factor]:
    """As `held_back`, of the size of the whole trace at some values.

    Args:
        samples: of the logs.
        effect: of the catalogue.
        location: its place.
        values: of its parameters `(k,)`.

    Returns:
        One a joint.
    """
    return [
        Factor(0, -lost[:1], number, 1.0, row, alone=True)
        for row, number, lost in _lost(samples, effect, location, values[None])
    ]


def held_back(
    samples: Samples, effect: Effect, location: str, values: np.ndarray
) -> tuple[Factor, ...]:
    """Of an effect that holds torques back, linearised at some values: how much of a small change
    of what controllers ask for arrives at each joint whose torque nobody measures.

    Args:
        samples: of the logs.
        effect: of the catalogue.
        location: its place.
        values: of its parameters `(k,)`.

    Returns:
        One a joint and parameter, the first of each joint with the level.
    """
    subject = samples.filtered_logs[0].signals.subject
    usual, nulls = effect.usual(location, subject), effect.nulls
    low, high = effect.bounds(location, subject)
    step = effect.steps(location, subject)
    step = np.where(values + step <= high, step, -step)
    free = [i for i, p in enumerate(effect.parameters) if not p.shape and low[i] < high[i]]
    settings = np.stack([values, *(values + step[i] * np.eye(len(values))[i] for i in free)])
    factors = []
    for row, number, lost in _lost(samples, effect, location, settings):
        slopes = [(lost[0] - lost[1 + k]) * usual[i] / step[i] for k, i in enumerate(free)]
        phi = (values - nulls) / usual
        level = -lost[0] - sum(phi[i] * slope for i, slope in zip(free, slopes, strict=True))
        for i, slope in zip(free, slopes, strict=True):
            own = level if i == free[0] else 0 * level
            factors.append(Factor(i, slope[None], number, 1.0, row, own, alone=True))
    return tuple(factors)


def _lost(
    samples: Samples, effect: Effect, location: str, settings: np.ndarray
) -> list[tuple[int, float, np.ndarray]]:
    """Rows of joints that an effect holds torque back from, their independent numbers, and the
    share of a small change of commands that does not arrive, at some ticks `(settings, t)`.
    """
    subject = samples.filtered_logs[0].signals.subject
    joints = np.argmax(np.abs(subject.joint_from_motor), 0)  # that each motor moves most
    unmeasured = [motor for motor in range(len(joints)) if not samples.measures(motor)]
    each = [
        _missing(log.signals, effect, location, settings, unmeasured, joints)
        for log in samples.filtered_logs
    ]
    missing = np.concatenate(each, -1)
    rows = []
    for joint in np.unique(joints[unmeasured]).tolist():
        row = samples.motion_row(joint)
        lost = missing[joints[unmeasured] == joint].mean(0)
        if row is not None and lost.any():
            rows.append((row, float(samples.share[samples.row == row].sum()), lost))
    return rows


def _missing(
    signals: Signals,
    effect: Effect,
    location: str,
    settings: np.ndarray,
    motors: Sequence[int],
    joints: np.ndarray,
) -> np.ndarray:
    """Share of a small change of each motor's command that does not arrive at its joint, at some
    ticks `(motors, settings, t)`.
    """
    ticks = slice(None, None, max(len(signals.time) // TICKS, 1))
    share = np.zeros((len(motors), len(settings), len(signals.time[ticks])))
    rows = effect.trace(signals, location, settings).get("motion")
    if signals.command is None or rows is None:
        return share
    for place, motor in enumerate(motors):
        small = SMALL * motor_strength(signals.subject, motor)
        more = signals.command.copy()
        more[:, motor] += small
        moved = effect.trace(replace(signals, command=more), location, settings)["motion"]
        joint = joints[motor]
        over = small * signals.subject.joint_from_motor[joint, motor]
        share[place] = (moved - rows)[:, ticks, joint] / over
    return np.clip(np.nan_to_num(share), 0.0, 1.0)


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
