"""What a diagnosis looks like on one log: the residual as it is, what the named causes explain of
it, and what is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.signals.resting import moving_ticks, sticking
from hyperleg_design.gap.signals.signals import OF_MOTORS, Signals

BAND = 8.0
"""Low-pass for the eye [Hz]; the diagnosis itself chooses a band of its own."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """Traces of one residual of one log, filtered alike; `t` ticks, `r` rows."""

    log: str
    residual_name: str
    rows: tuple[str, ...]
    """Joints, motors, or parts of the base or the feet."""
    time: np.ndarray
    """`(t,)` [s]."""
    before: np.ndarray
    """Residual of the nominal model `(t, r)` [Nm]; NaN where it cannot be told, and where a joint
    may stick."""
    explained: np.ndarray
    """What the causes leave there `(t, r)` [Nm]."""
    speed: np.ndarray
    """Of the same joints or motors `(t, r)` [rad/s]; NaN where a row has none."""

    @property
    def after(self) -> np.ndarray:
        """Residual that the causes leave, `(t, r)` [Nm]."""
        return self.before - self.explained

    @property
    def worst(self) -> int:
        """Row of which causes explain most; where they explain nothing, the one with the largest
        residual.
        """
        made = np.nan_to_num(rms(self.explained))
        return int(np.argmax(made)) if made.any() else int(np.nanargmax(rms(self.before)))


def evidence(
    signals: Signals, causes: Sequence[Mapping[str, Any]], residual_name: str = "motion"
) -> Evidence:
    """Compute a residual and what causes explain of it, on one log.

    Args:
        signals: of the log.
        causes: as `diagnosis.json` lists them: `effect`, `location`, and `parameters` with their
            `value`.
        residual_name: one that the log allows.

    Returns:
        The residual before and after, and what is explained.
    """
    from hyperleg_design.gap.effects import effect

    residual = signals.residual[residual_name]
    explained = np.zeros_like(residual)
    for cause in causes:
        kind = effect(str(cause["effect"]))
        told = cause["parameters"]
        values = np.array(
            [[float(told[p.name]["value"]) if p.name in told else p.null for p in kind.parameters]]
        )
        trace = kind.trace(signals, str(cause["location"]), values).get(residual_name)
        if trace is not None:
            explained = explained + trace[0]
    known = np.isfinite(residual) & np.isfinite(explained) & signals.valid[:, None]
    if residual_name == "motion":
        known = moving_ticks(signals, known, sticking(signals))
    before = _smooth(np.where(known, residual, 0.0), signals.step)
    made = _smooth(np.where(known, explained, 0.0), signals.step)
    subject = signals.subject
    speed = np.full(residual.shape, np.nan)
    rows: tuple[str, ...]
    if residual_name == "motion":
        rows, speed = subject.joints, signals.velocity
    elif residual_name in OF_MOTORS:
        rows, speed = subject.motors, signals.velocity @ subject.joint_from_motor
    elif residual_name == "base":
        rows = tuple(
            f"base {part}"
            for part in ("force x", "force y", "force z", "torque x", "torque y", "torque z")
        )
    else:
        rows = tuple(f"{foot} {axis}" for foot in subject.feet for axis in "xyz")
    empty = np.where(known, 0.0, np.nan)
    return Evidence(
        signals.log.name,
        residual_name,
        tuple(rows),
        signals.time,
        before + empty,
        made + empty,
        speed,
    )


def rms(values: np.ndarray) -> np.ndarray:
    """Compute the root of the mean square of each row, without unknown ticks.

    Args:
        values: `(t, r)`.

    Returns:
        `(r,)`; NaN where nothing is known.
    """
    known = np.isfinite(values)
    count = known.sum(0)
    total = np.where(known, values, 0.0) ** 2
    return np.sqrt(
        np.divide(total.sum(0), count, out=np.full(values.shape[1], np.nan), where=count > 0)
    )


def _smooth(values: np.ndarray, step: float) -> np.ndarray:
    """Second-order Butterworth, forwards and backwards."""
    from scipy.signal import butter, sosfiltfilt

    if 0.45 / step <= BAND or len(values) < 20:
        return values
    return np.asarray(
        sosfiltfilt(
            butter(2, BAND, fs=1 / step, output="sos"),
            values,
            axis=0,
            padlen=min(len(values) - 1, 60),
        )
    )
