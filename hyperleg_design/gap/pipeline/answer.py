"""Everything of a decision that a diagnosis tells: verdict, gap, where, probabilities, rivals,
shapes of what is left, remarks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design import provenance
from hyperleg_design.gap.checks.check import Check
from hyperleg_design.gap.experiments import experiment
from hyperleg_design.gap.inference.decide import Decision
from hyperleg_design.gap.inference.detectors.holding import sticks, ungiven
from hyperleg_design.gap.inference.detectors.unsettled import swings
from hyperleg_design.gap.inference.equivalence import alike
from hyperleg_design.gap.inference.fit import Cause, Design
from hyperleg_design.gap.inference.held_out import Held, predict, untold
from hyperleg_design.gap.inference.judge import CHATTERS, Judge, rank
from hyperleg_design.gap.inference.model import Model
from hyperleg_design.gap.inference.naming import HELD, sticks_alone
from hyperleg_design.gap.inference.parameters import parameters
from hyperleg_design.gap.inference.preparation import Prepared
from hyperleg_design.gap.inference.regimes import worst
from hyperleg_design.gap.inference.samples import BLOCKS, LOGS
from hyperleg_design.gap.inference.shaping import tells
from hyperleg_design.gap.pipeline.beside_balances import of_heard
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

if TYPE_CHECKING:
    from hyperleg_design.gap.signals.signals import Signals

DRAWS = 400
"""Of the block bootstrap."""
LEAST_CHANGE = 0.01
"""Share of a gap that a small cause must make of it for others to be compared with it."""
MOST_SHAPES, MOST_ERRORS = 3, 12
"""Listed."""


class Answer:
    """Everything of a decision that the file tells."""

    def __init__(
        self,
        ready: Prepared,
        judge: Judge,
        found: Decision,
        seed: int,
        signals: list[Signals],
        references: list[Signals],
        checks: list[Check],
    ) -> None:
        self.ready, self.judge, self.found, self.seed = ready, judge, found, seed
        self.signals, self.references, self.checks = signals, references, checks
        samples = ready.base.samples
        shared = samples.sessions < len(signals)
        # a session that is held out whole cannot be calibrated: then blocks are held out, not logs
        self.way = LOGS if shared and samples.folds(LOGS) > 1 else BLOCKS
        self.kept: dict[int, tuple[Model, Held]] = {}

    def held(self, model: Model) -> Held:
        """Prediction of the data held out for the gap."""
        if self.way == BLOCKS:
            return model.held
        if (
            id(model) not in self.kept
        ):  # the model is kept too: another must not be given its identity
            self.kept[id(model)] = (
                model,
                predict(Design(self.judge.base, model.causes), self.way, fit=model.fit),
            )
        return self.kept[id(model)][1]

    def closed(self, model: Model) -> float:
        """Share of the excess gap that a model closes; of a small cause's, over what is left with
        it.
        """
        if self.small:
            chosen, rows = self.held(self.found.model), self.found.rows
            before, least, after = (
                float(self.judge.gap(v, rows))
                for v in (chosen.bare, chosen.square, self.held(model).square)
            )
            if before - least < LEAST_CHANGE * before:  # what it explains is in no residual
                return 0.0
            return float(np.clip((before - after) / (before - least), -9.99, 1.0))
        return float(
            np.clip(
                self.judge.closed(self.held(model), self.found.rows, self.held(self.found.model)),
                -9.99,
                1.0,
            )
        )

    @property
    def small(self) -> bool:
        """Whether a cause is named that stands out though it is not over the floor."""
        judge, found = self.judge, self.found
        return (
            bool(found.slots)
            and float(judge.gap(found.model.held.bare, found.rows)) < judge.thresholds.least_gap
        )

    def diagnosis(self) -> Diagnosis:
        """All of it."""
        judge, found = self.judge, self.found
        verdict = found.verdict
        if verdict in NAMING and not self.carries_over():
            verdict = "unknown"
        elif verdict in NAMING and self.way == LOGS and not self.told.all():
            # what some logs alone do not tell of a cause says nothing of how much it closes
            self.way = BLOCKS
        named = found.model.causes if verdict in NAMING else ()
        doubts = self.doubts()
        sets: list[list[Model]] = []
        if named:
            sets = [alike(judge, slot, found.model, found.rows) for slot in found.slots]
            if any(sets):
                verdict = "ambiguous"
        probabilities = self.probabilities(sets)
        if named and self.doubtful(probabilities[0], sets[0]):
            verdict, named, sets = "none", (), []
        causes, rivals = (
            self.named(probabilities) if verdict != "none" else ((), self.rivals_of_none())
        )
        if verdict == "unknown":
            rivals, causes = self.at_most_likely((*causes, *rivals)), ()
        equivalent = tuple(
            (found.model.causes[place].name, *(m.causes[self._differs(m)].name for m in group))
            for place, group in enumerate(sets)
            if group
        )
        trial = experiment.separating(equivalent[0]) if equivalent else None
        told = Diagnosis(
            verdict=verdict,
            gap=self.gap(bool(named)),
            where=self.where(),
            causes=tuple(causes),
            rivals=tuple(rivals[:MOST_RIVALS]),
            equivalent=equivalent,
            separating_experiment=None
            if trial is None
            else experiment.as_mapping(trial, equivalent[0]),
            not_judged=tuple(
                {"effect": n.effect, "location": n.location, "reason": n.reason}
                for n in found.not_judged
            ),
            residual_shape=self.shape(),
            checks=doubts,
            nuisance=self.nuisance(),
            provenance=self.provenance(),
            at_rest=tuple(
                {"location": j, "torque": t, "says": sticks(j, t)}
                for j, t in judge.holds.items()
                if not self.moot(j, t, named)
            ),
        )
        return told if found.heard is None else of_heard(told, found.heard)

    def doubtful(
        self, table: dict[tuple[tuple[str, str], ...], float], alike_first: Sequence[Model]
    ) -> bool:
        """Whether the first cause and what is like it are rather not it, with a gap that the
        floor's own doubt may be.
        """
        rules, rows = self.judge.thresholds, self.found.rows
        likely = sum(
            table.get(names, 0.0)
            for names in {self.found.model.names, *(m.names for m in alike_first)}
        )
        return (
            likely < rules.likely
            and float(self.judge.gap(self.found.model.held.bare, rows)) < rules.largest_excess
        )

    def carries_over(self) -> bool:
        """Whether causes also close the gap of whole logs that were held out: what stands for
        something else does so in one motion alone.

        Logs whose causes the others do not tell, as where one motor alone was warm in one log, say
        nothing of that.
        """
        judge, found = self.judge, self.found
        if self.way == BLOCKS or self.small or sticks_alone(judge, found.model, found.rows):
            return True
        if not self.told.any():
            return True
        held, told = self.held(found.model), self.told.astype(float)
        left = float(judge.gap(held.square, found.rows, told))
        return (
            left <= judge.thresholds.largest_excess
            or judge.closed(held, found.rows, held, told) >= judge.thresholds.worth
        )

    @cached_property
    def told(self) -> np.ndarray:
        """Blocks of logs whose causes the other logs tell `(B,)` of bool: so well that what is
        twice its deviation off closes `worth`.
        """
        model, samples = self.found.model, self.judge.base.samples
        known = (
            untold(Design(self.judge.base, model.causes), model.fit, LOGS)
            <= (1 - self.judge.thresholds.worth) / 2
        )
        found = np.zeros(self.judge.base.blocks, bool)
        found[samples.block] = known[samples.fold[LOGS][samples.part]]
        return found

    def moot(self, joint: str, torque: float, named: Sequence[Cause]) -> bool:
        """Whether named causes say that the torque which a joint seems to hold at rest never
        came.
        """
        return (
            bool(named)
            and ungiven(
                self.found.model, joint, [s.signals for s in self.judge.base.samples.filtered_logs]
            )
            >= HELD * torque
        )

    def _differs(self, model: Model) -> int:
        names = self.found.model.names
        return next(
            (i for i, name in enumerate(model.names) if name not in names), len(model.names) - 1
        )

    def draws(self) -> np.ndarray:
        """How often each block is drawn `(DRAWS, B)`."""
        rng = np.random.default_rng([self.seed, 20])
        count = self.judge.base.blocks
        return rng.multinomial(count, np.full(count, 1 / count), size=DRAWS).astype(float)

    def gap(self, named: bool) -> Shrinkage:
        """Before, after and floor over the rows that count, in their unit."""
        judge, rows = self.judge, self.found.rows if named else self.alike()
        model = self.found.model if named else judge.nothing
        scale = float(np.sqrt(judge.row_floor[rows].mean()))
        last = self.held(model)
        before, after = float(judge.gap(last.bare, rows)), float(judge.gap(last.square, rows))
        drawn = self.draws()
        b, a = judge.gap(last.bare, rows, drawn), judge.gap(last.square, rows, drawn)
        lowest = np.minimum(1.0, a)
        shares = np.where(b > lowest, (b - a) / np.maximum(b - lowest, 1e-9), 0.0)
        closed = self.closed(model) if named else 0.0
        low, high = (
            (float(v) for v in np.percentile(np.minimum(shares, 1.0), [2.5, 97.5]))
            if named
            else (0.0, 0.0)
        )
        units = dict.fromkeys(self.unit(r) for r in np.flatnonzero(rows).tolist())
        return Shrinkage(
            before * scale,
            after * scale,
            min(1.0, after) * scale,
            closed,
            (min(low, closed), max(high, closed)),
            ", ".join(units),
        )

    def unit(self, row: int) -> str:
        """Of a row, or of its episodes."""
        rows = self.judge.base.samples.rows
        return RESIDUALS[rows[row % len(rows)].residual_name][1]

    def alike(self) -> np.ndarray:
        """Of the rows that count, those in the unit of the one with the largest gap: all that one
        number can tell.
        """
        rows = np.flatnonzero(self.found.rows)
        largest = rows[np.argmax(self.judge.rows(self.judge.nothing.held.bare)[rows])]
        found = np.zeros_like(self.found.rows)
        found[[row for row in rows.tolist() if self.unit(row) == self.unit(int(largest))]] = True
        return found

    def where(self) -> tuple[Place, ...]:
        """Shares of the excess, and the regime of each place in which it is most."""
        judge, samples = self.judge, self.judge.base.samples
        whole = np.where(self.found.rows, judge.rows(self.found.model.held.bare), 0.0)
        calm = judge.rows(self.found.model.held.bare)[: len(samples.rows)]
        excess = judge.present * np.maximum(calm - 1, 0.0) + np.maximum(
            whole[len(samples.rows) :] - 1, 0.0
        )
        if self.small:
            left = judge.rows(self.found.model.held.square)[: len(samples.rows)]
            excess = np.where(
                self.found.rows[: len(samples.rows)], np.maximum(calm - left, 0.0), 0.0
            )
        shares: dict[tuple[str, str], float] = {}
        for row, value in zip(samples.rows, excess, strict=True):
            key = (
                row.name.rsplit("_", 1)[0]
                if row.residual_name == "ground"
                else "robot"
                if row.residual_name == "base"
                else row.name,
                RESIDUALS[row.residual_name][0],
            )
            shares[key] = shares.get(key, 0.0) + float(value)
        total = sum(shares.values())
        if total <= 0:
            return ()
        found = []
        for (name, kind), value in sorted(shares.items(), key=lambda item: (-item[1], item[0])):
            if value / total < LEAST_SHARE:
                continue
            found.append(Place(name, kind, "all", value / total))
        regimes = [worst(self.judge, p.location, p.kind) for p in found[:3]]
        return (*found, *(r for r in regimes if r is not None))

    def probabilities(
        self, sets: Sequence[Sequence[Model]]
    ) -> list[dict[tuple[tuple[str, str], ...], float]]:
        """Of every model in each slot: tempered held-out likelihoods of the rivals, of none and of
        unknown, made one.
        """
        rules, found = self.judge.thresholds, self.found
        shaped = found.shaped[0].gain if tells(rules, found.model, found.shaped) else 0.0
        slots: Sequence[Sequence[Model]] = found.slots or (found.singles,)
        tables = []
        for place, slot in enumerate(slots):
            models = list(
                {m.names: m for m in [*slot, *([found.model] if found.slots else [])]}.values()
            )
            other = (
                found.model.over
                if place == len(slots) - 1 and found.slots
                else max((m.over for m in models), default=0.0)
            )
            none = 0.0 if place == 0 else _without(found, place)
            unlisted = other + (CHATTERS if found.limit_cycle else shaped - rules.unlisted)
            scores = np.array([*(rank(m) for m in models), none, unlisted])
            weights = np.exp(rules.temperature * (scores - scores.max()))
            weights /= weights.sum()
            certain = np.minimum(weights, rules.most_certain)
            tables.append(
                {
                    m.names: float((1 - rules.doubt) * w)
                    for m, w in zip(models, certain, strict=False)
                }
            )
        return tables

    def named(
        self, tables: Sequence[dict[tuple[tuple[str, str], ...], float]]
    ) -> tuple[tuple[Named, ...], tuple[Named, ...]]:
        """Causes and rivals with parameters."""
        found, judge = self.found, self.judge
        slots: Sequence[Sequence[Model]] = found.slots or (found.singles,)
        causes: list[Named] = []
        total = self.closed(found.model) if found.slots else 0.0
        for place in range(len(found.model.causes)):
            rest = tuple(c for i, c in enumerate(found.model.causes) if i != place)
            alone = self.closed(judge.model(rest)) if rest else 0.0
            cause = found.model.causes[place]
            closed = total - alone if rest else total
            causes.append(
                Named(
                    *cause.name,
                    tables[place].get(found.model.names, 0.0),
                    closed,
                    parameters(judge, found.model, place),
                )
            )
        rivals: dict[tuple[str, str], Named] = {}
        for place, slot in enumerate(slots):
            for model in slot:
                differs = self._differs(model) if found.slots else 0
                name = model.causes[differs].name
                if name in found.model.names or name in rivals:
                    continue
                probability = tables[place].get(model.names, 0.0)
                rivals[name] = Named(
                    *name, probability, self.closed(model), parameters(judge, model, differs)
                )
        return tuple(causes), tuple(
            sorted(rivals.values(), key=lambda r: (-r.probability, -r.closed, r.effect, r.location))
        )

    def rivals_of_none(self) -> tuple[Named, ...]:
        """What was tried though nothing is wrong; what the rules did not find worth its name is
        less likely than that.
        """
        excess = (
            float(self.judge.gap(self.found.model.held.bare, self.found.rows))
            >= self.judge.thresholds.least_gap
        )
        table = self.probabilities([])[0]
        share = self.at_most(sum(table.values()))
        return tuple(
            Named(
                *m.causes[0].name,
                share * table.get(m.names, 0.0),
                self.closed(m) if excess else 0.0,
                parameters(self.judge, m, 0),
            )
            for m in self.found.singles[:3]
        )

    def at_most(self, total: float) -> float:
        """Factor by which probabilities are too large of what the rules did not find worth its
        name: that nothing of it is so is likelier.
        """
        return min(1.0, (1 - self.judge.thresholds.likely) / max(total, 1e-300))

    def at_most_likely(self, rivals: Sequence[Named]) -> tuple[Named, ...]:
        """Rivals of `unknown`: each has less than what else it may be."""
        share = self.at_most(sum(one.probability for one in rivals))
        return tuple(replace(one, probability=share * one.probability) for one in rivals)

    def shape(self) -> tuple[dict[str, Any], ...]:
        """What the residual beside the causes looks like."""
        samples = self.judge.base.samples
        found: list[dict[str, Any]] = []
        if self.found.together:
            says = (
                f"for {100 * self.found.together:.1f} % of the time most joints at once do not "
                f"follow their commands: these get lost or come late"
            )
            found.append(
                {
                    "shape": "lost_commands",
                    "location": "robot",
                    "says": says,
                    "closed_beyond": 0.0,
                    "gain": 0.0,
                }
            )
        for joint in self.found.limit_cycle:
            found.append(
                {
                    "shape": "chatter",
                    "location": joint,
                    "says": swings(self.signals, joint),
                    "closed_beyond": 0.0,
                    "gain": 0.0,
                }
            )
        for row, share in self.found.failing.items():
            gives = (
                "its drive does not give what it was told"
                if samples.rows[row].residual_name == "drive"
                else "it does not move as its torque says"
            )
            says = f"for {100 * share:.1f} % of the time {gives}, and no listed effect says why"
            found.append(
                {
                    "shape": "episodes",
                    "location": samples.rows[row].name,
                    "says": says,
                    "closed_beyond": 0.0,
                    "gain": 0.0,
                }
            )
        for one, gain, closed, _ in self.found.shaped[:MOST_SHAPES]:
            if gain > 0 and closed > 0:
                place = "robot" if one.row < 0 else samples.rows[one.row].name
                found.append(
                    {
                        "shape": one.name,
                        "location": place,
                        "says": one.says,
                        "closed_beyond": closed,
                        "gain": gain,
                    }
                )
        return tuple(found)

    def nuisance(self) -> tuple[dict[str, Any], ...]:
        """Largest nuisance parameters, in usual sizes."""
        fit, prior = self.found.model.fit, self.ready.base.prior
        errors = fit.errors + prior.mean
        rows: list[dict[str, Any]] = [
            {
                "error": one.name,
                "session": s,
                "value": float(errors[s, i] * one.spread),
                "usual": float(one.spread),
            }
            for s in range(len(errors))
            for i, one in enumerate(self.ready.errors)
        ]
        return tuple(
            sorted(rows, key=lambda r: (-abs(r["value"]) / r["usual"], r["error"], r["session"]))[
                :MOST_ERRORS
            ]
        )

    def doubts(self) -> tuple[str, ...]:
        """Remarks on the logs."""
        found = []
        for check in self.checks:
            found += [
                f"{check.name}: {f.severity}: {f.signal + ' ' if f.signal else ''}{f.what}"
                for f in check.findings
                if f.severity in (WARNING, NOTE)
            ]
        for s in (*self.signals, *self.references):
            found += [f"{s.log.name}: {note}" for note in s.notes]
        found += self.ready.learned
        if not self.ready.calibrated:
            found.append(
                "no reference logs: the floor is that of a robot known as well as robots usually "
                "are"
            )
        samples = self.ready.base.samples
        for row, one in enumerate(samples.rows):
            own = samples.episodic[samples.group[samples.row == row]]
            share = float(own.mean()) if own.size else 0.0
            if share > 0.01:
                found.append(
                    f"{one.residual_name} of {one.name}: episodes of much larger residuals, "
                    f"{100 * share:.0f} % of the time, count for little"
                )
        return tuple(dict.fromkeys(found))

    def provenance(self) -> dict[str, Any]:
        """What made it, of which logs."""
        return {
            "logs": [s.log.name for s in self.signals],
            "reference": [s.log.name for s in self.references],
            "robot": self.signals[0].subject.name,
            "seed": self.seed,
            "held_out": "logs" if self.way == LOGS else "blocks",
            "commit": provenance.git_commit(),
            "versions": provenance.versions(("hyperleg-design", "numpy", "scipy")),
        }


def _without(found: Decision, place: int) -> float:
    """Evidence over the floor of the model before a cause was added, for slots after the first."""
    return max((m.over for m in found.slots[place - 1] if len(m.causes) == place), default=0.0)
