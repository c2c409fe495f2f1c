"""A diagnosis as `diagnosis.json` holds it (`diagnosis_schema.json`): verdict, gap, where, causes,
rivals, what to do next.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.reading import read_json, short_name
from hyperleg_design.writing import write_json

SCHEMA = 1
VERDICTS = ("explained", "ambiguous", "none", "unknown")
NAMING = ("explained", "ambiguous")
"""Verdicts by which causes are named."""
MOST_RIVALS = 8
"""Listed."""
LEAST_SHARE = 0.02
"""Of the excess, below which a place is not listed."""
SCHEMA_FILE = Path(__file__).with_name("diagnosis_schema.json")
DIGITS = 6
"""Significant digits of numbers."""


@dataclass(frozen=True)
class Value:
    """A parameter with its 95 % interval."""

    value: float
    low: float
    """Lower end of the interval."""
    high: float
    """Upper end of the interval."""
    unit: str
    """Unit of the three numbers; empty without one."""


@dataclass(frozen=True)
class Named:
    """A cause, or a rival of one."""

    effect: str
    """Identifier of the effect."""
    location: str
    """Joint, motor, link, foot or sensor where it acts."""
    probability: float
    """Posterior probability [-]."""
    closed: float
    """Share of the excess gap that it closes on held-out data; of several causes, what it adds to
    those before."""
    parameters: Mapping[str, Value]
    """Parameters of the effect by name."""

    def mapping(self) -> dict[str, Any]:
        """Write the cause as the file holds it.

        Returns:
            Nested mappings.
        """
        values = {
            n: {"value": p.value, "low": p.low, "high": p.high, "unit": p.unit}
            for n, p in self.parameters.items()
        }
        return {
            "effect": self.effect,
            "location": self.location,
            "probability": self.probability,
            "closed": self.closed,
            "parameters": values,
        }


@dataclass(frozen=True)
class Shrinkage:
    """How large the gap is and how far it shrinks, on held-out data, over the rows that count."""

    before: float
    """Size of the gap with the nominal model."""
    after: float
    """Size of the gap with the causes added."""
    floor: float
    """Size that the noise model expects."""
    closed: float
    """Share of the gap beyond that size which the causes close [-]."""
    closed_interval: tuple[float, float]
    """95 % interval of this share [-]."""
    unit: str
    """Unit of `before`, `after` and `floor`."""


@dataclass(frozen=True)
class Place:
    """One place at which the gap lies, in one regime of its motion, and its share of the gap."""

    location: str
    """Name of the joint, motor, link, foot or sensor."""
    kind: str
    """`joint`, `motor`, `link`, `foot`, `sensor` or `robot`."""
    regime: str
    """`all`, or what joint, motor or foot was doing."""
    share: float
    """Of the squared excess; in a regime, of that of its place."""


@dataclass(frozen=True)
class Diagnosis:
    """The answer of a diagnosis: verdict, gap, causes, rivals, and what to do next."""

    verdict: str
    """One of `VERDICTS`."""
    gap: Shrinkage
    """Size of the gap before and after the causes are added."""
    where: tuple[Place, ...]
    """Where the gap lies, the largest share first."""
    causes: tuple[Named, ...]
    """Causes that close the gap together."""
    rivals: tuple[Named, ...]
    """Other candidates, the most probable first."""
    equivalent: tuple[tuple[tuple[str, str], ...], ...]
    """Sets of (effect, location) that these data cannot tell apart."""
    separating_experiment: Mapping[str, Any] | None
    """The cheapest experiment that tells such a set apart; None where there is none."""
    not_judged: tuple[Mapping[str, str], ...] = ()
    """Effects that could not be tried, and why."""
    residual_shape: tuple[Mapping[str, Any], ...] = ()
    """What the residual that no cause explains looks like, the largest first."""
    checks: tuple[str, ...] = ()
    """Remarks on the logs."""
    at_rest: tuple[Mapping[str, Any], ...] = ()
    """Joints that hold more than all known friction while they stand: `location`, `torque` beyond
    it [Nm], and `says`."""
    sensitivity: tuple[Mapping[str, Any], ...] = ()
    """Smallest change of each effect's parameters that these logs would have shown, see
    `sensitivity`."""
    nuisance: tuple[Mapping[str, Any], ...] = ()
    """Nuisance parameters that were fitted along, the largest first, in usual sizes."""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    """Robot, logs, versions, seed and commit."""
    remainder: float | None = None
    """Share of the gap that no listed effect explains, where something unlisted acts."""
    lacks: Mapping[str, Any] | None = None
    """With reference logs, what the model lacks of them already: `verdict` and `causes` in the same
    form; no part of the verdict."""

    def mapping(self) -> dict[str, Any]:
        """Write the diagnosis as `diagnosis.json` holds it.

        Returns:
            Nested mappings; numbers are rounded to `DIGITS` significant digits.
        """
        gap = {
            "before": self.gap.before,
            "after": self.gap.after,
            "floor": self.gap.floor,
            "closed": self.gap.closed,
            "closed_interval": list(self.gap.closed_interval),
            "unit": self.gap.unit,
        }
        found = {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "gap": gap,
            "where": [
                {"location": w.location, "kind": w.kind, "regime": w.regime, "share": w.share}
                for w in self.where
            ],
            "causes": [c.mapping() for c in self.causes],
            "rivals": [r.mapping() for r in self.rivals],
            "equivalent": [
                [{"effect": e, "location": p} for e, p in group] for group in self.equivalent
            ],
            "separating_experiment": None
            if self.separating_experiment is None
            else dict(self.separating_experiment),
            "not_judged": [dict(one) for one in self.not_judged],
            "residual_shape": [dict(one) for one in self.residual_shape],
            "checks": list(self.checks),
            "at_rest": [dict(one) for one in self.at_rest],
            "sensitivity": [dict(one) for one in self.sensitivity],
            "nuisance": [dict(one) for one in self.nuisance],
            "provenance": dict(self.provenance),
        }
        if self.remainder is not None:
            found["remainder"] = self.remainder
        if self.lacks is not None:
            found["lacks"] = dict(self.lacks)
        rounded: dict[str, Any] = _rounded(found)
        return rounded


def write_diagnosis(path: str | Path, diagnosis: Diagnosis) -> Path:
    """Write a diagnosis as JSON, whole or not at all.

    Args:
        path: of the file.
        diagnosis: the diagnosis.

    Returns:
        The path.

    Raises:
        OutputError: it cannot be written, or a number in it is not finite.
    """
    return write_json(path, diagnosis.mapping())


def read_diagnosis(path: str | Path) -> Diagnosis:
    """Read a diagnosis from its `diagnosis.json`.

    Args:
        path: of the file.

    Returns:
        The diagnosis.

    Raises:
        InputError: it cannot be read, or is no diagnosis of this schema.
    """
    path = Path(path)
    where = short_name(path)
    content = read_json(path)
    if not isinstance(content, dict) or content.get("schema") != SCHEMA:
        found = content.get("schema") if isinstance(content, dict) else None
        raise InputError(
            where,
            "schema",
            found,
            f"expects {SCHEMA}: this is no diagnosis, or one of another version",
        )
    if content.get("verdict") not in VERDICTS:
        raise InputError(
            where, "verdict", content.get("verdict"), f"expects one of {', '.join(VERDICTS)}"
        )
    try:
        gap = content["gap"]
        low, high = gap["closed_interval"]
        numbers = {name: float(gap[name]) for name in ("before", "after", "floor", "closed")}
        return Diagnosis(
            verdict=content["verdict"],
            gap=Shrinkage(
                **numbers, closed_interval=(float(low), float(high)), unit=str(gap["unit"])
            ),
            where=tuple(
                Place(str(w["location"]), str(w["kind"]), str(w["regime"]), float(w["share"]))
                for w in content["where"]
            ),
            causes=_named(content["causes"]),
            rivals=_named(content["rivals"]),
            equivalent=tuple(
                tuple((str(m["effect"]), str(m["location"])) for m in group)
                for group in content["equivalent"]
            ),
            separating_experiment=content["separating_experiment"],
            not_judged=tuple(content.get("not_judged", ())),
            residual_shape=tuple(content.get("residual_shape", ())),
            checks=tuple(content.get("checks", ())),
            at_rest=tuple(content.get("at_rest", ())),
            sensitivity=tuple(content.get("sensitivity", ())),
            nuisance=tuple(content.get("nuisance", ())),
            provenance=dict(content.get("provenance", {})),
            remainder=None if content.get("remainder") is None else float(content["remainder"]),
            lacks=content.get("lacks"),
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            where, "", None, f"is not a whole diagnosis ({type(error).__name__}: {error})"
        ) from None


def _named(entries: Sequence[Mapping[str, Any]]) -> tuple[Named, ...]:
    return tuple(
        Named(
            str(one["effect"]),
            str(one["location"]),
            float(one["probability"]),
            float(one["closed"]),
            {
                str(n): Value(float(p["value"]), float(p["low"]), float(p["high"]), str(p["unit"]))
                for n, p in one["parameters"].items()
            },
        )
        for one in entries
    )


def _rounded(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(v) for v in value]
    if isinstance(value, bool) or value is None or isinstance(value, str):
        return value
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else value
    return value
