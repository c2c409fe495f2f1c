"""A newcomer's log from blocks of columns."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from hyperleg_design.validation.benchmark.case import Recording


def recorded(
    label: str,
    clock: np.ndarray,
    blocks: Iterable[tuple[str, Sequence[str], np.ndarray]],
    joints: Sequence[str],
    stiffness: Iterable[float],
    damping: Iterable[float],
    **metadata: object,
) -> Recording:
    """Write a log that declares the gains of its controllers.

    Args:
        label: name of the log.
        clock: time of each row `(t,)` [s].
        blocks: kind of signal, names of its columns, and values `(t, columns)`.
        joints: that the controllers hold.
        stiffness: of the controllers, one a joint [Nm/rad].
        damping: of the controllers, one a joint [Nms/rad].
        metadata: what else it declares.

    Returns:
        The log.
    """
    signals: dict[str, np.ndarray] = {}
    for kind, names, values in blocks:
        signals |= {f"{kind}/{name}": values[:, i] for i, name in enumerate(names)}
    gains = {
        joint: [float(k), float(d)] for joint, k, d in zip(joints, stiffness, damping, strict=True)
    }
    return Recording(label, clock, signals, {"gains": gains, **metadata})
