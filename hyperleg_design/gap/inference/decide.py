"""Which causes are named: by what they predict of data that they were not fitted to, never by the
fit itself.

One cause must beat none on held-out blocks by `evident`, close `worth` of the excess gap and be
`visible` over the floor; a further one must do so beside those before it (`naming`). What no list
of effects explains is `unknown`. All rules are `thresholds.Thresholds`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.friction import FRICTION
from hyperleg_design.gap.effects.placing import moved_joints
from hyperleg_design.gap.inference import screen, shaping
from hyperleg_design.gap.inference.base import Base
from hyperleg_design.gap.inference.detectors.heard import KNOCKING, Heard
from hyperleg_design.gap.inference.detectors.knocking import knocking
from hyperleg_design.gap.inference.detectors.loose import BELTS, loose
from hyperleg_design.gap.inference.detectors.unsettled import UNSETTLING, unsettled
from hyperleg_design.gap.inference.detectors.unstable import unstable
from hyperleg_design.gap.inference.episodes import of_time, together
from hyperleg_design.gap.inference.fit import Cause, Design, Fit
from hyperleg_design.gap.inference.judge import ROUNDS, Judge, rank
from hyperleg_design.gap.inference.model import Model
from hyperleg_design.gap.inference.naming import (
    HELD,
    SAG,
    likelier,
    sticks_alone,
    worth_adding,
    worth_naming,
)
from hyperleg_design.gap.signals.loading import FULL

if TYPE_CHECKING:
    from hyperleg_design.gap.inference.samples import Samples
    from hyperleg_design.gap.inference.thresholds import Thresholds
    from hyperleg_design.gap.model.subject import Subject
    from hyperleg_design.gap.signals.signals import Signals

FINALISTS = 10
"""Candidates that are judged on held-out data."""
REFINED = 24
"""Candidates that are fitted to the end before that."""
TWINNED = 3
"""Of these, how many whose twins are judged, too, however little a first look at them promises."""
MOST_CAUSES = 3
PAIRED, PAIRS = 6, 2
"""Of the finalists, how many are tried two by two, and pairs of these that are judged on held-out
data."""
SAGGED = 0.03
"""Share of the voltage that must be missing for a weak battery where reference logs tell what it is
when all is well."""
DECISIVE = 30.0
"""Log-likelihood by which residuals must tell a soft belt from play to be believed more than what
is
heard: they hardly see its harmonics."""
SEVERAL = 2
"""Joints that must be off at times for it to be a gap where nobody measured drives: one alone may
have its own friction."""
LIMITS_AT_ONCE = 2
"""Drives that give less than their limit at once, from which there is rather something common to
them: firmware that shapes motion, a supply."""
SMALL_EXCESS, QUIET = 1.2, 3.0
"""Gap over floor up to which a shape must be so many times more evident to be told, as no cause was
named."""


@dataclass(frozen=True, eq=False)
class Decision:
    """What was found."""

    verdict: str
    model: Model
    rows: np.ndarray
    """That count for the gap `(rows,)` of bool."""
    singles: tuple[Model, ...]
    """Best first: each cause alone, or, with several causes, each beside the others."""
    slots: tuple[tuple[Model, ...], ...]
    """For each named cause its rivals in its place, itself among them."""
    shaped: tuple[shaping.Told, ...]
    """Best first."""
    together: float
    """Share of the time in which most drives at once do not do what they were told, beside the
    causes; 0 where that is little."""
    limit_cycle: tuple[str, ...]
    """Joints that chatter though none of the causes can make them, nor what is heard beside causes
    that explain the rest."""
    heard: Heard | None
    """What rings, lets joints knock about, or makes control loops swing."""
    failing: dict[int, float]
    """Rows that are far off for a share of the time which no cause explains, where nothing else is
    wrong."""
    not_judged: tuple[screen.NotJudged, ...]


def decide(
    base: Base,
    thresholds: Thresholds,
    wanted: Sequence[tuple[str, str]],
    threads: int = 1,
    references: Sequence[Signals] = (),
) -> tuple[Judge, Decision]:
    """Name the causes.

    Args:
        base: residual and nuisance parameters.
        thresholds: fixed rules.
        wanted: effects and locations that are tried.
        threads: that share the work.
        references: logs of the healthy robot.
    """
    judge = Judge(base, thresholds, threads)
    swinging = unsettled(base.samples)
    averaged = [name for name in wanted if name[0] in FRICTION and name[1] in swinging]
    supplied = [name for name in wanted if name[0] == SAG and _as_healthy(base.samples)]
    wanted = [name for name in wanted if name not in (*averaged, *supplied)]
    singles, not_judged = _finalists(judge, wanted, ())
    chosen, slots = _chosen(judge, wanted, singles)
    rows = judge.excess_rows(chosen if chosen.causes or not singles else singles[0])
    if not chosen.causes:
        rows = _calm(judge, rows)
    elif float(judge.gap(chosen.held.bare, rows)) < thresholds.least_gap:
        rows = judge.own(chosen, 0)
    shaped = shaping.instead(
        judge, chosen, rows, max((m.gain for m in singles), default=0.0)
    ) or shaping.beside(judge, chosen, rows)
    lost = (
        0.0
        if _sags(judge, chosen, rows) or _leaves_nothing(judge, chosen)
        else _lost(base.samples, chosen.held.left, thresholds)
    )
    shaken = () if any(c.unsettling for c in chosen.causes) else swinging
    swung = [
        screen.NotJudged(*name, "its joint chatters, which averages friction out")
        for name in averaged
    ]
    swung += [
        screen.NotJudged(*name, "its voltage is that of the reference logs") for name in supplied
    ]
    signals = [filtered_log.signals for filtered_log in base.samples.filtered_logs]
    heard = (loose(signals) or unstable(signals)) if shaken else None
    if (
        heard is not None
    ):  # what swings takes all drives off their commands, and lost commands make nothing swing
        lost = 0.0
    if heard is None and any(c.effect in UNSETTLING for c in chosen.causes):
        shaken = ()  # joints shake each other
    verdict = _verdict(judge, chosen, rows, shaped)
    if heard is not None and verdict == "explained" and _told_apart(chosen, singles, heard):
        heard, shaken = None, ()
    beside = (
        chosen.gain >= thresholds.second_evident
    )  # what is heard comes first, and shakes other joints, too
    if (
        heard is not None
        and verdict == "explained"
        and beside
        and (others := _elsewhere(chosen, heard, signals[0].subject))
    ):
        if len(others) < len(
            chosen.causes
        ):  # what it leaves at its own motor and joints looks like limits and constants
            chosen = judge.model(others)
            rows, slots = judge.excess_rows(chosen), [(chosen,) for _ in others]
        shaken = ()
    elif lost or shaken:
        verdict = "unknown"
    failing = _fails(base.samples, thresholds) if verdict == "none" else {}
    if failing or (
        verdict == "none" and any(judge.held(chosen, joint) < HELD for joint in judge.holds)
    ):
        verdict = "unknown"
    if verdict == "none" and shaping.tells(thresholds, chosen, pushes := shaping.of_base(judge)):
        verdict, shaped = "unknown", pushes
    if (
        heard is None and not lost and not any(c.effect in BELTS for c in chosen.causes)
    ):  # a belt shakes other joints, too
        heard = knocking(
            signals,
            references,
            [_motion(chosen, one) for one in signals] if verdict == "explained" else (),
        )
        if (
            heard is not None
            and verdict == "explained"
            and len(_elsewhere(chosen, heard, signals[0].subject)) < len(chosen.causes)
        ):
            heard = None
    return judge, Decision(
        verdict,
        chosen,
        rows,
        tuple(singles),
        tuple(slots),
        shaped,
        lost,
        shaken,
        heard,
        failing,
        (*not_judged, *swung),
    )


def _calm(judge: Judge, rows: np.ndarray) -> np.ndarray:
    """Rows that count without their episodes, which only a cause that is named may explain."""
    calm = rows & judge.calm
    return calm if calm.any() else judge.excess_rows(judge.nothing)


def _elsewhere(chosen: Model, heard: Heard, subject: Subject) -> tuple[Cause, ...]:
    """Causes that are not at the motor or the joints of what is heard; nor belts, where one is
    heard that shakes all joints.
    """
    own = {
        heard.location,
        *(
            moved_joints(subject, subject.motors.index(heard.location))
            if heard.location in subject.motors
            else ()
        ),
    }
    belts = BELTS if heard.shape != KNOCKING and heard.causes[0].effect in BELTS else ()
    return tuple(c for c in chosen.causes if c.location not in own and c.effect not in belts)


def _told_apart(chosen: Model, singles: Sequence[Model], heard: Heard) -> bool:
    """Whether residuals alone tell that it is the belt that is heard, and by far whether it is soft
    or has play.
    """
    belt = chosen.causes[0]
    if len(chosen.causes) > 1 or belt.effect not in BELTS or belt.location != heard.location:
        return False
    others = [
        rank(m)
        for m in singles
        if m.causes[0].effect in BELTS
        and m.causes[0].location == belt.location
        and m.names != chosen.names
    ]
    return rank(chosen) > max(others, default=0.0) + DECISIVE


def _motion(model: Model, signals: Signals) -> np.ndarray:
    """What causes leave in a log's residual of motion `(t, n)` [Nm]."""
    found = np.zeros_like(signals.position)
    for place, cause in enumerate(model.causes):
        trace = EFFECTS[cause.effect].trace(signals, cause.location, model.values(place)[None])
        found += trace["motion"][0] if "motion" in trace else 0.0
    return found


