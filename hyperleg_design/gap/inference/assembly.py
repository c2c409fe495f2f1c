"""From conditioned logs to channels: samples over their noise, nuisance parameters and discrepancy
shapes as columns, and the sums of their products.

Nuisance parameters are columns beside the shapes, each at its usual size, and belong to one
channel alone: a mass that is a little wrong may be so by another share at each joint, which costs
little and keeps the channels independent of each other given the causes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference import noise_model, nuisance
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.channels.channel import Channel
from hyperleg_design.gap.inference.channels.discrepancy import MOTORS, load
from hyperleg_design.gap.inference.channels.rotation import rotated
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.log_set import LogSet, log_set
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.inference.samples import Samples, gather
from hyperleg_design.gap.inference.zeros import Zeros
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.filtering import place_of
from hyperleg_design.gap.signals.signals import OF_SENSORS, Signals
from hyperleg_design.gap.signals.sliding import dry_friction, viscous_friction

MOST_BANDS = 5
"""Bands of a channel, see `filtering.EDGES`."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What causes are judged on."""

    channels: tuple[Channel, ...]
    samples: Samples
    """Of all logs, those under test first."""
    tests: Samples
    """Of the logs under test: the first ones of `samples`."""
    signals: tuple[Signals, ...]
    """Conditioned logs under test."""
    references: tuple[Signals, ...]
    usual: Mapping[tuple[str, str, int], float]
    """Deviation of the usual calibration error of an effect's parameter at a place."""
    moved: tuple[float, ...]
    """Share of the numbers of each channel in which the torque of its drives is more than noise of
    the needed one."""
    expected: tuple[float, ...]
    """Independent numbers that the expected noise of each channel's references counts for."""

    def with_numbers(self, factor: Factor, trace: np.ndarray, standing: bool) -> Factor:
        """Compute what scaling torques costs, as far as they are no noise in the channels that are
        made of them: once in each equation that holds them, in the channel where most of them are.
        A measured torque is compared with what the motion needs, and with what was asked for.
        A larger torque gains in the motion alone: where little of what is asked for is given, as
        by a slow drive, the residual of the drive does not grow with it.

        Where they are scaled in all logs, friction and rotors may be, too, and all that is left to
        gain is noise nearer to the expected one: that counts for nothing, by larger torques or by
        smaller ones.

        Args:
            factor: of a cause.
            trace: that its parameter leaves, in all samples or in those under test `(S,)`.
            standing: whether it acts in all logs.
        """
        numbers: dict[str, tuple[float, int]] = {}  # rows of the tests are the first ones
        for channel, share, expected in zip(self.channels, self.moved, self.expected, strict=True):
            row = place_of(self.samples.rows, channel.residual, channel.column)
            assert row is not None
            place = channel.samples if standing else channel.under_test
            others = not factor.alone and channel.residual in MOTORS
            if row == factor.row or (others and np.any(trace[place] != 0)):
                number = share * float(self.samples.share[place].sum())
                number += expected if standing else 0.0
                kind = channel.residual
                numbers[kind] = max(numbers.get(kind, (0.0, row)), (number, row))
        _, at = max(numbers.values(), default=(0.0, factor.row))
        number = sum(number for number, _ in numbers.values())
        needed = sum(own for kind, (own, _) in numbers.items() if kind not in MOTORS)
        shows = 0.0 if standing else factor.shows * needed / max(number, 1e-300)
        return replace(factor, number=number, row=at, shows=shows)

    def scaled(self, cause: Cause) -> Cause:
        """Give the terms of a cause that scale torques the number of samples that they count for.

        Args:
            cause: linearised on samples of this evidence.

        Returns:
            The cause, with terms as of `with_numbers`.
        """
        return replace(
            cause,
            factors=tuple(
                self.with_numbers(
                    term, cause.compact[[term.parameter]].toarray()[0], cause.standing
                )
                if isinstance(term, Factor)
                else term
                for term in cause.factors
            ),
        )

    def on_all_samples(self, cause: Cause, standing: bool, only: np.ndarray | None = None) -> Cause:
        """A cause whose columns are those of its own logs, with columns of all samples.

        Args:
            cause: linearised on all samples, or on those under test where it acts there alone.
            standing: whether it acts in all logs.
            only: 1 at the samples of the one log in which it acts, 0 elsewhere `(S,)`; None where
                it acts in all logs or in those under test.
        """
        if only is not None:
            constant = cause.constant * only if len(cause.constant) else cause.constant
            own = cause.compact.multiply(only[None]).tocsr()
            cause = replace(cause, compact=own, constant=constant, factors=())
        whole = cause.compact.copy()
        whole.resize(len(cause.nulls), len(self.samples.value))
        if self.references and not standing and cause.linear:
            bounds = WEIGHED[cause.effect].change_bounds(cause.location, self.signals[0].subject)
            low, high = np.where(cause.shape, (cause.low, cause.high), bounds)
            cause = replace(cause, low=low, high=high)
        return self.scaled(
            replace(
                cause,
                compact=whole,
                constant=np.pad(cause.constant, (0, whole.shape[1] - len(cause.constant)))
                if len(cause.constant)
                else cause.constant,
                standing=standing,
            )
        )

    @property
    def weight(self) -> np.ndarray:
        """What a trace is multiplied by before products are taken `(S,)`."""
        return self.samples.weight


