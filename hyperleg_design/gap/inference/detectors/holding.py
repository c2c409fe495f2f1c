"""Friction at rest that logs show without any doubt: a joint that stands still while the torque on
it changes.

What a joint that sticks is held by is no function of the motion, so its rest is left out of the
residuals (`filtering.sticking`). But while it does not move, gravity does not change either: half
the range over which the torque on it rises and falls is friction that it has at least (the bound
|f| <= F of Coulomb's law for rest), whatever load or offset there may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.friction import FRICTION
from hyperleg_design.gap.effects.placing import joint_strength
from hyperleg_design.gap.effects.series import band_limited
from hyperleg_design.gap.inference.detectors.unsettled import in_limit_cycle
from hyperleg_design.gap.logs.sampling import noise
from hyperleg_design.gap.model.friction import turned
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.filtering import CREEP, sticking, stretches

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.base import Prior
    from hyperleg_design.gap.inference.learned import Learned
    from hyperleg_design.gap.inference.model import Model
    from hyperleg_design.gap.inference.nuisance import NuisanceParameter
    from hyperleg_design.gap.signals.signals import Signals

RUBBING = FRICTION - {"viscous_friction"}
"""Effects that hold a joint at rest."""
UNGIVEN = ("command_delay", "torque_saturation")
"""Effects by which a torque that nobody measured is not there while a joint rests: no friction
holds what never came."""
SHORTEST = 0.1
"""Rests that count [s]."""
BAND = 10.0
"""Of the torque on a joint at rest [Hz]; below a third of the log's rate."""
EDGE = 0.01
"""Of a rest, in which the joint may be moving already [s]; two ticks at least."""
ENDS = (3.0, 97.0)
"""Percentiles between which a torque ranges."""
WITHIN = 1.88
"""Standard deviations between which noise lies as often as between `ENDS`."""
OF_LOAD, OF_JOLTS, AFOOT = 0.15, 0.3, 0.5
"""Share of the range of the load, as other joints move, that the model may have wrong; of what of
it is no straight line in time, as other joints knock; and of all of it where a robot stands on its
feet, whose forces are known roughly (assumed)."""
BEYOND, LEAST = 0.25, 0.01
"""Friction beyond the known one that counts: of that, and of the torque that the joint is made for;
belts and drives hold some, too."""
OPEN = 2.0
"""Standard deviations of calibrated friction up to which it is known friction."""

_STUCK: WeakKeyDictionary[Signals, np.ndarray] = WeakKeyDictionary()


def held(signals: Signals) -> np.ndarray:
    """Friction at rest that a log shows at least, by joint `(n,)` [Nm]."""
    return np.array([held_by(signals, joint) for joint in range(len(signals.subject.joints))])


def held_by(signals: Signals, joint: int, without: np.ndarray | float = 0.0) -> float:
    """Friction at rest that a log shows of one joint at least [Nm].

    Args:
        signals: of the log.
        joint: its place.
        without: part of the torque on it that never was there `(t,)` [Nm].
    """
    subject = signals.subject
    friction = subject.coulomb[joint] * turned(
        signals.velocity[:, joint], subject.friction_speed[joint]
    )
    motion = signals.residual["motion"][:, joint] + friction - without
    rest = (
        _stuck(signals)[:, joint]
        & (np.abs(signals.velocity[:, joint]) < CREEP)
        & signals.valid
        & np.isfinite(motion)
    )
    band = min(BAND, 0.3 / signals.step)
    level = noise(motion[rest]) * np.sqrt(2 * band * signals.step)
    around = round(1 / (band * signals.step))
    edge, found = max(2, round(EDGE / signals.step)), 0.0
    for whole in stretches(rest, SHORTEST / signals.step + 2 * edge):
        # the rest alone: what the motion before and after it needs must not leak into it
        part = slice(whole.start + edge, whole.stop - edge)
        torque = band_limited(np.pad(motion[part], around, mode="edge"), signals.step, band)[
            around:-around
        ]
        found = max(
            found,
            _half(torque) - _unsure(signals.rigid[part, joint], subject.floating) - WITHIN * level,
        )
    return float(found)


def _stuck(signals: Signals) -> np.ndarray:
    """Ticks at which joints may stick, however far they have come `(t, n)` of bool; kept while the
    signals live.
    """
    if signals not in _STUCK:
        _STUCK[signals] = sticking(signals, np.inf)
    return _STUCK[signals]


