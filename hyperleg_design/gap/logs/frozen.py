"""Stretches of a log in which a position sensor is stuck."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.logs.log import Log

JUMP = 0.03
"""By which a position may come back from being frozen [rad]."""
STUCK = 0.5
"""Time without any change that is noteworthy while the joint is driven [s]."""


def frozen(log: Log, joint: str) -> slice | None:
    """Find the longest stretch in which a position does not change though its joint turns or is
    driven.

    A joint that sticks moves on gently; a sensor that was stuck comes back with a jump.

    Args:
        log: the log.
        joint: name of the joint.

    Returns:
        Rows of the stretch; None where there is none.
    """
    values, target, speed = (
        log.column(f"{kind}/{joint}") for kind in ("position", "position_target", "velocity")
    )
    known = np.isfinite(values)
    if known.sum() < 2 or np.nanmax(values) == np.nanmin(values):
        return None
    start, stop = _longest_run(values)
    length = float(log.time[stop - 1] - log.time[start])
    if length < STUCK or not known[start]:
        return None
    turned = (
        float(np.nanmedian(np.abs(speed[start:stop]))) * length
        if np.isfinite(speed[start:stop]).any()
        else 0.0
    )
    driven, during = (
        float(np.nanmax(x) - np.nanmin(x)) if np.isfinite(x).any() else 0.0
        for x in (target, target[start:stop])
    )
    jump = abs(float(values[stop] - values[stop - 1])) if stop < len(values) else 0.0
    steps = np.abs(np.diff(values[known]))
    usual = max(JUMP, 5 * float(np.percentile(steps, 99)))
    return (
        slice(start, stop)
        if turned > 0.2 or jump > usual or (driven > 0.2 and during > 0.6 * driven)
        else None
    )


def _longest_run(values: np.ndarray) -> tuple[int, int]:
    """Rows of the longest stretch without any change, `[start, stop)`."""
    edges = np.flatnonzero(np.concatenate([[True], np.diff(values) != 0, [True]]))
    longest = int(np.argmax(np.diff(edges)))
    return int(edges[longest]), int(edges[longest + 1])
