"""Landmarks of human walking: joint angles at the moments of the gait cycle at which textbooks
state them, the shape of the vertical force over a contact, the order of its events and the ankle's
push-off.

Angles are flexion positive, as a person reads them: knee flexion, ankle dorsiflexion (the joint's
own angle is positive in plantar flexion). A contact lasts from touchdown to toe-off. Values to
compare with: Perry and Burnfield, Gait Analysis, 2nd edition, 2010.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.evaluation.motion.impact import low_pass
from hyperleg_design.evaluation.motion.steps import foot_contacts, mean_of

if TYPE_CHECKING:
    from hyperleg_design.evaluation.motion.gait import Steps
    from hyperleg_design.evaluation.protocol import Events
    from hyperleg_design.evaluation.rollout import Trial

MIDSTANCE = (0.3, 0.7)
"""Share of the contact that counts as mid-stance [-]; assumed."""
PUSH_OFF = 0.7
"""Share of the contact from which it is push-off [-]; assumed."""
SHAPE_POINTS = 101
"""Samples of a contact's normalised force."""
SHAPE_CUTOFF = 10.0
"""Cut-off of the force before its humps are looked for [Hz]; assumed: a step's two humps have some
3 Hz, the ringing of the soft contacts 15 Hz and more."""
HUMP_DEPTH = 0.05
"""How far the force must sink between two humps, below the lower one [body weights]; assumed."""

LANDMARKS = (
    "knee_touchdown",
    "knee_midstance",
    "knee_swing",
    "ankle_dorsiflexion",
    "event_order",
    "force_humps",
    "push_off_force",
    "ankle_push_off_power",
)
"""Measures of `landmark_measures`."""


def landmark_measures(trial: Trial, steps: Steps, events: Events) -> dict[str, float]:
    """Means over the contacts of both feet.

    Args:
        trial: a recorded walk.
        steps: those that count; contacts that the record cuts are left out.
        events: thresholds of contacts.

    Returns:
        By name: `knee_touchdown`, `knee_midstance` (mean over `MIDSTANCE`), `knee_swing` (largest
        flexion of the swing that follows) and `ankle_dorsiflexion` (largest in the contact) [rad];
        `event_order`, the share of contacts with heel strike, foot flat, heel off and toe off in
        that order; `force_humps`, the humps of the mean contact's vertical force; `push_off_force`,
        its last hump [body weights]; `ankle_push_off_power`, which the motors give the ankle pitch
        joint during push-off, mean [W]. NaN where there is nothing to measure, as on limbs
        without knee and ankle.
    """
    layout = trial.layout
    if not {"knee", "ankle_pitch"} <= set(layout.own_joints) or len(layout.feet) != len(
        layout.limbs
    ):
        return dict.fromkeys(LANDMARKS, np.nan)  # no leg of a human's kind
    contacts = foot_contacts(trial, events)
    force = low_pass(trial.foot_load, trial.time_step, SHAPE_CUTOFF, 4)
    names = layout.own_joints
    rows, shapes = [], []
    for i in np.flatnonzero(steps.toe_off > 0):
        foot, down, up = int(steps.foot[i]), int(steps.touchdown[i]), int(steps.toe_off[i])
        side = slice(foot * layout.leg_joints, (foot + 1) * layout.leg_joints)
        knee, ankle = (
            side.start + names.index("knee"),
            side.start + names.index("ankle_pitch"),
        )
        later = steps.touchdown[(steps.foot == foot) & (steps.touchdown > up)]
        middle = [down + int(share * (up - down)) for share in MIDSTANCE]
        push = slice(down + int(PUSH_OFF * (up - down)), up)
        flexion, plantar = trial.joint_position[:, knee], trial.joint_position[:, ankle]
        power = trial.driven_joint_torque[push, ankle] * trial.joint_velocity[push, ankle]
        rows.append(
            (
                flexion[down],
                flexion[slice(*middle)].mean(),
                flexion[up : later[0]].max() if len(later) else np.nan,
                -plantar[down:up].min(),
                float(in_order(contacts.heel[down:up, foot], contacts.forefoot[down:up, foot])),
                power.mean(),
            )
        )
        place = np.linspace(down, up - 1, SHAPE_POINTS)
        shapes.append(np.interp(place, np.arange(down, up), force[down:up, foot]))
    if not rows:
        return dict.fromkeys(LANDMARKS, np.nan)
    table = np.array(rows).T
    humps = force_humps(np.mean(shapes, 0) / layout.weight)
    return {
        "knee_touchdown": mean_of(table[0]),
        "knee_midstance": mean_of(table[1]),
        "knee_swing": mean_of(table[2]),
        "ankle_dorsiflexion": mean_of(table[3]),
        "event_order": mean_of(table[4]),
        "force_humps": float(len(humps)),
        "push_off_force": float(humps[-1]) if len(humps) > 1 else np.nan,
        "ankle_push_off_power": mean_of(table[5]),
    }


def in_order(heel: np.ndarray, forefoot: np.ndarray) -> bool:
    """Decide whether a contact has heel strike, foot flat, heel off and toe off in this order.

    Args:
        heel: whether the heel is loaded, at each sample of the contact, `(t,)`.
        forefoot: whether the rest of the foot is, `(t,)`.

    Returns:
        True if the order is that of a human step.
    """
    heels, fores = np.flatnonzero(heel), np.flatnonzero(forefoot)
    if not len(heels) or not len(fores):
        return False
    return bool(heels[0] < fores[0] <= heels[-1] < fores[-1])


def force_humps(force: np.ndarray, depth: float = HUMP_DEPTH) -> np.ndarray:
    """Find the humps of a force: maxima that stand out from the lower values on both sides.

    They are found by their prominence (`scipy.signal.find_peaks`).

    Args:
        force: over one contact [body weights], `(t,)`.
        depth: least prominence [body weights].

    Returns:
        Heights of the humps in order of time [body weights], `(humps,)`.
    """
    from scipy.signal import find_peaks

    padded = np.concatenate([[0.0], force, [0.0]])
    return padded[find_peaks(padded, prominence=depth)[0]]
