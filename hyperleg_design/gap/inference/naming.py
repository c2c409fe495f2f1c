"""Whether a cause is worth its name: how much evidence it needs, and what it must explain, alone or
beside others.

All rules are `thresholds.Thresholds`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.gap.inference.detectors.loose import BELTS
from hyperleg_design.gap.inference.episodes import of_time
from hyperleg_design.gap.inference.fit import parts
from hyperleg_design.gap.inference.judge import OWN_ROWS, Judge, rank
from hyperleg_design.gap.inference.model import Model

SAG = "voltage_sag"
"""Effect of a weak battery."""
OWN_WORTH = 0.5
"""Least share of the excess squares, in the rows where it shows, that the first cause closes where
it closes little of all."""
CLEARER = 0.8
"""Share of the squares that nuisance parameters leave of a small gap which its cause leaves at
most."""
AT_LIMITS, AT_LIMITS_WORTH = ("torque_saturation", SAG), 0.95
"""Effects that must close nearly all of their episodes: healthy drives reach limits too, which
models often do not know."""
SHARED = 0.5
"""Change of a cause's trace, over its size, from which a further cause has taken part of it."""
CHATTERING = 0.5
"""Share of the evidence that what can make loops unstable needs where one chatters."""
PLAIN = 2.0
"""Times the evidence that a further cause needs from which it need only be as large as the floor to
stand for large nuisance parameters."""
APART = 0.2
"""Share by which a further cause's evidence alone and beside the others may differ, where it has
its own."""
HELD = 0.5
"""Share of what a joint holds that friction must explain."""


def worth_naming(judge: Judge, model: Model) -> bool:
    """Whether the first cause is worth its name: by all rows with excess or, where it is beyond
    doubt, by those where it shows.
    """
    rules = judge.thresholds
    rows = judge.excess_rows(model)
    partly = float(judge.gap(model.held.square, rows)) >= rules.least_gap
    doubtful = partly or _unsure_afoot(judge, model) or model.causes[-1].doubtful
    least = (rules.evident_doubtful if doubtful else rules.evident) * (
        CHATTERING if model.causes[-1].unsettling else 1.0
    )
    if model.gain < least:
        return False
    if at_rest(judge, model):
        return True
    if model.over < least or unshown(judge, model):
        return False
    if shows_in_a_band(judge, model, judge.nothing):
        return True
    if not _visible(judge, model):
        return False
    large = float(judge.gap(model.held.bare, rows)) >= rules.least_gap
    if large and judge.closed(model.held, rows, model.held) >= rules.worth:
        return True
    if model.gain < rules.second_evident:
        return False
    return _closes_own(judge, model, judge.nothing, OWN_WORTH, rules.least_gap) or stands_out(
        judge, model
    )


def worth_adding(judge: Judge, model: Model, before: Model) -> bool:
    """Whether one more cause is worth its name beside those before it: in the rows where it shows,
    over what they leave.

    Or instead of nuisance parameters that are much larger than usual.
    """
    rules, already = judge.thresholds, len(before.causes)
    gain = model.gain - before.gain
    if (
        gain >= rules.second_evident * already
        and at_rest(judge, model)
        and not at_rest(judge, before)
    ):
        return True
    if unshown(judge, model):
        return False
    visible, own = _visible(judge, model), apart(judge, model, before)
    if (
        visible
        and (own or gain >= rules.second_evident * already)
        and _closes_own(judge, model, before, rules.second_worth, 1.0)
    ):
        return True
    # Large nuisance parameters may hide what it leaves; then it must show clearly, away from
    # episodes, and be likelier than they are.
    likely = own or gain >= rules.second_instead * already
    if not likely or model.causes[-1].effect in AT_LIMITS or not _kept(model, before):
        return False
    plain = gain >= (1.0 if own else PLAIN) * rules.second_evident * already
    calm = judge.shown(model, already)[judge.calm]
    if visible and float(np.sqrt(calm.max())) >= (1.0 if own or plain else rules.second_visible):
        return True
    return (own and plain and _in_a_band(judge, model)) or shows_in_a_band(judge, model, before)


def apart(judge: Judge, model: Model, before: Model) -> bool:
    """Whether the last cause has evidence of its own: it needs as much as a first one for each
    before it, and has as much beside them as alone.

    What imitates a part of another cause, or mends what its model gets wrong, has not.
    """
    gain, over, least = (
        model.gain - before.gain,
        model.over - before.over,
        judge.thresholds.evident_doubtful * len(before.causes),
    )
    if min(gain, over) < least:
        return False
    alone = judge.model(model.causes[-1:])
    return min(alone.gain, alone.over) >= least and abs(gain - alone.gain) <= APART * gain


def shows_in_a_band(judge: Judge, model: Model, before: Model) -> bool:
    """Whether the last cause is over the floor in one band at least, with much evidence over the
    floor: a row's fast noise may hide it.
    """
    least = judge.thresholds.second_evident * max(len(before.causes), 1)
    if (
        model.causes[-1].effect in AT_LIMITS
        or model.gain - before.gain < PLAIN * least
        or model.over - before.over < least
    ):
        return False
    return _in_a_band(judge, model)


