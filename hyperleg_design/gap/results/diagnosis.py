"""A diagnosis as `diagnosis.json` holds it (`diagnosis_schema.json`): verdict, gap, where, causes,
rivals, what to do next.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_json

SCHEMA = 1
VERDICTS = ("explained", "ambiguous", "none", "unknown")
NAMING = ("explained", "ambiguous")
"""Verdicts by which causes are named."""
MOST_RIVALS = 8
"""Number of rivals that a diagnosis lists at most."""
LEAST_SHARE = 0.02
"""Share of the excess below which a place is not listed [-]."""
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
    """Posterior probability that it acts [-]."""
    closed: float
    """Share of the excess gap that it closes on held-out data, at the residuals in which it shows;
    of several causes, the share that would stay open without it [-]."""
    parameters: Mapping[str, Value]
    """Parameters of the effect by name."""

    def mapping(self) -> dict[str, Any]:
        """Write the cause as the file holds it.

        Returns:
            Nested mappings.
        """
        return asdict(self)


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


def residual_shape(
    shape: str, location: str, description: str, closed_beyond: float
) -> dict[str, Any]:
    """Make one of the shapes that a diagnosis lists.

    Args:
        shape: its name.
        location: joint, motor, foot or sensor.
        description: what was seen, in a sentence that goes on from the location.
        closed_beyond: share of the gap beyond all causes that it explains.

    Returns:
        Its fields.
    """
    return {
        "shape": shape,
        "location": location,
        "says": description,
        "closed_beyond": closed_beyond,
    }


@dataclass(frozen=True)
class Diagnosis:
    """The answer of a diagnosis: verdict, gap, causes, rivals, and what to do next."""

    verdict: str
    """The answer in a word, one of `VERDICTS`."""
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
    sensitivity: tuple[Mapping[str, Any], ...] = ()
    """Smallest change of each effect's parameters that these logs would have shown, see
    `gap/inference/detectable.py`."""
    provenance: Mapping[str, Any] = field(default_factory=dict)
    """Robot, logs, versions, seed and commit."""
    remainder: float | None = None
    """Share of the gap that no listed effect explains, where something unlisted acts."""
    lacks: Mapping[str, Any] | None = None
    """With reference logs, what the model lacks of them already: `verdict` and `causes` in the same
    form; no part of the verdict."""
    reference_differences: tuple[Mapping[str, Any], ...] = ()
    """Reference logs that differed from the others: `log`, and by what, as a cause in the same
    form. It was taken out of the log before tests were compared with it."""

    def mapping(self) -> dict[str, Any]:
        """Write the diagnosis as `diagnosis.json` holds it.

        Returns:
            Nested mappings; numbers are rounded to `DIGITS` significant digits.
        """
        content = {"schema": SCHEMA, **asdict(self)}
        content["equivalent"] = [
            [{"effect": effect, "location": place} for effect, place in group]
            for group in self.equivalent
        ]
        for name in ("remainder", "lacks"):
            if content[name] is None:
                del content[name]
        rounded: dict[str, Any] = _rounded(content)
        return rounded


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
    where = given_path(path)
    content = read_json(path)
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema != SCHEMA:
        remedy = f"expects {SCHEMA}: this is no diagnosis, or one of another version"
        raise InputError(where, "schema", schema, remedy)
    if (verdict := content.get("verdict")) not in VERDICTS:
        raise InputError(where, "verdict", verdict, f"expects one of {', '.join(VERDICTS)}")
    try:
        values: dict[str, Any] = {
            field.name: tuple(value) if isinstance(value, list) else value
            for field in fields(Diagnosis)
            if (value := content.get(field.name, field.default)) is not MISSING
        }
        interval = tuple(content["gap"]["closed_interval"])
        values["gap"] = Shrinkage(**{**content["gap"], "closed_interval": interval})
        values["where"] = tuple(Place(**place) for place in content["where"])
        values["causes"], values["rivals"] = _named(content["causes"]), _named(content["rivals"])
        values["equivalent"] = tuple(
            tuple((cause["effect"], cause["location"]) for cause in group)
            for group in content["equivalent"]
        )
        return Diagnosis(**values)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        what = f"is not a whole diagnosis ({type(error).__name__}: {error})"
        raise InputError(where, "", None, what) from None


def _named(entries: Sequence[Mapping[str, Any]]) -> tuple[Named, ...]:
    return tuple(
        Named(**{**entry, "parameters": {n: Value(**v) for n, v in entry["parameters"].items()}})
        for entry in entries
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
