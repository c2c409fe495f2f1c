"""One case of a trial: its truth beside what was said of it, and whether that is right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.results.diagnosis import NAMING
from hyperleg_design.validation.blind.trial import FAILED

RARELY = ("torque_saturation", "voltage_sag")
"""Effects that act in rare moments and then wholly: no size is small."""


@dataclass(frozen=True)
class Miss:
    """A case that was not answered rightly."""

    case: str
    kind: str
    plant: str
    robot: str
    truth: str
    """Effects, places and multiples."""
    said: str
    """Verdict and first causes."""
    probability: float | None
    """Of the first cause named."""
    why: str


class View:
    """One case's truth beside what was said."""

    def __init__(self, truth: Mapping[str, Any], diagnosis: Mapping[str, Any]) -> None:
        self.truth, self.diagnosis = truth, diagnosis
        self.kind, self.wrongs = str(truth["kind"]), list(truth["wrongs"])
        self.verdict = str(diagnosis.get("verdict", FAILED))
        self.causes = list(diagnosis.get("causes") or [])
        self.ranked = self.causes + list(diagnosis.get("rivals") or [])
        self.sets = [
            [_named(member) for member in group] for group in diagnosis.get("equivalent") or []
        ]
        self.effects = [w["effect"] for w in self.wrongs]

    @property
    def multiple(self) -> float:
        """Of the first effect, over the floor."""
        return float(self.wrongs[0]["multiple"])

    @property
    def least(self) -> float:
        """Of the multiples of several effects."""
        return min(float(w["multiple"]) for w in self.wrongs)

    @property
    def alarm(self) -> bool:
        """Whether a cause was named."""
        return self.verdict in NAMING

    @property
    def shown(self) -> bool | None:
        """Whether the logs show an effect of this size at its place, by what the diagnosis says of
        them; None where it does not say.

        Sizes of several parameters add up as squares.
        """
        wrong, sensitivity = self.wrongs[0], self.diagnosis.get("sensitivity") or []
        sizes = {
            p.name: p.null
            for p in EFFECTS[wrong["effect"]].parameters
            if p.name in wrong["parameters"] and not p.shape
        }
        if not sensitivity or not sizes or wrong["effect"] in RARELY:
            return None
        matching = [
            entry
            for entry in sensitivity
            if entry["effect"] == wrong["effect"]
            and entry["location"] in wrong["also"]
            and entry["parameter"] in sizes
        ]
        # what no possible size would show is in no list
        return bool(
            np.hypot.reduce(
                [
                    (wrong["parameters"][entry["parameter"]] - sizes[entry["parameter"]])
                    / entry["change"]
                    for entry in matching
                ]
            )
            >= 1.0
        )

    def first(self, *, lenient: bool = False) -> bool:
        """Whether the effect is the one named first, or, leniently, in one set with it.

        Args:
            lenient: whether one set with the effect suffices.

        Returns:
            True if so.
        """
        return bool(
            self.alarm
            and self.ranked
            and self._is(self.ranked[0]["effect"], self.effects[0], lenient)
        )

    def top_two(self) -> bool:
        """Whether it is among the first two of causes and rivals."""
        return bool(
            self.alarm and any(c["effect"] == self.effects[0] for c in self.ranked[:2])
        ) or self.first(lenient=True)

    def located(self) -> bool:
        """Whether the first cause sits at the right place, or a set with it holds the right effect
        at the right place.
        """
        if not (self.alarm and self.ranked):
            return False
        if self.first():
            return self.ranked[0]["location"] in self.wrongs[0]["also"]
        return any(
            e == self.effects[0] and (not p or p in self.wrongs[0]["also"])
            for g in self._with_first()
            for e, p in g
        )

    def all_found(self) -> bool:
        """Whether every effect is named at its place."""
        return all(self._found(w) for w in self.wrongs)

    def any_found(self) -> bool:
        """Whether one of them is."""
        return any(self._found(w) for w in self.wrongs)

    @property
    def closed(self) -> float | None:
        """Share of the excess gap that the first cause closes."""
        value = self.causes[0].get("closed") if self.causes else None
        return None if value is None else float(value)

    @property
    def probability(self) -> float | None:
        """Stated of the first cause."""
        value = self.ranked[0].get("probability") if self.alarm and self.ranked else None
        return None if value is None else float(value)

    def right(self) -> bool:
        """Whether the first cause is true: an effect that acts, at its place."""
        return bool(self.ranked) and any(
            self.ranked[0]["effect"] == w["effect"] and self.ranked[0]["location"] in w["also"]
            for w in self.wrongs
            if w["listed"]
        )

    def intervals(self) -> list[bool]:
        """Of each parameter stated and known: whether its interval holds the truth."""
        wrong = self.wrongs[0]
        cause = next(
            (
                c
                for c in self.ranked
                if c["effect"] == wrong["effect"] and c["location"] in wrong["also"]
            ),
            None,
        )
        held = []
        for name, value in (wrong["parameters"] if cause else {}).items():
            stated = cause["parameters"].get(name) if cause else None
            if stated and stated.get("low") is not None and stated.get("high") is not None:
                held.append(bool(stated["low"] <= value <= stated["high"]))
        return held

    def miss(self) -> Miss | None:
        """What was wrong with the answer; None where nothing was."""
        why = self._why()
        if not why:
            return None
        truth = (
            ", ".join(
                f"{w['effect']} at {w['location']} ({w['multiple']:.1f} x)" for w in self.wrongs
            )
            or "nothing"
        )
        causes = said_of(self.diagnosis)
        said = f"{self.verdict}{': ' if causes else ''}{causes}"
        return Miss(
            str(self.truth["case"]),
            self.kind,
            str(self.truth["plant"]),
            str(self.truth["robot"]),
            truth,
            said,
            self.probability,
            why,
        )

    def _why(self) -> str:
        if self.verdict == FAILED:
            return "error"
        if self.kind == "null":
            return "false alarm" if self.alarm else ""
        if self.kind == "outside":
            return "" if self.verdict == "unknown" else "not called unknown"
        if self.kind == "compound":
            return (
                ""
                if self.all_found()
                else ("one of two found" if self.any_found() else "neither found")
            )
        if not self.first(lenient=True):
            return "wrong effect" if self.alarm else "no cause named"
        return "" if self.located() else "wrong place"

    def _found(self, wrong: Mapping[str, Any]) -> bool:
        return self.alarm and any(
            c["effect"] == wrong["effect"] and c["location"] in wrong["also"] for c in self.causes
        )

    def _with_first(self) -> list[list[tuple[str, str]]]:
        first = (self.ranked[0]["effect"], self.ranked[0]["location"]) if self.ranked else ("", "")
        return [g for g in self.sets if any(e == first[0] and p in ("", first[1]) for e, p in g)]

    def _is(self, said: str, truth: str, lenient: bool) -> bool:
        return said == truth or (
            lenient and any(e == truth for g in self._with_first() for e, _ in g)
        )


def said_of(diagnosis: Mapping[str, Any]) -> str:
    """The causes that were named, and what else it may be where that was said.

    Args:
        diagnosis: as in `diagnosis.json`.

    Returns:
        The text.
    """
    verdict = diagnosis.get("verdict")
    if verdict not in NAMING:
        return str(diagnosis.get("message", ""))
    causes, rivals = (
        [f"{c['effect']} at {c['location']}" for c in diagnosis.get(k) or []]
        for k in ("causes", "rivals")
    )
    return ", ".join(causes) + (f", or {rivals[0]}" if verdict == "ambiguous" and rivals else "")


def _named(member: Any) -> tuple[str, str]:
    """Effect and location of a member of an equivalence set: an object, a pair, or a text
    `effect@location` or `effect at location`.
    """
    if isinstance(member, Mapping):
        return str(member["effect"]), str(member.get("location", ""))
    if isinstance(member, str):
        effect, _, location = member.replace(" at ", "@").replace("/", "@").partition("@")
        return effect, location
    return str(member[0]), str(member[1]) if len(member) > 1 else ""
