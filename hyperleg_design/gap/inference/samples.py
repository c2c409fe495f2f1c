"""All logs of a diagnosis as one list of samples over their floor, and the sums of products that
every fit is made of.

A *group* is one row in one band, pooled over the logs, its rare episodes of much larger residuals
apart; the noise of a group is one unknown scale on its floor. A *part* is a stretch of one log;
parts are dealt to folds twice: `BLOCKS` deals stretches of every log, `LOGS` whole logs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.signals.filtering import traced

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.filtering import FilteredLog, Row
    from hyperleg_design.gap.signals.signals import Signals

FOLDS = 5
MOST_PARTS = 20
BLOCKS, LOGS = 0, 1
"""Ways to hold out."""
OF_EPISODES = 0.15
"""What numbers in episodes count for, over others: drives at their limits and collisions are
nobody's model."""
BLOCK = 1.0
"""Length of the blocks that the bootstrap draws [s]."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Samples of one row of one log in one band and one part, `[start, stop)` of all."""

    start: int
    stop: int
    group: int
    part: int


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
    row: np.ndarray
    """Place in `rows` `(S,)`."""
    group: np.ndarray
    part: np.ndarray
    block: np.ndarray
    """`(S,)` each."""
    where: tuple[tuple[slice, ...], ...]
    """Of each log and each row of its filtered log."""
    pieces: tuple[Piece, ...]
    group_row: np.ndarray
    group_band: np.ndarray
    """`(G,)` each."""
    episodic: np.ndarray
    """Groups of episodes `(G,)` of bool."""
    time: np.ndarray
    """From the beginning of its log `(S,)` [s]."""
    session: np.ndarray
    """Of each part `(P,)`."""
    fold: np.ndarray
    """Of each part `(2, P)`, by way of holding out."""
    log: np.ndarray
    """Of each part `(P,)`."""

    @property
    def groups(self) -> int:
        """G."""
        return len(self.group_row)

    def folds(self, way: int) -> int:
        """Number of folds."""
        return int(self.fold[way].max()) + 1

    @property
    def sessions(self) -> int:
        """Number of sessions."""
        return int(self.session.max()) + 1

    @property
    def weight(self) -> np.ndarray:
        """What samples are multiplied by before products are taken `(S,)`."""
        return np.asarray(np.sqrt(self.share) / self.floor)

    def columns(
        self, trace: Callable[[Signals], Mapping[str, np.ndarray]], count: int
    ) -> np.ndarray | None:
        """Samples of `count` traces `(count, S)`, in their units; None where no log shows any of
        them.
        """
        found = None
        for filtered_log, places in zip(self.filtered_logs, self.where, strict=True):
            for row, values in traced(filtered_log, trace(filtered_log.signals)).items():
                if found is None:
                    found = np.zeros((count, len(self.value)))
                found[:, places[row]] = values
        return found


def gather(
    filtered_logs: Sequence[FilteredLog],
    floors: Sequence[Sequence[np.ndarray]],
    sessions: Sequence[int],
    information: float,
    episode: np.ndarray | None = None,
) -> Samples:
    """Samples of all logs.

    Args:
        filtered_logs: one a log.
        floors: of each log, of each of its rows `(samples,)`.
        sessions: number of the session of each log, from 0.
        information: share of what would be independent numbers in white noise that counts as such.
        episode: samples that belong to episodes `(S,)` of bool.
    """
    keys = list(
        dict.fromkeys(
            (r.residual_name, r.column) for filtered_log in filtered_logs for r in filtered_log.rows
        )
    )
    rows = tuple(
        next(r for s in filtered_logs for r in s.rows if (r.residual_name, r.column) == key)
        for key in keys
    )
    deal = _parts(filtered_logs)
    groups: dict[tuple[int, int, bool], int] = {}
    parts: dict[tuple[int, int], int] = {
        (log, chunk): i
        for i, (log, chunk) in enumerate((g, c) for g, n in enumerate(deal) for c in range(n))
    }
    table: list[list[np.ndarray]] = [[] for _ in range(8)]
    where, pieces, start, blocks = [], [], 0, 0
    for number, filtered_log in enumerate(filtered_logs):
        places = []
        duration = float(filtered_log.signals.time[-1] - filtered_log.signals.time[0])
        for place, row in enumerate(filtered_log.rows):
            band, time, share = filtered_log.labels(place)
            share = share * information
            if episode is not None:
                share = np.where(episode[start : start + len(band)], OF_EPISODES * share, share)
            overall = keys.index((row.residual_name, row.column))
            group = np.empty(len(band), int)
            apart = (
                np.zeros(len(band), bool) if episode is None else episode[start : start + len(band)]
            )
            for b in np.unique(band).tolist():
                for flag in (False, True):
                    mine = (band == b) & (apart == flag)
                    if mine.any():
                        group[mine] = groups.setdefault((overall, b, flag), len(groups))
            chunk = np.minimum((time / duration * deal[number]).astype(int), deal[number] - 1)
            part = np.array([parts[number, c] for c in range(deal[number])])[chunk]
            residual = filtered_log.signals.residual[row.residual_name][:, row.column]
            edges = np.flatnonzero(np.diff(group) | np.diff(part)) + 1
            for low, high in zip(np.r_[0, edges], np.r_[edges, len(group)], strict=True):
                if high > low:
                    pieces.append(
                        Piece(start + int(low), start + int(high), int(group[low]), int(part[low]))
                    )
            values = filtered_log.sample(place, residual[None])[0]
            for column, found in zip(
                table,
                (
                    values,
                    floors[number][place],
                    share,
                    np.full(len(band), overall),
                    group,
                    part,
                    blocks + (time / BLOCK).astype(int),
                    time,
                ),
                strict=True,
            ):
                column.append(found)
            places.append(slice(start, start + len(band)))
            start += len(band)
        blocks += int(duration / BLOCK) + 1
        where.append(tuple(places))
    joined = [np.concatenate(column) if column else np.zeros(0) for column in table]
    key_of = sorted(groups, key=groups.__getitem__)
    log_of = np.array([log for log, _ in parts])
    whole = FOLDS if len(filtered_logs) > FOLDS else max(len(filtered_logs), 1)
    fold = np.stack([[(chunk + log) % FOLDS for log, chunk in parts], log_of % whole])
    if len(filtered_logs) < 2:
        fold[1] = fold[0]
    return Samples(
        tuple(filtered_logs),
        rows,
        joined[0],
        joined[1],
        joined[2],
        joined[3].astype(int),
        joined[4].astype(int),
        joined[5].astype(int),
        joined[6].astype(int),
        tuple(where),
        tuple(pieces),
        np.array([r for r, *_ in key_of]),
        np.array([b for _, b, _ in key_of]),
        np.array([e for *_, e in key_of], bool),
        joined[7],
        np.array(sessions)[log_of],
        fold,
        log_of,
    )


def _parts(filtered_logs: Sequence[FilteredLog]) -> list[int]:
    """Stretches that each log is cut into: five of a short one, ten of a long one, no more than is
    needed of many.
    """
    most = max(MOST_PARTS // len(filtered_logs), 1)
    found = []
    for filtered_log in filtered_logs:
        duration = float(filtered_log.signals.time[-1] - filtered_log.signals.time[0])
        wanted = FOLDS if duration < 30 else 2 * FOLDS
        found.append(wanted if wanted <= most else (FOLDS if most >= FOLDS else most))
    return found