def shown_already(
    base: Base, thresholds: Thresholds, wanted: Sequence[tuple[str, str]], threads: int = 1
) -> Model:
    """Causes that reference logs of a healthy robot name; arguments as of `decide`."""
    judge = Judge(base, replace(thresholds, seldom=0.0), threads)
    return _chosen(judge, wanted, _finalists(judge, wanted, ())[0])[0]


def _chosen(
    judge: Judge, wanted: Sequence[tuple[str, str]], singles: list[Model]
) -> tuple[Model, list[tuple[Model, ...]]]:
    """The causes that are worth their names, one after the other, and the rivals of each."""
    best = next((m for m in singles if worth_naming(judge, m)), None)
    if best is None:
        return judge.nothing, []
    best = likelier(judge, singles, best)
    chosen, slots = best, [_from(singles, best)]
    while len(chosen.causes) < MOST_CAUSES:
        more, _ = _finalists(judge, wanted, chosen.causes)
        further = next((m for m in more if worth_adding(judge, m, chosen)), None)
        if further is None:
            break
        further = likelier(judge, more, further)
        chosen, slots = further, [*slots, _from(more, further)]
        if len(chosen.causes) == 2:
            chosen, slots = _swapped(judge, wanted, chosen, slots)
            chosen, slots = _paired(judge, wanted, singles, chosen, slots)
    return chosen, slots


