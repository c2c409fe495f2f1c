"""Effects that act at all of their places at once, as hypotheses of one cause: grease, supplies and
settings change at every joint alike.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.effects.effect import Effect
from hyperleg_design.gap.effects.kinds import JointEffect, MotorEffect
from hyperleg_design.gap.inference.cause import Cause
from hyperleg_design.gap.inference.endogenous import Factor
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
)
from hyperleg_design.gap.inference.hypotheses.hypothesis_fit import HypothesisFit
from hyperleg_design.gap.inference.hypotheses.limited_scales import limited_scales
from hyperleg_design.gap.inference.hypotheses.proposals import Proposal


def at_all_places(
    fits: HypothesisFit, proposals: Mapping[Name, Sequence[Proposal]], current: Hypothesis
) -> list[tuple[float, Candidate]]:
    """Join linear effects, and the most promising nonlinear ones, at all of their places, and
    compute what they gain beside a hypothesis at its scales.

    Args:
        fits: to the evidence.
        proposals: of effects at single places.
        current: the hypothesis.

    Returns:
        Gains [nat] and candidates, best first.
    """
    scales = limited_scales(fits.evidence, current.scales, fits.rules)
    acting = {(candidate.effect, candidate.standing) for candidate in current.candidates}
    joined_effects = []
    start = fits.at_scales(fits.stacked(current.causes, ()), scales).gain
    for (effect, _), own in _joinable(fits, proposals, acting):
        candidates = [fits.candidate(proposals[name][0], current, steps=1) for name in own]
        causes = tuple(
            without_gain_from_torques(cause)
            for candidate in candidates
            if candidate is not None
            for cause in candidate.causes
        )
        if len(causes) < 2:
            continue
        gain = fits.at_scales(fits.stacked(current.causes, causes), scales).gain - start
        joined_effects.append((gain, Candidate(effect, EVERYWHERE, causes)))
    return sorted(joined_effects, key=lambda entry: (-entry[0], *entry[1].name))


def _joinable(
    fits: HypothesisFit,
    proposals: Mapping[Name, Sequence[Proposal]],
    acting: set[tuple[str, bool]],
) -> list[tuple[tuple[str, bool], list[Name]]]:
    """Effects that may act at all of their places, and whether in all logs, with the names of
    their proposals: all linear ones, and of the nonlinear ones of joints and drives those that
    gain most at single places.
    """
    places: dict[tuple[str, bool], list[Name]] = {}
    for name in sorted(proposals):
        effect = WEIGHED[name[0]]
        if effect.flexible or fits.count[name[0]] < 2 or not _alike(effect, name[2]):
            continue
        if (name[0], name[2]) not in acting:
            places.setdefault((name[0], name[2]), []).append(name)
    worth = {
        kind: sum(max(proposals[name][0].gain, 0.0) for name in own)
        for kind, own in places.items()
        if not WEIGHED[kind[0]].linear
    }
    bent = sorted(worth, key=lambda kind: (-worth[kind], kind))[: fits.rules.search.bent]
    bent = [kind for kind in bent if worth[kind] > 0]
    return [(kind, own) for kind, own in places.items() if kind in bent or kind not in worth]


def _alike(effect: Effect, standing: bool) -> bool:
    """Whether an effect acts at all of its places alike: zeros of encoders do not, and belts and
    gears may be built so, but do not become so.
    """
    if effect.linear:
        return True
    of_joints = isinstance(effect, JointEffect | MotorEffect) and not effect.of_zeros
    return of_joints and (standing or not effect.built)


def without_gain_from_torques(cause: Cause) -> Cause:
    """Keep a cause from gaining by larger torques.

    Where an effect scales the torques at all of its places, masses and friction may be larger by as
    much, and the gain would be noise that is nearer to the expected one.

    Args:
        cause: the effect at one place.

    Returns:
        The cause, whose terms of the likelihood charge for smaller torques alone.
    """
    if not cause.factors:
        return cause
    factors = (
        replace(term, shows=0.0) if isinstance(term, Factor) else term for term in cause.factors
    )
    return replace(cause, factors=tuple(factors))
