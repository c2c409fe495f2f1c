"""What an added effect changes: how well the simulation replays logs, and what it says of a
policy's walk.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.evaluation import statistics
from hyperleg_design.evaluation.evaluate import evaluate_many
from hyperleg_design.evaluation.measures import measure_of
from hyperleg_design.evaluation.protocol import Protocol
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.playback.overlay import Overlay
from hyperleg_design.gap.playback.replay import best_input, replay
from hyperleg_design.gap.playback.windows import short_windows
from hyperleg_design.gap.signals.signals import Signals
from hyperleg_design.writing import plain

if TYPE_CHECKING:
    from pathlib import Path

COMPARED = (
    "fell",
    "mean_speed",
    "cost_of_transport",
    "battery_cost_of_transport",
    "power",
    "grf_peak",
    "grf_loading_rate",
    "cadence",
    "step_length",
    "double_support",
    "time",
    "mean_deviation",
    "peak_deviation",
)
"""Measures of a walk or a T-test that are set side by side, those that its protocol has."""


@dataclass(frozen=True)
class Replayed:
    """Error of the predicted position of one joint over short windows of all logs, root mean
    square.
    """

    joint: str
    unit: str
    """Unit of the error."""
    before: float
    after: float
    windows: int
    """Lost ones, in which a simulation diverged, left out."""
    follows: str
    """What the replay followed: the torque, or the target and what it does between rows."""


@dataclass(frozen=True)
class Changed:
    """One measure of a policy's trials without and with the effect; the trials begin alike."""

    measure: str
    unit: str
    before: float
    after: float
    """Means over the trials."""
    difference: float
    low: float
    high: float
    """Of after less before, trial by trial, with its 95 % interval; NaN where fewer than two trials
    have both."""
    trials: int


def replayed(signals: Sequence[Signals], overlay: Overlay) -> list[Replayed]:
    """Replay logs without and with an overlay, over short windows that start from the logged
    states.

    Logs do not say what a target does between two rows. Replays that follow targets are made both
    ways, and those of the way that predicts the logs best, without or with the overlay, are told.

    Args:
        signals: conditioned logs of one robot; held-out ones, if the overlay came of logs.
        overlay: causes to add.

    Returns:
        Errors of each joint without and with the overlay.

    Raises:
        InputError: no stretch without gaps, or a place that the robot does not have.
    """
    subject, follows = signals[0].subject, best_input(signals[0])
    ways = {follows: True}
    if follows == "target":
        ways = {"target, kept from row to row": True, "target, moving evenly between rows": False}
    squares = {way: _squares(signals, overlay, keeps) for way, keeps in ways.items()}
    usable = np.isfinite(np.stack(list(squares.values()))).all((0, 1, 3))
    means = {way: values[:, usable].mean(1) for way, values in squares.items()}
    best = min(means, key=lambda way: float(means[way].sum(1).min()))
    root = np.sqrt(means[best])
    return [
        Replayed(
            joint,
            unit_at(subject, "joint", joint, "rad"),
            float(root[0, j]),
            float(root[1, j]),
            int(usable.sum()),
            best,
        )
        for j, joint in enumerate(subject.joints)
    ]


def _squares(signals: Sequence[Signals], overlay: Overlay, keeps_targets: bool) -> np.ndarray:
    """Mean square errors of position without and with an overlay, `(2, windows, joints)` [rad^2];
    NaN where a simulation diverged.
    """
    squares = []
    for run in signals:
        changes: Sequence[Any] = [(), overlay.alterations(run.subject)]
        replays = replay(run, changes, short_windows(run), keeps_targets=keeps_targets)
        position, _ = replays.errors(run)
        squares.append(np.nanmean(position**2, axis=2))
    return np.concatenate(squares, 1)


def walked(
    policy: str | Path,
    overlay: Overlay,
    protocol: Protocol | str | Path | None = None,
    *,
    workers: int = 2,
) -> list[Changed]:
    """Evaluate a policy without and with an overlay, from the same starting states.

    Args:
        policy: ONNX file, or name of a shipped training.
        overlay: causes to add.
        protocol: what suits the policy's task by default.
        workers: processes.

    Returns:
        Measures of the trials without and with the overlay.

    Raises:
        InputError: as `evaluation.evaluate`, or a place that the robot does not have.
    """
    (before,) = evaluate_many([policy], protocol, workers=workers)
    (after,) = evaluate_many([policy], protocol, workers=workers, alterations=overlay.alterations)
    changes = []
    for name in COMPARED:
        if name not in before.measures[0] or name not in after.measures[0]:
            continue
        first, second = before.values(name), after.values(name)
        both = np.isfinite(first) & np.isfinite(second)
        estimate = statistics.estimate([second[both] - first[both]]) if both.sum() > 1 else None
        interval = (estimate.mean, estimate.low, estimate.high) if estimate else (float("nan"),) * 3
        means = _mean(first), _mean(second)
        changes.append(Changed(name, measure_of(name).unit, *means, *interval, int(both.sum())))
    return changes


def _mean(values: np.ndarray) -> float:
    return float(np.nanmean(values)) if np.isfinite(values).any() else float("nan")


def mapping(logs: Sequence[Replayed], walk: Sequence[Changed]) -> dict[str, Any]:
    """Write replays and walks as plain values for a file.

    Args:
        logs: of `replayed`.
        walk: of `walked`.

    Returns:
        Nested mappings.
    """
    rows = {"replayed": [asdict(log) for log in logs], "walked": [asdict(row) for row in walk]}
    return dict(plain(rows))
