"""What a motion can tell: Fisher information of the effects' traces, how well each is known, and
which pairs look alike.

Around an effect at its usual size, its trace is taken as linear in its parameters: the block of an
(effect, place) holds the derivative of the trace by each parameter, and the trace itself. With
noise of standard deviation s, correlated over a time T, in each row of the residuals, the
information of all blocks together is the Gram matrix

    F = sum over rows and ticks of  J^T J  step / (2 T s^2),

and Fs of several motions add up. Everything else follows from F alone: the standard deviation of a
parameter while the effect's others are fitted; how many of its own standard deviations an effect of
usual size stands out; how many are left of it after a rival has explained what it can,
d^2 = F_aa - F_ab F_bb^-1 F_ba; and the smallest principal angle between two blocks.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.series import low_passed
from hyperleg_design.gap.effects.strength import joint_strength, motor_strengths
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals.signals import Signals

NOISE = 0.01
"""Noise of a residual over the strength of its joint or motor [-]; assumed, of the order of torque
estimates from currents."""
NOISE_TIME = 0.05
"""Over which that noise is correlated [s]; assumed: residuals of robots are not white."""
BAND = 25.0
"""Of the traces that count [Hz]."""
STEP = 0.1
"""Step of finite differences over the scale of a parameter [-]."""
RANK = 1e-9
"""Least eigenvalue of a block that counts, over its largest [-]; derived: below it, rounding."""
SMALLEST = 1e-12
"""The same, where a block holds next to nothing at all [squared standard deviations]; assumed."""
REST = 1e-7
"""Least share of the square of a column that other columns leave [-]; derived: below it, rounding.
"""
Place = tuple[str, str]
"""Effect and location of a cause."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """The blocks of all effects at all places of one robot, side by side in `c` columns."""

    places: tuple[Place, ...]
    start: tuple[int, ...]
    """First column of each; its parameters, then its trace at the usual size."""
    parameters: tuple[tuple[str, ...], ...]
    """Names, a place each."""
    values: tuple[np.ndarray, ...]
    """At which each was linearised."""

    @property
    def columns(self) -> int:
        """The number of columns of all blocks."""
        return self.start[-1] + len(self.parameters[-1]) + 1 if self.places else 0

    def span(self, place: Place) -> np.ndarray:
        """Find the columns of a place's parameters.

        Args:
            place: effect and location.

        Returns:
            Their indices.
        """
        at = self.places.index(place)
        return np.arange(self.start[at], self.start[at] + len(self.parameters[at]))

    def trace(self, place: Place) -> int:
        """Find the column of a place's trace.

        Args:
            place: effect and location.

        Returns:
            Its index.
        """
        at = self.places.index(place)
        return self.start[at] + len(self.parameters[at])


def blocks_of(subject: Subject, effects: Iterable[str] | None = None) -> Blocks:
    """Lay out the columns of a robot's effects.

    Args:
        subject: the robot.
        effects: identifiers; all that can sit on the robot by default.

    Returns:
        The blocks.
    """
    places: list[Place] = []
    start: list[int] = []
    names: list[tuple[str, ...]] = []
    values: list[np.ndarray] = []
    column = 0
    for identifier in effects if effects is not None else EFFECTS:
        effect = EFFECTS[identifier]
        for location in effect.locations(subject):
            places.append((identifier, location))
            start.append(column)
            names.append(tuple(p.name for p in effect.parameters))
            values.append(effect.example(location, subject))
            column += len(effect.parameters) + 1
    return Blocks(tuple(places), tuple(start), tuple(names), tuple(values))


def information(signals: Signals, blocks: Blocks, *, noise: float = NOISE) -> np.ndarray:
    """Compute the Fisher information of one motion.

    Args:
        signals: of the motion.
        blocks: of its robot.
        noise: standard deviation over the strength of joints and motors [-].

    Returns:
        The information, `(c, c)`.
    """
    subject = signals.subject
    scales = {"motion": noise * joint_strength(subject), "drive": noise * motor_strengths(subject)}
    scales = {name: scale for name, scale in scales.items() if name in signals.residual}
    every = max(int(0.5 / (2 * BAND * signals.step)), 1)
    known = {name: np.isfinite(signals.residual[name]) & signals.valid[:, None] for name in scales}
    shape = (len(signals.time[::every]), blocks.columns)
    rows = {name: np.zeros((scale.size, *shape), np.float32) for name, scale in scales.items()}
    for start, (effect, location), operating_point in zip(
        blocks.start, blocks.places, blocks.values, strict=True
    ):
        derivatives = _block(EFFECTS[effect], signals, location, operating_point)
        for name in derivatives.keys() & scales.keys():
            block = derivatives[name]
            for row in np.flatnonzero(np.any(block != 0, (0, 1))):
                known_ticks, values = known[name][:, row], block[..., row]
                values = np.where(known_ticks & np.isfinite(values), values, 0.0)
                decimated = (
                    low_passed(values, signals.step, BAND)[:, ::every] * known_ticks[::every]
                )
                columns = slice(start, start + len(block))
                rows[name][row, :, columns] = decimated.T / scales[name][row]
    total = np.zeros((blocks.columns, blocks.columns))
    for part in rows.values():
        for jacobian in part:
            nonzero = np.flatnonzero(np.any(jacobian != 0, 0))
            total[np.ix_(nonzero, nonzero)] += (
                jacobian[:, nonzero].T.astype(float) @ jacobian[:, nonzero]
            )
    return total * (signals.step * every / (2 * NOISE_TIME))


def _block(
    effect: Effect, signals: Signals, location: str, values: np.ndarray
) -> dict[str, np.ndarray]:
    """By residual: derivatives of an effect's trace by each parameter, times the parameter's scale,
    and the trace at the values `(parameters + 1, t, rows)`.
    """
    subject = signals.subject
    count = len(values)
    size = scales_of(effect, location, subject, values)
    low, high = effect.bounds(location, subject)
    tried = np.repeat(values[None], 2 * count + 1, 0)
    for p in range(count):
        tried[2 * p, p] = min(values[p] + STEP * size[p], high[p])
        tried[2 * p + 1, p] = max(values[p] - STEP * size[p], low[p])
    width = (
        tried[2 * np.arange(count), np.arange(count)]
        - tried[2 * np.arange(count) + 1, np.arange(count)]
    )
    scale = np.divide(size, width, out=np.zeros(count), where=width > 0)
    block = {}
    for residual_name, traces in effect.trace(signals, location, tried).items():
        slopes = (traces[0 : 2 * count : 2] - traces[1 : 2 * count : 2]) * scale[:, None, None]
        block[residual_name] = np.concatenate([slopes, traces[-1:]])
    return block


def scales_of(effect: Effect, location: str, subject: Subject, values: np.ndarray) -> np.ndarray:
    """Compute the size of each parameter by which derivatives are taken: its usual distance, or its
    value where that is less.

    Args:
        effect: the effect.
        location: where it sits.
        subject: the robot.
        values: of the parameters.

    Returns:
        The sizes, `(parameters,)`.
    """
    usual = np.abs(effect.usual(location, subject))
    return np.where(values == 0, usual, np.minimum(usual, np.abs(values)))


def standard_deviations(
    gram: np.ndarray, blocks: Blocks, place: Place, subject: Subject
) -> dict[str, float]:
    """Compute the standard deviations of an effect's parameters while its others are fitted.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        place: effect and location.
        subject: the robot.

    Returns:
        Deviations by parameter, in its unit; infinite where these data do not show one.
    """
    effect = EFFECTS[place[0]]
    scale = scales_of(effect, place[1], subject, blocks.values[blocks.places.index(place)])
    span = blocks.span(place)
    part = gram[np.ix_(span, span)]
    deviations = {}
    for at, name in enumerate(blocks.parameters[blocks.places.index(place)]):
        others = np.arange(len(span)) != at
        left = _left(part, at, np.flatnonzero(others))
        deviations[name] = float(scale[at] / np.sqrt(left)) if left > 0 else float("inf")
    return deviations


def strength(gram: np.ndarray, blocks: Blocks, place: Place) -> float:
    """Compute how far an effect of usual size stands out of the noise.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        place: effect and location.

    Returns:
        The distance [standard deviations].
    """
    return float(np.sqrt(max(gram[blocks.trace(place), blocks.trace(place)], 0.0)))


def distinction(gram: np.ndarray, blocks: Blocks, place: Place, rivals: Sequence[Place]) -> float:
    """Compute how far an effect of usual size stands out after rivals of any size have explained
    what they can.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        place: effect and location.
        rivals: effects and locations.

    Returns:
        The distance [standard deviations].
    """
    span = np.concatenate([blocks.span(rival) for rival in rivals])
    return float(np.sqrt(_left(gram, blocks.trace(place), span)))


def principal_angle(gram: np.ndarray, blocks: Blocks, place: Place, rival: Place) -> float:
    """Compute the smallest angle between what two effects can leave in the residuals.

    Args:
        gram: Fisher information, `(c, c)`.
        blocks: of the robot.
        place: effect and location of the one.
        rival: effect and location of the other.

    Returns:
        The angle [rad]; pi/2 where either leaves nothing.
    """
    a, b = _basis(gram, blocks.span(place)), _basis(gram, blocks.span(rival))
    if a.shape[1] == 0 or b.shape[1] == 0:
        return float(np.pi / 2)
    cosine = np.linalg.svd(
        a.T @ gram[np.ix_(blocks.span(place), blocks.span(rival))] @ b, compute_uv=False
    )[0]
    return float(np.arccos(min(cosine, 1.0)))


def _basis(gram: np.ndarray, span: np.ndarray) -> np.ndarray:
    """Columns that make a block orthonormal `(k, rank)`."""
    values, axes = np.linalg.eigh(gram[np.ix_(span, span)])
    good = values > max(RANK * values[-1], SMALLEST)
    return np.asarray(axes[:, good] / np.sqrt(values[good]))


def _left(gram: np.ndarray, column: int, span: np.ndarray) -> float:
    """Square of what is left of one column after the others' best explanation."""
    whole = float(gram[column, column])
    if not len(span) or whole <= 0:
        return max(whole, 0.0)
    basis = _basis(gram, span)
    explained = basis.T @ gram[span, column]
    left = whole - float(explained @ explained)
    return left if left > REST * whole else 0.0


def summed(grams: Mapping[str, np.ndarray], names: Iterable[str]) -> np.ndarray:
    """Sum the information of several motions.

    Args:
        grams: information by motion.
        names: of the motions.

    Returns:
        The sum, `(c, c)`.
    """
    chosen = [grams[name] for name in names]
    return np.asarray(np.sum(chosen, 0)) if chosen else np.zeros_like(next(iter(grams.values())))
