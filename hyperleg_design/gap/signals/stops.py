"""Where the stops of joints may push, with a force that nobody knows."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.subject import Subject

STOP = 0.003
"""Distance from the end of a joint's range within which its stop may push [rad]; assumed, a few
steps of a sensor."""
NO_STOP = 0.1
"""Distance beyond its range that shows that a joint has no stop there [rad]; assumed, more than any
stop gives way."""


def wrong_limits(subject: Subject, position: np.ndarray) -> np.ndarray:
    """Find the joints whose log goes so far beyond the nominal range that there is no stop.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.

    Returns:
        `(n,)`.
    """
    below, above = subject.position_low - NO_STOP, subject.position_high + NO_STOP
    return np.asarray(((position < below) | (position > above)).any(0))


def at_stop(subject: Subject, position: np.ndarray) -> np.ndarray:
    """Find the ticks at which a stop may push on a joint, with a force that nobody knows.

    Args:
        subject: the robot.
        position: [rad], `(t, n)`.

    Returns:
        `(t, n)`.
    """
    beyond = (position < subject.position_low + STOP) | (position > subject.position_high - STOP)
    return np.asarray(beyond & ~wrong_limits(subject, position))
