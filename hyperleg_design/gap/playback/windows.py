"""Windows of a log that are predicted one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.gap.signals.signals import Signals


@dataclass(frozen=True, eq=False)
class Windows:
    """Stretches of one log, all of one length."""

    start: np.ndarray
    """First tick of each `(w,)`."""
    length: int
    """Ticks predicted after the first."""

    @property
    def ticks(self) -> np.ndarray:
        """All ticks of all windows `(w, length + 1)`."""
        return np.asarray(self.start[:, None] + np.arange(self.length + 1))


def short_windows(signals: Signals, duration: float = 0.25) -> Windows:
    """Choose windows of one length, end to end, that hold valid ticks only.

    Args:
        signals: conditioned log.
        duration: of each window [s].

    Returns:
        The windows.

    Raises:
        InputError: the log has no valid stretch that long.
    """
    length = max(round(duration / signals.step), 1)
    total = np.concatenate([[0], np.cumsum(signals.valid)])
    starts = np.arange(0, len(signals.time) - length, length)
    starts = starts[total[starts + length + 1] - total[starts] == length + 1]
    if not len(starts):
        raise InputError(
            signals.log.name, "t", duration, "is longer than any stretch of this log without gaps"
        )
    return Windows(starts, length)


def whole_log(signals: Signals) -> Windows:
    """Choose one window from the first valid tick to the last.

    Args:
        signals: conditioned log.

    Returns:
        The window.

    Raises:
        InputError: no tick is valid.
    """
    valid = np.flatnonzero(signals.valid)
    if len(valid) < 2:
        remedy = "ticks are fit for use: the log is all gaps, or too short"
        raise InputError(signals.log.name, "t", len(valid), remedy)
    return Windows(valid[:1], int(valid[-1] - valid[0]))