def evidence_of(
    tests: Sequence[Signals], references: Sequence[Signals], rules: InferenceRules
) -> Evidence:
    """Channels of all logs.

    Args:
        tests: conditioned logs under test.
        references: conditioned logs of the healthy robot.
        rules: of the inference.

    Raises:
        InputError: no log shows a residual.
    """
    subject, healthy = tests[0].subject, (*references, *tests)[0]
    rubbing = replace(subject, coulomb=dry_friction(healthy), viscous=viscous_friction(healthy))

    errors = nuisance.nuisance_parameters(subject, tests[0].step, bool(references), rubbing)
    errors.sort(key=lambda error: (not error.known, not error.steady))
    zeros = Zeros.of(tests, references, rubbing)
    sets = [log_set(tests, errors, zeros, rules, tested=True)]
    if all(row.residual_name in OF_SENSORS for row in sets[0].samples.rows):
        raise InputError(
            tests[0].log.name,
            "",
            None,
            "has too few ticks of which torques and motion are known: log longer, or more signals",
        )
    if references:
        sets.append(log_set(references, errors, zeros, rules, tested=False))
    usual = {
        (effect.identifier, place, parameter): float(spread)
        for effect in WEIGHED.values()
        for place, spreads in effect.usual_errors(rubbing, tests[0].step).items()
        for parameter, spread in enumerate(spreads)
    }
    keys = [(row.residual_name, row.column) for row in sets[0].samples.rows]
    channels = [_channel(key, sets, rules) for key in keys]
    return Evidence(
        tuple(channel for channel, _ in channels),
        _joined(sets, rules) if references else sets[0].samples,
        sets[0].samples,
        tuple(tests),
        tuple(references),
        zeros.usual_with(usual),
        tuple(moved for _, moved in channels),
        tuple(
            rules.noise.weight * (len(channel.numbers) - len(channel.bands_tested))
            for channel, _ in channels
        ),
    )


def _joined(sets: Sequence[LogSet], rules: InferenceRules) -> Samples:
    """Samples of all sets, one after the other."""
    sessions: list[int] = []
    for logs in sets:
        first = max(sessions, default=-1) + 1
        own = [
            int(logs.samples.session[logs.samples.log == i][0])
            for i in range(len(logs.filtered_logs))
        ]
        sessions += [first + number for number in own]
    return gather(
        [filtered for logs in sets for filtered in logs.filtered_logs],
        [floors for logs in sets for floors in logs.floors],
        sessions,
        rules.noise.information,
    )


class _Cell(NamedTuple):
    """Samples of one session in one band."""

    session: tuple[int, int]
    """Number of the set, and session of the set."""
    band: tuple[int, int]
    """Number of the set, and band."""
    number: float
    """How many independent numbers they count for [-]."""
    places: np.ndarray
    """Of its samples among all."""
    whitened: np.ndarray
    """Columns and residual over the noise `(columns + 1, samples)`."""


def _channel(
    key: tuple[str, int], sets: Sequence[LogSet], rules: InferenceRules
) -> tuple[Channel, float]:
    """A channel, and the share of its numbers under test in which the torque of its drives is more
    than noise of the needed one.
    """
    parts = [(logs, row) for logs in sets if (row := logs.row(key)) is not None]
    present, moved = [logs for logs, _ in parts], 1.0
    columns = _scaled_shapes(key, present, rules)
    if key[0] == "motion":
        load_noise, moved = _load_noise(key, present)
        columns = [np.concatenate(pair) for pair in zip(columns, load_noise, strict=True)]
    cells = [
        cell
        for number, ((logs, row), own) in enumerate(zip(parts, columns, strict=True))
        for cell in _cells(logs, row, own, number, 0 if logs.tested else len(sets[0].samples.value))
    ]
    sessions = sorted({cell.session for cell in cells})
    bands = sorted({cell.band for cell in cells})
    known = sets[0].known
    steady = sets[0].steady if len(sessions) > 1 else known
    white, known, steady = rotated(
        [cell.whitened for cell in cells], known, steady, rules.discrepancy.truncation
    )
    channel = Channel(
        residual=key[0],
        column=key[1],
        name=parts[0][0].samples.rows[parts[0][1]].name,
        products=np.array([cell @ cell.T for cell in white]),
        number=np.array([cell.number for cell in cells]),
        session=np.array([sessions.index(cell.session) for cell in cells]),
        band=np.array([bands.index(cell.band) for cell in cells]),
        frequency=np.array([b for _, b in bands]),
        tested=np.array([number == 0 for number, _ in sessions]),
        places=tuple(cell.places for cell in cells),
        whitened=tuple(white),
        steady=steady,
        known=known,
    )
    return channel, moved


