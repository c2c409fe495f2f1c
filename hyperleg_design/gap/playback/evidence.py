"""What a diagnosis looks like on one log: the residual as it is, what the named causes explain of
it, and what is left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.effects import effect
from hyperleg_design.gap.effects.series import low_passed
from hyperleg_design.gap.inference.interactions import Acting, acting_on, left_by
from hyperleg_design.gap.model.joint_units import unit_at
from hyperleg_design.gap.playback.sheets import root_mean_square
from hyperleg_design.gap.signals.resting import moving_ticks, sticking
from hyperleg_design.gap.signals.signals import OF_MOTORS, RESIDUALS, Signals, row_names, row_units

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
    """Times of the samples `(t,)` [s]."""
    before: np.ndarray
    """Residual of the nominal model, less what stands in the references, too `(t, r)`; NaN where
    it cannot be told, and where a joint may stick."""
    explained: np.ndarray
    """What the causes leave there `(t, r)`."""
    speed: np.ndarray
    """Of the same joints or motors `(t, r)`; NaN where a row has none."""
    units: tuple[str, ...]
    """Of the residual, by row."""
    speed_units: tuple[str, ...]
    """Of the speed, by row."""

    @property
    def after(self) -> np.ndarray:
        """Residual that the causes leave, `(t, r)`."""
        return self.before - self.explained

    @property
    def worst(self) -> int:
        """Index of the row of which causes explain most; where they explain nothing, of the row
        with the largest residual.
        """
        sizes = np.nan_to_num(root_mean_square(self.explained))
        return (
            int(np.argmax(sizes))
            if sizes.any()
            else int(np.nanargmax(root_mean_square(self.before)))
        )


def evidence(
    signals: Signals,
    causes: Sequence[Mapping[str, Any]],
    residual_name: str = "motion",
    standing: Sequence[Mapping[str, Any]] = (),
) -> Evidence:
    """Compute a residual and what causes explain of it, on one log.

    Args:
        signals: of the log.
        causes: as `diagnosis.json` lists them: `effect`, `location`, and `parameters` with their
            `value`.
        residual_name: one that the log allows.
        standing: what the references show already, which is taken off the residual.

    Returns:
        The residual before and after, and what is explained.
    """
    new, lacking = _acting(causes, False), _acting(standing, True)
    residual = signals.residual[residual_name] - _explained(signals, lacking, new, residual_name)
    explained = _explained(signals, new, lacking, residual_name)
    known = np.isfinite(residual) & np.isfinite(explained) & signals.valid[:, None]
    if residual_name == "motion":
        known = moving_ticks(signals, known, sticking(signals))
    before = low_passed(np.where(known, residual, 0.0).T, signals.step, BAND).T
    explained_in_band = low_passed(np.where(known, explained, 0.0).T, signals.step, BAND).T
    speed = np.full(residual.shape, np.nan)
    if residual_name == "motion":
        speed = signals.velocity
    elif residual_name in OF_MOTORS:
        speed = signals.velocity @ signals.subject.joint_from_motor
    empty = np.where(known, 0.0, np.nan)
    subject, (kind, _) = signals.subject, RESIDUALS[residual_name]
    names = row_names(subject, residual_name)
    return Evidence(
        log=signals.log.name,
        residual_name=residual_name,
        rows=names,
        time=signals.time,
        before=before + empty,
        explained=explained_in_band + empty,
        speed=speed,
        units=row_units(subject, residual_name),
        speed_units=tuple(unit_at(subject, kind, row, "rad/s") for row in names),
    )


def _acting(causes: Sequence[Mapping[str, Any]], standing: bool) -> list[Acting]:
    """Causes as `diagnosis.json` lists them, with their values; parameters without one are null."""
    acting = []
    for cause in causes:
        name, given = str(cause["effect"]), cause["parameters"]
        values = [
            float(given[p.name]["value"]) if p.name in given else p.null
            for p in effect(name).parameters
        ]
        acting.append(Acting(name, str(cause["location"]), standing, np.array(values)))
    return acting


def _explained(
    signals: Signals, causes: Sequence[Acting], others: Sequence[Acting], residual_name: str
) -> np.ndarray:
    """Sum of the traces of causes beside others in one residual `(t, r)`."""
    explained = np.zeros_like(signals.residual[residual_name])
    for cause in causes:
        own = effect(cause.effect)
        acted_on = acting_on(own, cause.standing, [*causes, *others])
        seen = left_by(signals, own, acted_on) if acted_on else signals
        traces = signals.shown(own.trace(seen, cause.location, cause.values[None]))
        trace = traces.get(residual_name)
        if trace is not None:
            explained = explained + trace[0]
    return explained