def _from(models: Sequence[Model], named: Model) -> tuple[Model, ...]:
    """The named model and those after it: those before it were not worth their name, and are no
    rivals.
    """
    return tuple(models[models.index(named) :])


def _finalists(
    judge: Judge, wanted: Sequence[tuple[str, str]], beside: Sequence[Cause]
) -> tuple[list[Model], list[screen.NotJudged]]:
    """Best candidates beside given causes, as models on held-out blocks, best first."""
    taken, base = _taken(beside), judge.base
    start = (
        judge.nothing.fit
        if not beside
        else Design(base, beside).fit(scale=judge.nothing.fit.scale, rounds=ROUNDS)
    )
    found = screen.screen(base, start, [w for w in wanted if w not in taken], judge.threads, beside)
    candidates = [c for c in found if isinstance(c, screen.Candidate)]
    candidates.sort(key=lambda c: (-c.gain, c.name))
    refined = screen.spread(
        lambda c: (_refined(base, c, start, beside), c), candidates[:REFINED], judge.threads
    )
    refined.sort(key=lambda pair: (-pair[0], pair[1].name))
    models = screen.spread(
        lambda pair: judge.model([*beside, pair[1].cause]), refined[:FINALISTS], judge.threads
    )
    models.sort(key=lambda m: (-rank(m), m.names))
    lacking = {_twin(m.names[-1]) for m in models[:TWINNED]} & {*wanted} - {
        *taken,
        *(m.names[-1] for m in models),
    }
    twins = [
        c
        for c in screen.screen(base, start, sorted(lacking), judge.threads, beside)
        if isinstance(c, screen.Candidate)
    ]
    models += screen.spread(lambda one: judge.model([*beside, one.cause]), twins, judge.threads)
    models.sort(key=lambda m: (-rank(m), m.names))
    return models, [c for c in found if isinstance(c, screen.NotJudged)]


