"""All logs of a diagnosis as one list of samples, each with the noise that is expected of it.

A *group* is one row of a residual in one frequency band, pooled over the logs. A *part* is a
stretch of one log; the parts of every log are dealt to the folds of the cross-validation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.effects.placing import is_measured
from hyperleg_design.gap.signals.filtering import FilteredLog, Row, place_of, traced
from hyperleg_design.gap.signals.signals import Signals

FOLDS = 5
"""Folds of the cross-validation."""
MOST_PARTS = 20
"""Parts of all logs together, at most."""
BLOCK = 1.0
"""Length of the blocks that the bootstrap draws [s]."""
SLOWEST_BANDS = 3
"""Bands of a channel whose load sizes its discrepancy: in faster ones it is mostly noise."""


@dataclass(frozen=True, eq=False)
class Samples:
    """`S` samples of all logs, in `G` groups and `P` parts."""

    filtered_logs: tuple[FilteredLog, ...]
    rows: tuple[Row, ...]
    """Of all logs together."""
    value: np.ndarray
    """Residual `(S,)` in its unit."""
    floor: np.ndarray
    """Standard deviation expected of it `(S,)`."""
    share: np.ndarray
    """Independent numbers that each stands for `(S,)`."""
    felt: np.ndarray
    """How much of a trace that follows accelerations counts, see `felt_share` `(S,)`."""
    row: np.ndarray
    """Place in `rows` `(S,)`."""
    group: np.ndarray
    part: np.ndarray
    block: np.ndarray
    """`(S,)` each."""
    where: tuple[tuple[slice, ...], ...]
    """Of each log and each row of its filtered log."""
    group_band: np.ndarray
    """`(G,)`."""
    session: np.ndarray
    """Of each part `(P,)`."""
    fold: np.ndarray
    """Of each part `(P,)`."""
    log: np.ndarray
    """Of each part `(P,)`."""

    @property
    def groups(self) -> int:
        """Number G of groups of samples."""
        return len(self.group_band)

    @property
    def folds(self) -> int:
        """Number of folds of the cross-validation."""
        return int(self.fold.max()) + 1

    @property
    def sessions(self) -> int:
        """Number of sessions of recording."""
        return int(self.session.max()) + 1

    @property
    def weight(self) -> np.ndarray:
        """What samples are multiplied by before products are taken `(S,)`."""
        return np.asarray(np.sqrt(self.share) / self.floor)

    def motion_row(self, joint: int) -> int | None:
        """Find the motion of a joint.

        Args:
            joint: index of the joint.

        Returns:
            Its place in `rows`; None where no log has it.
        """
        return place_of(self.rows, "motion", joint)

    def measures(self, motor: int) -> bool:
        """Whether a log measures the torque of a motor.

        Args:
            motor: index of the motor.
        """
        return any(is_measured(log.signals, motor) for log in self.filtered_logs)

    def columns(
        self,
        trace: Callable[[Signals], Mapping[str, np.ndarray]],
        count: int,
        accelerated: bool = False,
    ) -> np.ndarray | None:
        """Samples of `count` traces `(count, S)`, in their units; None where no log shows any of
        them.

        Args:
            trace: of a log.
            count: of the traces.
            accelerated: whether the traces are torques over accelerations, which count as far as
                drives feel them.
        """
        sampled = None
        for filtered_log, places in zip(self.filtered_logs, self.where, strict=True):
            for row, values in traced(filtered_log, trace(filtered_log.signals)).items():
                if sampled is None:
                    sampled = np.zeros((count, len(self.value)))
                sampled[:, places[row]] = values
        return sampled * self.felt if accelerated and sampled is not None else sampled


def gather(
    filtered_logs: Sequence[FilteredLog],
    floors: Sequence[Sequence[np.ndarray]],
    sessions: Sequence[int],
    information: float,
) -> Samples:
    """Samples of all logs.

    Args:
        filtered_logs: one a log.
        floors: of each log, of each of its rows `(samples,)`.
        sessions: number of the session of each log, from 0.
        information: share of what would be independent numbers in white noise that counts as such.
    """
    first: dict[tuple[str, int], Row] = {}
    for row in (row for filtered_log in filtered_logs for row in filtered_log.rows):
        first.setdefault((row.residual_name, row.column), row)
    keys = list(first)
    deal = _parts(filtered_logs)
    groups: dict[tuple[int, int], int] = {}
    chunks = [(log, chunk) for log, count in enumerate(deal) for chunk in range(count)]
    parts = {chunk: i for i, chunk in enumerate(chunks)}
    table: list[list[np.ndarray]] = [[] for _ in range(8)]
    where, start, blocks = [], 0, 0
    for number, filtered_log in enumerate(filtered_logs):
        places = []
        duration = float(filtered_log.signals.time[-1] - filtered_log.signals.time[0])
        for place, row in enumerate(filtered_log.rows):
            band, time, share = filtered_log.labels(place)
            overall = keys.index((row.residual_name, row.column))
            group = np.empty(len(band), int)
            for b in np.unique(band).tolist():
                group[band == b] = groups.setdefault((overall, b), len(groups))
            chunk = np.minimum((time / duration * deal[number]).astype(int), deal[number] - 1)
            part = np.array([parts[number, c] for c in range(deal[number])])[chunk]
            residual = filtered_log.signals.residual[row.residual_name][:, row.column]
            values = filtered_log.sample(place, residual[None])[0]
            block = blocks + (time / BLOCK).astype(int)
            labels = np.full(len(band), overall), group, part, block
            numbers = floors[number][place], share * information, felt_share(filtered_log, place)
            columns = values, *numbers, *labels
            for column, own in zip(table, columns, strict=True):
                column.append(own)
            places.append(slice(start, start + len(band)))
            start += len(band)
        blocks += int(duration / BLOCK) + 1
        where.append(tuple(places))
    joined = [np.concatenate(column) if column else np.zeros(0) for column in table]
    value, floor, share, felt, *indices = joined
    row_of, group_of, part_of, block_of = (index.astype(int) for index in indices)
    log_of = np.array([log for log, _ in parts])
    return Samples(
        filtered_logs=tuple(filtered_logs),
        rows=tuple(first.values()),
        value=value,
        floor=floor,
        share=share,
        felt=felt,
        row=row_of,
        group=group_of,
        part=part_of,
        block=block_of,
        where=tuple(where),
        group_band=np.array([band for _, band in groups]),
        session=np.array(sessions)[log_of],
        fold=np.array([(chunk + log) % FOLDS for log, chunk in parts]),
        log=log_of,
    )


def _parts(filtered_logs: Sequence[FilteredLog]) -> list[int]:
    """Stretches that each log is cut into: five of a short one, ten of a long one, no more than is
    needed of many.
    """
    most = max(MOST_PARTS // len(filtered_logs), 1)
    parts = []
    for filtered_log in filtered_logs:
        duration = float(filtered_log.signals.time[-1] - filtered_log.signals.time[0])
        wanted = FOLDS if duration < 30 else 2 * FOLDS
        parts.append(wanted if wanted <= most else (FOLDS if most >= FOLDS else most))
    return parts


def felt_share(filtered_log: FilteredLog, row: int) -> np.ndarray:
    """Compute how much of the torque that fast motion needs appears in the drives' torque.

    Noise of sensors, and links that swing on their belts, are in the accelerations of a log, but no
    motor gives torque for them. In each fast band the share is the coefficient of the regression of
    the drives' torque on the needed one, from 0 to 1.

    Args:
        filtered_log: of one log.
        row: one of its rows.

    Returns:
        By sample, from 0 to 1, the same all over a band `(samples,)`; 1 of slow bands and of rows
        that are no joints.
    """
    signals, place = filtered_log.signals, filtered_log.rows[row]
    band = filtered_log.labels(row)[0]
    share = np.ones(len(band))
    if place.residual_name != "motion":
        return share
    columns = signals.rigid[:, place.column], signals.residual["motion"][:, place.column]
    needed, left = filtered_log.sample(row, np.stack(columns))
    for fast in np.unique(band[band >= SLOWEST_BANDS]).tolist():
        mine = band == fast
        square = max(float(needed[mine] @ needed[mine]), 1e-300)
        share[mine] = np.clip(1 + float(left[mine] @ needed[mine]) / square, 0.0, 1.0)
    return share
