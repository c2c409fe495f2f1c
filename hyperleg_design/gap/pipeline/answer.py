"""The answer: a `Diagnosis` (verdict, gap, causes, rivals, remainder) from the posterior of the
hypotheses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.special import expit

from hyperleg_design import provenance
from hyperleg_design.gap.checks.check import ROBOT, Check
from hyperleg_design.gap.checks.coverage import beyond_references
from hyperleg_design.gap.effects import EFFECTS, UNLISTED
from hyperleg_design.gap.effects.sensors.imu_bias import IMU
from hyperleg_design.gap.effects.strength import has_placeholders
from hyperleg_design.gap.experiments import experiment
from hyperleg_design.gap.inference.assembly import Evidence
from hyperleg_design.gap.inference.gap_size import GapSize
from hyperleg_design.gap.inference.hypotheses.hypothesis import (
    EVERYWHERE,
    Candidate,
    Hypothesis,
    Name,
)
from hyperleg_design.gap.inference.hypotheses.reference_differences import Difference
from hyperleg_design.gap.inference.hypotheses.search import Result
from hyperleg_design.gap.inference.intervals import intervals
from hyperleg_design.gap.inference.posterior import Posterior, expanded, untold
from hyperleg_design.gap.inference.rules import InferenceRules
from hyperleg_design.gap.pipeline.unexplained import Unexplained
from hyperleg_design.gap.results.diagnosis import (
    LEAST_SHARE,
    MOST_RIVALS,
    NAMING,
    Diagnosis,
    Named,
    Place,
    Shrinkage,
)
from hyperleg_design.gap.results.finding import NOTE, WARNING
from hyperleg_design.gap.signals.signals import RESIDUALS

WORST = -9.99
"""Least share of a gap closed that is stated [-]; a cause that fits other data badly may close far
less than nothing."""
AT_END = "is at the end of the range that is tried"
"""What remarks say of a size that is."""


class Answer:
    """Collects the parts of a `Diagnosis` from the posterior and the size of the gap."""

    def __init__(
        self,
        evidence: Evidence,
        result: Result,
        posterior: Posterior,
        size: GapSize,
        rules: InferenceRules,
        seed: int,
        apart: Sequence[Difference] = (),
    ) -> None:
        self.evidence, self.result, self.posterior, self.size = evidence, result, posterior, size
        self.rules, self.seed, self.apart = rules, seed, apart
        self.unexplained = Unexplained(evidence, posterior, size, rules)

    def diagnosis(self, checks: Sequence[Check], sensitivity: Any) -> Diagnosis:
        """Collect the whole answer from the parts that were computed.

        Args:
            checks: of the logs, which the answer carries along.
            sensitivity: smallest faults that the logs would have shown.

        Returns:
            The diagnosis.
        """
        posterior = self.posterior
        naming = posterior.verdict in NAMING
        causes = self.causes(posterior.order)
        rivals = self.rivals()
        if not naming:
            rivals, causes = (*causes, *rivals), ()
            most = sum(rival.probability for rival in rivals)
            if most > 1 - self.rules.posterior.likely:
                share = (1 - self.rules.posterior.likely) / most
                rivals = tuple(_scaled(rival, share) for rival in rivals)
        equivalent = tuple(
            tuple(_placed(name) for name in (posterior.hypothesis.candidates[place].name, *group))
            for place, group in zip(posterior.order, posterior.alike, strict=True)
            if group and naming
        )
        trial = experiment.separating(equivalent[0]) if equivalent else None
        left = (
            posterior.remainder if posterior.remainder >= self.rules.posterior.remainder else None
        )
        return Diagnosis(
            verdict="unknown"
            if posterior.verdict == "none" and self.unexplained.hides_faults
            else posterior.verdict,
            gap=self.gap(naming),
            where=self.where(),
            causes=causes,
            rivals=rivals[:MOST_RIVALS],
            equivalent=equivalent,
            separating_experiment=None
            if trial is None
            else experiment.as_mapping(trial, equivalent[0]),
            not_judged=tuple(
                {"effect": n.effect, "location": n.location, "reason": n.reason}
                for n in self.result.not_judged
                if n.effect not in UNLISTED
            ),
            residual_shape=self.unexplained.shapes(),
            checks=self.remarks(checks),
            sensitivity=sensitivity,
            provenance=self.provenance(),
            remainder=left,
            lacks=self.lacks() if self.evidence.references else None,
            reference_differences=self.differences(),
        )

    def lacks(self) -> dict[str, Any]:
        """What the model lacks of the robot in the references already."""
        causes = self.causes(self.posterior.standing)
        return {
            "verdict": "explained" if causes else "none",
            "causes": [cause.mapping() for cause in causes],
        }

    def differences(self) -> tuple[dict[str, Any], ...]:
        """What was taken out of references that differed from the others."""
        own, subject = self.rules.posterior, self.evidence.signals[0].subject
        stated = []
        for difference in self.apart:
            probability = min(float(expit(own.temperature * difference.odds)), own.most_certain)
            deviation, cause = own.interval * difference.deviation, difference.cause
            sizes = intervals(cause, difference.values, deviation, subject, self.torque_error)
            named = Named(cause.effect, cause.location, probability, 0.0, sizes)
            stated.append({"log": difference.log, **named.mapping()})
        return tuple(stated)

    def causes(self, places: Sequence[int]) -> tuple[Named, ...]:
        """Collect some candidates of the most probable hypothesis, first those that close the main
        part of the gap, and each kind in its order.

        Args:
            places: indices of the candidates.
        """
        hypothesis = self.posterior.hypothesis
        named = [self.named(hypothesis, hypothesis.candidates[place]) for place in places]
        main = self.rules.posterior.main_part
        named.sort(key=lambda causes: max(cause.closed for cause in causes) < main)
        return tuple(cause for causes in named for cause in causes)

    def named(self, hypothesis: Hypothesis, candidate: Candidate) -> list[Named]:
        """Name a candidate with its parameters.

        Args:
            hypothesis: the hypothesis.
            candidate: one of its candidates.

        Returns:
            One cause; of an effect at all of its places, one for each place where it clearly acts,
            the clearest first.
        """
        probability = self.posterior.probability[candidate.name]
        subject = self.evidence.signals[0].subject
        sized: list[tuple[float, Named]] = []
        for place, own in expanded(hypothesis.candidates):
            if own is not candidate:
                continue
            cause = hypothesis.causes[place]
            deviation = self.rules.posterior.interval * hypothesis.deviation(place)
            closed = self.closed_by(hypothesis, place)
            values = hypothesis.values(place)
            sizes = intervals(cause, values, deviation, subject, self.torque_error)
            named = Named(cause.effect, cause.location, probability, closed, sizes)
            sized.append((self.stands(hypothesis, place), named))
        sized.sort(key=lambda entry: -entry[0])
        rules = self.rules.posterior
        clear_ones = [named for stands, named in sized if stands >= rules.clear]
        closing = [named for named in clear_ones if named.closed >= rules.least_closed]
        return closing or clear_ones or [sized[0][1]]

    def stands(self, hypothesis: Hypothesis, place: int) -> float:
        """Compute how far the sizes of a cause are from those of nothing.

        Args:
            hypothesis: the hypothesis.
            place: index of the cause among its causes.

        Returns:
            In standard deviations, of the parameter that is farthest.
        """
        cause = hypothesis.causes[place]
        deviation = self.rules.posterior.interval * hypothesis.deviation(place)
        away = np.abs(hypothesis.values(place) - cause.nulls) / np.maximum(deviation, 1e-300)
        return float(np.max(np.where(cause.shape, 0.0, away)))

    @property
    def torque_error(self) -> float:
        """Standard deviation of the scale of all torques [-]."""
        steered = all(signals.steered for signals in self.evidence.signals)
        return self.rules.posterior.torque_error if steered else 0.0

    def closed_by(self, hypothesis: Hypothesis, place: int) -> float:
        """Compute the share of the gap that one cause closes.

        Args:
            hypothesis: the hypothesis.
            place: index of the cause among its causes.

        Returns:
            The share, see `GapSize.closed_by`; 0 of another hypothesis than the most probable one.
        """
        if hypothesis is not self.posterior.hypothesis or not self.posterior.hypothesis.causes:
            return 0.0
        return max(self.posterior.shares[place], WORST)

    def rivals(self) -> tuple[Named, ...]:
        """Other candidates, most probable first; one an effect and place, as the same effect at all
        places may show at one alone.
        """
        best: dict[tuple[str, str], Named] = {}
        for hypothesis, candidate in self.posterior.rivals[:MOST_RIVALS]:
            rivals = (
                named for named in self.named(hypothesis, candidate) if not self.is_cause(named)
            )
            if (rival := next(rivals, None)) is not None:
                place = rival.effect, rival.location
                best[place] = max(
                    best.get(place, rival), rival, key=lambda named: named.probability
                )
        ranked = sorted(best.items(), key=lambda entry: (-entry[1].probability, *entry[0]))
        return tuple(rival for _, rival in ranked)

    def is_cause(self, rival: Named) -> bool:
        """Tell whether a rival is a cause of the most probable hypothesis itself.

        Args:
            rival: the rival.
        """
        acting = (cause for cause in self.posterior.hypothesis.causes if not cause.standing)
        return (rival.effect, rival.location) in {
            (cause.effect, cause.location) for cause in acting
        }

    def gap(self, naming: bool) -> Shrinkage:
        """Compute the gap before and after, and the least possible one, over the channels that
        count.

        Args:
            naming: whether the verdict names causes.
        """
        size = self.size
        before, after = (float(np.sqrt(size.total(square))) for square in (size.before, size.after))
        closed, low, high = 0.0, 0.0, 0.0
        if naming and size.closed:
            closed = size.closed
            low, high = (float(v) for v in np.percentile(size.drawn(self.seed), [2.5, 97.5]))
        else:
            after = before
        floor = min(size.lowest, after)
        before, after, floor = (value * size.expected for value in (before, after, floor))
        interval = max(min(low, closed), WORST), max(high, closed)
        return Shrinkage(before, after, floor, max(closed, WORST), interval, size.unit)

    def where(self) -> tuple[Place, ...]:
        """Shares of the excess by place."""
        shares: dict[tuple[str, str], float] = {}
        for channel, value in zip(self.evidence.channels, self.size.excess.tolist(), strict=True):
            kind = RESIDUALS[channel.residual][0]
            name = channel.name
            if channel.residual == "ground":
                name = channel.name.rsplit("_", 1)[0]
            if channel.residual == "base":
                name = "robot"
            if kind == "sensor":
                name = IMU
            shares[name, kind] = shares.get((name, kind), 0.0) + value
        total = sum(shares.values())
        if total <= 0:
            return ()
        ranked = sorted(shares.items(), key=lambda item: (-item[1], item[0]))
        return tuple(
            Place(name, kind, "all", value / total)
            for (name, kind), value in ranked
            if value / total >= LEAST_SHARE
        )

    def remarks(self, checks: Sequence[Check]) -> tuple[str, ...]:
        """Collect what a reader of the answer should know of the logs.

        Args:
            checks: of the logs.
        """
        texts = []
        for check in checks:
            texts += [
                f"{ROBOT}: {f.what}"
                if f.signal == ROBOT
                else f"{check.name}: {f.severity}: {f.signal + ' ' if f.signal else ''}{f.what}"
                for f in check.findings
                if f.severity in (WARNING, NOTE)
            ]
        for s in (*self.evidence.signals, *self.evidence.references):
            texts += [f"{s.log.name}: {note}" for note in s.notes]
        texts += beyond_references(self.evidence.signals, self.evidence.references)
        texts.extend(
            f"references and tests alike: {cause.location} {description}"
            for cause, description in self.unexplained.unlisted_causes
            if cause.standing
        )
        texts += self.minor()
        texts += [
            f"{effect} at {place}: the reference logs do not show whether it acts in them, too"
            for effect, place in sorted(_placed(name) for name in untold(self.result))
        ]
        texts += self.ends()
        if has_placeholders(self.evidence.signals[0].subject):
            texts.append(
                "effort limits are far beyond what the joints need and count as unknown: give the "
                "motors' own"
            )
        if not self.evidence.references:
            texts.append(
                "no reference logs: what the model leaves is judged by how well robots are known "
                "usually"
            )
        return tuple(dict.fromkeys(texts))

    def minor(self) -> list[str]:
        """Causes of the most probable hypothesis that are not named, in words."""
        hypothesis, texts = self.posterior.hypothesis, []
        for place in self.posterior.minor:
            named = self.named(hypothesis, hypothesis.candidates[place])
            most = max(named, key=lambda cause: cause.closed)
            places, share = ", ".join(cause.location for cause in named), max(most.closed, 0.0)
            why = f"closes {100 * share:.0f} % of the gap there: too little for a cause"
            if share >= self.rules.posterior.least_closed:
                why = f"is a cause with a probability of {most.probability:.2f} only"
            texts.append(f"{most.effect} at {places} fits, too, but {why}")
        return texts

    def ends(self) -> list[str]:
        """Sizes of causes that are at an end of the range that is tried, in words; of an effect at
        all of its places, where it clearly acts.
        """
        places: dict[tuple[str, str], list[str]] = {}
        hypothesis, least = self.posterior.hypothesis, self.rules.posterior.clear
        for place, candidate in expanded(hypothesis.candidates):
            cause, alone = hypothesis.causes[place], len(candidate.causes) == 1
            if cause.effect in UNLISTED or not (alone or self.stands(hypothesis, place) >= least):
                continue
            values, parameters = hypothesis.values(place), EFFECTS[cause.effect].parameters
            at_end = np.isclose(values, cause.low) | np.isclose(values, cause.high)
            for i in np.flatnonzero(at_end & ~cause.shape & ~np.isclose(values, cause.nulls)):
                lacking = " in all logs" if cause.standing else ""
                size = f"{lacking}: {parameters[i].name} {values[i]:.3g}"
                places.setdefault((cause.effect, size), []).append(cause.location)
        return [
            f"{effect} at {', '.join(own)}{size} {AT_END}, so something else may act there"
            for (effect, size), own in places.items()
        ]

    def provenance(self) -> dict[str, Any]:
        """What made it, of which logs."""
        return {
            "logs": [s.log.name for s in self.evidence.signals],
            "reference": [s.log.name for s in self.evidence.references],
            "robot": self.evidence.signals[0].subject.name,
            "seed": self.seed,
            "held_out": "blocks",
            "commit": provenance.git_commit(),
            "versions": provenance.versions(("hyperleg-design", "numpy", "scipy")),
        }


def _placed(name: Name) -> tuple[str, str]:
    """Effect and location of a candidate, in words where it acts at all of its places."""
    effect, location, _ = name
    return effect, "all its places" if location == EVERYWHERE else location


def _scaled(rival: Named, share: float) -> Named:
    return Named(
        rival.effect, rival.location, rival.probability * share, rival.closed, rival.parameters
    )