def _twin(name: tuple[str, str]) -> tuple[str, str]:
    """What a load on a link, or an error of the link's own mass, is hard to tell from: the other of
    both.
    """
    return {"payload": "link_mass", "link_mass": "payload"}.get(name[0], ""), name[1]


def _taken(beside: Sequence[Cause]) -> set[tuple[str, str]]:
    """What no further cause can be: those that are known, and another way in which the belt of one
    of them gives.
    """
    return {
        (effect, c.location)
        for c in beside
        for effect in (BELTS if c.effect in BELTS else (c.effect,))
    }


def _refined(base: Base, candidate: screen.Candidate, start: Fit, beside: Sequence[Cause]) -> float:
    found = Design(base, [*beside, candidate.cause]).fit(scale=start.scale, rounds=ROUNDS).evidence
    return found + screen.at_rest(base.samples, *candidate.name)


def _fails(samples: Samples, rules: Thresholds) -> dict[int, float]:
    """Rows of drives that do not do what they are told, more often than healthy ones at their
    limits, and for how much of the time.

    Where nobody measured what drives give, of joints, if several are so often off.
    """
    residual_name = (
        "drive" if any(row.residual_name == "drive" for row in samples.rows) else "motion"
    )
    shares = {
        place: of_time(samples, place)
        for place, row in enumerate(samples.rows)
        if row.residual_name == residual_name
    }
    found = {place: share for place, share in shares.items() if share > rules.failing}
    return found if residual_name == "drive" or len(found) >= SEVERAL else {}


def _as_healthy(samples: Samples) -> bool:
    """Whether all logs tell the battery's voltage, and reference logs that it is what it was when
    all was well.
    """
    voltages = [s.signals.voltage for s in samples.filtered_logs]
    nominal = samples.filtered_logs[0].signals.subject.voltage
    return bool(np.isfinite(nominal)) and all(
        v is not None and float(np.nanpercentile(v, 100 - FULL)) > (1 - SAGGED) * nominal
        for v in voltages
    )


def _swapped(
    judge: Judge, wanted: Sequence[tuple[str, str]], pair: Model, slots: list[tuple[Model, ...]]
) -> tuple[Model, list[tuple[Model, ...]]]:
    """Look for the first cause again beside the second: forward selection may have begun with what
    looked like both.
    """
    models, _ = _finalists(judge, wanted, pair.causes[1:])
    turned = [_turned(m) for m in models]
    if turned and _betters(turned[0], pair):
        return turned[0], [tuple(turned), slots[1]]
    return pair, [
        tuple(turned) if any(t.names == pair.names for t in turned) else slots[0],
        slots[1],
    ]