def _in_a_band(judge: Judge, model: Model) -> bool:
    bands = judge.shown_in_bands(model, len(model.causes) - 1)[~judge.base.samples.episodic]
    return float(np.sqrt(bands.max())) >= 1.0


def likelier(judge: Judge, more: Sequence[Model], further: Model) -> Model:
    """A model that is much likelier than the one that shows that a further cause is needed: that
    one imitates it.
    """
    least = rank(further) + judge.thresholds.alike
    found = (
        m
        for m in more
        if m.causes[-1].effect not in AT_LIMITS and _visible(judge, m) and not unshown(judge, m)
    )
    return next((m for m in found if rank(m) > least), further)


def at_rest(judge: Judge, model: Model) -> set[str]:
    """Joints of which a model explains what they show at rest, which is in no row."""
    return {joint for joint in judge.holds if judge.held(model, joint) >= HELD}


def sticks_alone(judge: Judge, model: Model, rows: np.ndarray) -> bool:
    """Whether a model explains what joints show at rest, and only these still have a gap."""
    held = at_rest(judge, model)
    large = rows & (judge.rows(model.held.square) > judge.thresholds.largest_excess**2)
    names = {
        judge.base.samples.rows[i % len(judge.base.samples.rows)].name
        for i in np.flatnonzero(large).tolist()
    }
    return bool(held) and names <= held


def unshown(judge: Judge, model: Model) -> bool:
    """Whether the last cause is a weak battery that these logs cannot show.

    On drives whose limits nobody declared: one that shows in rare episodes alone, or by no voltage.
    And one by no voltage that would have to take all torque that it can.
    """
    samples, rules, last = judge.base.samples, judge.thresholds, model.causes[-1]
    if last.effect != SAG:
        return False
    if last.unseen and bool((model.values(len(model.causes) - 1) >= last.high)[~last.shape].any()):
        return True
    if np.isfinite(samples.filtered_logs[0].signals.subject.stall_torque).all():
        return False
    if last.unseen and rules.seldom > 0:  # healthy drives have such limits, too
        return True
    episode, most = divmod(
        int(judge.shown(model, len(model.causes) - 1).argmax()), len(samples.rows)
    )
    return bool(episode) and of_time(samples, most) < rules.seldom


def stands_out(judge: Judge, model: Model) -> bool:
    """Whether a lone cause, however small over the floor, makes up half of what there is where it
    shows, even beside nuisance parameters.
    """
    if model.causes[0].effect in AT_LIMITS:
        return False
    own = np.flatnonzero(
        judge.own(model, 0) & (judge.shown(model, 0) >= judge.thresholds.visible**2)
    )
    bare, left, nothing = (
        float(judge.rows(v)[own].sum())
        for v in (model.held.bare, model.held.square, judge.nothing.held.square)
    )
    return bool(own.size) and left <= (1 - OWN_WORTH) * bare and left <= CLEARER * nothing


def _unsure_afoot(judge: Judge, model: Model) -> bool:
    """Whether a robot stands on its feet and no reference logs tell its errors; what its belts do
    there they do not tell either.
    """
    told = judge.base.prior.told and not any(c.effect in BELTS for c in model.causes)
    return _floating(judge) and not told


def _floating(judge: Judge) -> bool:
    return judge.base.samples.filtered_logs[0].signals.subject.floating


def _kept(model: Model, before: Model) -> bool:
    """Whether the causes before the last leave about the traces that they left without it: else two
    share what one of them does.
    """
    for part, cause in zip(parts(before.causes), before.causes, strict=True):
        own, moved = (
            before.fit.phi[part] @ cause.columns,
            (model.fit.phi[part] - before.fit.phi[part]) @ cause.columns,
        )
        if float(moved @ moved) > SHARED**2 * float(own @ own):
            return False
    return True


def _visible(judge: Judge, model: Model) -> bool:
    """Whether the last cause shows over the floor."""
    least = judge.thresholds.visible_afoot if _floating(judge) else judge.thresholds.visible
    return float(np.sqrt(judge.shown(model, len(model.causes) - 1).max())) >= least


def _closes_own(
    judge: Judge, model: Model, before: Model, worth: float, least: float = 0.0
) -> bool:
    """Whether the last cause closes a share of the excess squares in the rows where it shows, with
    their episodes or without.

    Args:
        judge: of the models.
        model: with the cause.
        before: without it.
        worth: least share.
        least: gap over floor that there must be.
    """
    shown = judge.shown(model, len(model.causes) - 1)
    own = (shown >= OWN_ROWS * shown.max()) & (shown > 0)
    without, with_it = judge.rows(before.held.square), judge.rows(model.held.square)
    in_episodes = max(worth, AT_LIMITS_WORTH) if model.causes[-1].effect in AT_LIMITS else worth
    for rows, share in ((own & judge.calm, worth), (own, in_episodes)):
        if not rows.any():
            continue
        left, less = float(without[rows].mean()), float(with_it[rows].mean())
        if left >= least**2 and left - less >= share * max(left - min(1.0, less), 1e-9):
            return True
    return False
