"""Steps of a recorded trial, from the loads on its sole pads, and what is measured on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.evaluation.motion import gait
from hyperleg_design.evaluation.motion.feet import foot_places
from hyperleg_design.evaluation.motion.impact import impacts, low_pass

if TYPE_CHECKING:
    from hyperleg_design.evaluation.protocol import Events, Impact
    from hyperleg_design.evaluation.rollout import Trial
    from hyperleg_design.simulation.layout import Layout


@dataclass(frozen=True, eq=False)
class Contacts:
    """What stands on the floor, `(t, F)` each; of a biped left and right."""

    feet: np.ndarray
    """Whole foot."""
    heel: np.ndarray
    """Pads behind the ankle."""
    forefoot: np.ndarray
    """Pads before the ankle, toe included."""


_KEPT: WeakKeyDictionary[Trial, tuple[Events, Contacts, gait.Steps]] = WeakKeyDictionary()
"""Contacts and steps of trials that are still in use: several measures need them."""


def foot_contacts(trial: Trial, events: Events) -> Contacts:
    """Find the contacts of feet, heels and forefeet by the thresholds of a protocol.

    Gaps and short contacts are filled for whole feet only.

    Args:
        trial: the recorded trial.
        events: thresholds in body weights, and the shortest contact and gap.

    Returns:
        The contacts at each sample, not to be written into.
    """
    return _contacts_and_steps(trial, events)[0]


def _contacts_and_steps(trial: Trial, events: Events) -> tuple[Contacts, gait.Steps]:
    """Contacts and steps, found once for each trial and protocol."""
    cached = _KEPT.get(trial)
    if cached is None or cached[0] is not events:
        contacts = _find_contacts(trial, events)
        steps = gait.find_steps(contacts.feet, contacts.heel, contacts.forefoot, trial.time_step)
        for values in (*vars(contacts).values(), *vars(steps).values()):
            values.flags.writeable = False
        cached = (events, contacts, steps)
        _KEPT[trial] = cached
    return cached[1:]


def _find_contacts(trial: Trial, events: Events) -> Contacts:
    on, off = events.touchdown_load * trial.layout.weight, events.lift_load * trial.layout.weight
    behind = trial.layout.pad_position[:, 0] < 0
    shortest = max(1, round(events.shortest / trial.time_step))

    def loads(chosen: np.ndarray) -> np.ndarray:
        return np.stack(
            [
                trial.pad_load[:, chosen & (trial.layout.pad_foot == foot)].sum(-1)
                for foot in range(len(trial.layout.feet))
            ],
            -1,
        )

    return Contacts(
        feet=gait.stance(trial.foot_load, on, off, shortest),
        heel=gait.stance(loads(behind), on, off),
        forefoot=gait.stance(loads(~behind), on, off),
    )


def measured_steps(trial: Trial, events: Events) -> gait.Steps:
    """Find all steps of a trial.

    Args:
        trial: the recorded trial.
        events: thresholds of the protocol.

    Returns:
        The steps of all feet, not to be written into.
    """
    return _contacts_and_steps(trial, events)[1]


def impact_measures(trial: Trial, steps: gait.Steps, settings: Impact) -> dict[str, float]:
    """Compute the means of the impacts over the touchdowns of all feet.

    Args:
        trial: the recorded trial.
        steps: whose touchdowns count.
        settings: of filter and window.

    Returns:
        `grf_peak` [N], `grf_peak_body_weights` [-], `grf_raw_peak` [N], `grf_loading_rate` [N/s]
        and `grf_impulse` [Ns]; NaN without a touchdown.
    """
    filtered = low_pass(trial.foot_load, trial.time_step, settings.cutoff, int(settings.order))
    each = [
        impacts(
            trial.foot_load[:, f],
            filtered[:, f],
            steps.touchdown[steps.foot == f],
            trial.time_step,
            settings.window,
        )
        for f in range(len(trial.layout.feet))
    ]
    mean = {
        name: mean_of(np.concatenate([getattr(e, name) for e in each]))
        for name in ("peak", "raw_peak", "loading_rate", "impulse")
    }
    return {
        "grf_peak": mean["peak"],
        "grf_peak_body_weights": mean["peak"] / trial.layout.weight,
        "grf_raw_peak": mean["raw_peak"],
        "grf_loading_rate": mean["loading_rate"],
        "grf_impulse": mean["impulse"],
    }


def step_measures(
    trial: Trial, steps: gait.Steps, window: tuple[int, int], events: Events
) -> dict[str, float]:
    """Compute the gait measures of some steps.

    Args:
        trial: the recorded trial.
        steps: that count.
        window: first and last sample of the stretch that they lie in.
        events: thresholds of the protocol.

    Returns:
        The measures by name.
    """
    contacts = foot_contacts(trial, events)
    slip = gait.slip_per_step(
        steps, trial.pad_load, trial.pad_slip, trial.layout.pad_foot, trial.time_step
    )
    places = foot_places(trial, steps.touchdown)[np.arange(len(steps)), steps.foot]
    length, width = gait.step_vectors(steps, places)
    if len(trial.layout.feet) != 2:
        length, width = np.zeros(0), np.zeros(0)  # of a step from one foot to the other
    heeled = has_heels(trial.layout)
    shares = gait.event_shares(steps)
    if not heeled:
        shares["heel_off"] = np.nan
    return {
        "cadence": gait.cadence(steps, trial.time_step),
        "step_length": mean_of(length),
        "step_width": mean_of(width),
        **shares,
        **gait.support_shares(contacts.feet[slice(*window)]),
        "alternation": gait.alternation(steps),
        "heel_lead": mean_of(steps.heel_lead) if heeled else np.nan,
        "heel_or_flat": mean_of((steps.heel_lead >= 0).astype(float)) if heeled else np.nan,
        "slip_per_step": mean_of(slip),
        "foot_drift": mean_of(flat_drift(trial, steps, contacts)),
        "largest_slip": float(np.nanmax(slip)) if np.isfinite(slip).any() else np.nan,
    }


def has_heels(layout: Layout) -> bool:
    """Decide whether every foot has pads both behind and before the joint of its first link.

    Args:
        layout: of the robot.

    Returns:
        True if all feet have a heel and a forefoot.
    """
    behind = layout.pad_position[:, 0] < 0
    return all(
        0 < behind[layout.pad_foot == foot].sum() < np.sum(layout.pad_foot == foot)
        for foot in range(len(layout.feet))
    )


def flat_drift(trial: Trial, steps: gait.Steps, contacts: Contacts) -> np.ndarray:
    """Compute how far each foot moves over the floor while it stands flat.

    The distance is the straight line between the first and the last sample at which heel and
    forefoot both stand. Landing and push-off, where the foot turns about its edges, do not count.
    This is the sliding that an observer would see.

    Args:
        trial: the recorded trial.
        steps: k steps.
        contacts: of feet, heels and forefeet.

    Returns:
        The distance of each step [m], `(k,)`; NaN where the foot never stands flat.
    """
    drift = np.full(len(steps), np.nan)
    flat = contacts.heel & contacts.forefoot
    stretches: list[tuple[int, int]] = []
    rows: list[int] = []
    for i, (foot, down, up) in enumerate(
        zip(steps.foot, steps.touchdown, steps.toe_off, strict=True)
    ):
        standing = down + np.flatnonzero(flat[down : up if up > 0 else len(flat), foot])
        if len(standing) > 1:
            stretches.append((standing[0], standing[-1]))
            rows.append(i)
    places = foot_places(trial, np.array(stretches, int).ravel())
    for row, begin, end in zip(rows, places[::2], places[1::2], strict=True):
        foot = steps.foot[row]
        drift[row] = np.linalg.norm(end[foot] - begin[foot])
    return drift


def mean_of(values: np.ndarray) -> float:
    """Average what could be measured.

    Args:
        values: `(k,)`, NaN where nothing could be measured.

    Returns:
        The mean; NaN if all values are missing.
    """
    values = values[np.isfinite(values)]
    return float(values.mean()) if len(values) else np.nan