def _scaled_shapes(
    key: tuple[str, int], sets: Sequence[LogSet], rules: InferenceRules
) -> list[np.ndarray]:
    """Columns of the discrepancy of each set, with the deviation that they have at scale 1
    `(columns, S)`.
    """
    shaped = [logs.shapes(key, rules.discrepancy.waves) for logs in sets]
    size = np.mean([square for _, square, _ in shaped], 0)
    strength = float(np.mean([square for *_, square in shaped]))
    if key[0] == "motion":
        strength += float(dry_friction(sets[0].filtered_logs[0].signals)[key[1]]) ** 2
    scale = rules.discrepancy.share * np.sqrt(strength / np.maximum(size, 1e-300))
    scale[size <= 0] = 0.0
    return [columns * scale[:, None] for columns, *_ in shaped]


def _cells(logs: LogSet, row: int, columns: np.ndarray, number: int, first: int) -> Iterator[_Cell]:
    """Cells of one row of a set, which is the one of this `number` and whose samples begin at
    `first` among all.
    """
    samples = logs.samples
    own = np.flatnonzero(samples.row == row)
    whole = np.concatenate([logs.errors[:, own], columns[:, own], samples.value[None, own]])
    whole *= samples.weight[own]
    session = samples.session[samples.part[own]]
    band = samples.group_band[samples.group[own]]
    for s, b in sorted(set(zip(session.tolist(), band.tolist(), strict=True))):
        mine = (session == s) & (band == b)
        numbers = float(samples.share[own[mine]].sum())
        yield _Cell((number, s), (number, b), numbers, first + own[mine], whole[:, mine])


def _load_noise(key: tuple[str, int], sets: Sequence[LogSet]) -> tuple[list[np.ndarray], float]:
    """Columns of the part of the load that is noise or vibration in each band, over all sets
    `(columns, S)` each, and the share of the numbers under test in which the drives' torque is more
    than noise of the needed one.

    Such noise is in the residual and in every trace that holds the load or its derivatives. A cause
    must not gain by it: the load, and its second derivative, have a prior deviation of the share of
    the load that the expected noise is.
    """
    by_set = [np.zeros((2 * MOST_BANDS, len(logs.samples.value))) for logs in sets]
    whole, clean = 0.0, 0.0
    for logs, columns in zip(sets, by_set, strict=True):
        for filtered, places in zip(logs.filtered_logs, logs.samples.where, strict=True):
            place = place_of(filtered.rows, *key)
            if place is None:
                continue
            torque = load(filtered.signals, *key)
            step = filtered.signals.step
            twice = np.gradient(np.gradient(np.nan_to_num(torque), step), step)
            given = applied(
                filtered.signals.subject.joint_from_motor[key[1] : key[1] + 1],
                filtered.signals.believed,
            )[:, 0]
            slow, fast, driven = filtered.sample(place, np.stack([torque, twice, given]))
            feigned, rate = noise_model.of_acceleration(filtered, place)
            needed = feigned + noise_model.of_load(filtered, place)
            expected = logs.samples.floor[places[place]] ** 2
            band = filtered.labels(place)[0]
            for b in np.unique(band).tolist():
                mine = band == b
                share, idle = (
                    min(float(np.mean(noise[mine]) / max(np.mean(torque[mine] ** 2), 1e-300)), 1.0)
                    for noise, torque in ((expected, slow), (needed, driven))
                )
                at = np.arange(places[place].start, places[place].stop)[mine]
                if logs.tested:
                    number = float(logs.samples.share[at].sum())
                    whole = whole + number
                    clean = clean + (1 - idle) * number
                columns[2 * b, at] = share * slow[mine]
                columns[2 * b + 1, at] = share * fast[mine] / float(np.mean(rate[mine]))
    return by_set, clean / max(whole, 1e-300)