def noticed(
    signals: Sequence[Signals],
    references: Sequence[Signals],
    learned: Sequence[Learned] = (),
    errors: Sequence[NuisanceParameter] = (),
    prior: Prior | None = None,
) -> dict[str, float]:
    """Joints that hold more than the friction that the model has and reference logs show, and by
    how much [Nm].

    Args:
        signals: conditioned logs under test.
        references: conditioned logs of the healthy robot.
        learned: effects that it has already.
        errors: nuisance parameters.
        prior: of these, as reference logs tell them.
    """
    subject = signals[0].subject
    shown = np.zeros(len(subject.joints)) if prior is None else calibrated(errors, prior, signals)
    for one in learned:
        if one.effect in RUBBING:
            shown[subject.joints.index(one.location)] += _given(
                one.effect, one.location, one.values, signals
            )
    known = np.max([subject.coulomb, subject.coulomb + shown, *(held(s) for s in references)], 0)
    shows = np.max([held(s) for s in signals], 0)
    counts = (
        (shows - known > BEYOND * known + LEAST * joint_strength(subject))
        & ~in_limit_cycle(signals)
        & ~subject.passive
    )
    return {subject.joints[j]: float(shows[j] - known[j]) for j in np.flatnonzero(counts).tolist()}


def calibrated(
    errors: Sequence[NuisanceParameter], prior: Prior, signals: Sequence[Signals]
) -> np.ndarray:
    """Friction at rest over the model's that reference logs show, and what they leave open, by
    joint `(n,)` [Nm].

    Of joints of whose friction the model tells nothing; all errors that rub together: which of them
    it is, slow motion hardly tells.
    """
    subject = signals[0].subject
    found = np.zeros(len(subject.joints))
    for place, joint in enumerate(subject.joints):
        rubs = [e.location == joint and e.effect in RUBBING for e in errors]
        row = np.array(
            [
                _given(e.effect, joint, np.array([e.spread]), signals) if r else 0.0
                for e, r in zip(errors, rubs, strict=True)
            ]
        )
        if not subject.coulomb[place]:
            found[place] = row @ prior.mean + OPEN * np.sqrt(row @ prior.covariance @ row)
    return found


def share(model: Model, joint: str, torque: float, signals: Sequence[Signals]) -> float:
    """How much of what a joint holds a model's friction explains, from 0 to 1.

    Args:
        model: of some causes; beside its friction, what motors do not give, see `ungiven`.
        joint: that holds.
        torque: beyond known friction [Nm].
        signals: conditioned logs under test.
    """
    given = ungiven(model, joint, signals)
    for place, cause in enumerate(model.causes):
        if cause.location == joint and cause.effect in RUBBING:
            given += _given(cause.effect, joint, model.values(place), signals)
    return float(np.clip(given / torque, 0.0, 1.0))


def ungiven(model: Model, joint: str, signals: Sequence[Signals]) -> float:
    """How much less a joint holds as its motors never gave what they seem to have given, by a
    model's limits and delays [Nm].
    """
    parts = [(place, cause) for place, cause in enumerate(model.causes) if cause.effect in UNGIVEN]
    if not parts:
        return 0.0
    shows, less, column = 0.0, 0.0, signals[0].subject.joints.index(joint)
    for one in signals:
        missing = np.zeros(len(one.time))
        for place, cause in parts:
            trace = EFFECTS[cause.effect].trace(one, cause.location, model.values(place)[None])
            missing += trace["motion"][0, :, column] if "motion" in trace else 0.0
        shows = max(shows, held_by(one, column))
        less = max(less, held_by(one, column, missing) if missing.any() else shows)
    return shows - less


def sticks(joint: str, torque: float) -> str:
    """For people."""
    return (
        f"{joint} stays where it is while the torque on it changes by {torque:.3g} Nm to "
        f"either "
        f"side beyond all friction that is known: it sticks"
    )


def _given(effect: str, joint: str, values: np.ndarray, signals: Sequence[Signals]) -> float:
    """Friction that an effect gives a joint at rest [Nm]."""
    return float(values[0]) * (
        _load(signals, joint) if effect == "load_dependent_friction" else 1.0
    )


def _load(signals: Sequence[Signals], joint: str) -> float:
    """Torque that motors usually send through a joint at most [Nm]."""
    place = signals[0].subject.joints.index(joint)
    sent = [applied(s.subject.joint_from_motor, s.believed)[:, place] for s in signals]
    return float(np.nanpercentile(np.abs(np.concatenate(sent)), 90))


def _unsure(load: np.ndarray, floating: bool) -> float:
    """Half the range of what may be wrong in the load of a joint at rest [Nm]."""
    if floating:
        return AFOOT * _half(load)
    time = np.arange(len(load))
    return OF_LOAD * _half(load) + OF_JOLTS * _half(
        load - np.polyval(np.polyfit(time, load, 1), time)
    )


def _half(values: np.ndarray) -> float:
    low, high = np.percentile(values, ENDS)
    return float(high - low) / 2