def _paired(
    judge: Judge,
    wanted: Sequence[tuple[str, str]],
    singles: Sequence[Model],
    pair: Model,
    slots: list[tuple[Model, ...]],
) -> tuple[Model, list[tuple[Model, ...]]]:
    """Look for likelier pairs among the finalists: what imitates two causes together need be
    neither of them, nor lead to one.
    """
    scale, alone = judge.nothing.fit.scale, {one.names: one for one in singles}
    tried = [
        [one.causes[0], other.causes[0]]
        for one, other in combinations(singles[:PAIRED], 2)
        if other.names[0] not in _taken(one.causes)
    ]
    order = screen.spread(
        lambda causes: Design(judge.base, causes).fit(scale=scale, rounds=ROUNDS).evidence,
        tried,
        judge.threads,
    )
    best = sorted(range(len(tried)), key=lambda i: (-order[i], i))[:PAIRS]
    for found in sorted((judge.model(tried[i]) for i in best), key=lambda m: (-rank(m), m.names)):
        if not _betters(found, pair):
            continue
        if worth_adding(judge, found, alone[found.names[:1]]) and worth_adding(
            judge, _turned(found), alone[found.names[1:]]
        ):
            more, _ = _finalists(judge, wanted, found.causes[:1])
            again = next((m for m in more if worth_adding(judge, m, alone[found.names[:1]])), found)
            return _swapped(
                judge, wanted, again, [(again,), _from(more, again) if again in more else (again,)]
            )
    return pair, slots


def _betters(found: Model, pair: Model) -> bool:
    """Whether other causes are likelier than a pair."""
    return rank(found) > rank(pair) + 1e-6 and set(found.names) != set(pair.names)


def _turned(model: Model) -> Model:
    """The last cause first."""
    size = len(model.causes[-1].nulls)
    order = np.r_[
        np.arange(len(model.fit.phi) - size, len(model.fit.phi)),
        np.arange(len(model.fit.phi) - size),
    ]
    fit = replace(
        model.fit, phi=model.fit.phi[order], covariance=model.fit.covariance[np.ix_(order, order)]
    )
    return replace(model, causes=(model.causes[-1], *model.causes[:-1]), fit=fit)


def _sags(judge: Judge, chosen: Model, rows: np.ndarray) -> bool:
    """Whether a weak battery is named, which all drives feel at once: its model need not get each
    of them right.
    """
    sagging = any(c.effect == SAG for c in chosen.causes)
    return sagging and judge.closed(chosen.held, rows, chosen.held) >= judge.thresholds.far_required


def _leaves_nothing(judge: Judge, chosen: Model) -> bool:
    """Whether causes leave no gap in any row nor its episodes: what lost commands do is large while
    it lasts.
    """
    left = judge.rows(chosen.held.square)
    return bool(chosen.causes) and float(np.sqrt(left.max())) < judge.thresholds.largest_excess


def _lost(samples: Samples, left: np.ndarray, rules: Thresholds) -> float:
    """Share of the time in which commands get lost, if it is one that counts."""
    share, least = together(samples, left), rules.together
    subject = samples.filtered_logs[0].signals.subject
    if subject.one_to_one and not any(row.residual_name == "drive" for row in samples.rows):
        share, least = together(samples, left, "motion"), rules.together_joints
    return share if share > least else 0.0


def _verdict(judge: Judge, chosen: Model, rows: np.ndarray, shaped: Sequence[shaping.Told]) -> str:
    rules = judge.thresholds
    excess = float(judge.gap(judge.nothing.held.square, rows))
    needed = rules.beyond_evident * (QUIET if not chosen.causes and excess < SMALL_EXCESS else 1.0)
    beyond = shaping.tells(rules, chosen, shaped) and shaped[0].gain > needed
    if not chosen.causes:
        return "unknown" if excess > rules.largest_excess or beyond else "none"
    left = float(judge.gap(chosen.held.square, rows))
    far = rules.far_required ** (
        1 / len(chosen.causes)
    )  # several causes that still leave much are the less likely
    if (
        chosen.causes[0].effect in BELTS
    ):  # what rotors do on belts that give much is known to first order alone
        far = rules.required
    needed = far if left > rules.far else rules.required if left > rules.largest_excess else -np.inf
    short = judge.closed(chosen.held, rows, chosen.held) < needed and not sticks_alone(
        judge, chosen, rows
    )
    limited = sum(c.effect == "torque_saturation" for c in chosen.causes)
    if beyond or short or limited >= LIMITS_AT_ONCE:
        return "unknown"
    return "explained"
