"""Causes of one effect at several places, which people read as one: twelve torque constants of 0.8
are one matter, not twelve.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.effects.families import FRICTION
from hyperleg_design.report.gap.choices import chosen

FEWEST = 3
"""Places from which causes of one effect are one line."""
MOST_NAMED = 4
"""Places that are named; more are counted."""


@dataclass(frozen=True)
class Span:
    """Range of one parameter over several places."""

    name: str
    unit: str
    least: float
    most: float
    """Of the values."""
    low: float
    high: float
    """Ends of all intervals."""
    words: str
    """What was chosen, of a parameter that is a choice; empty of a size."""


def together(causes: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    """Group causes of one effect, in the same units, at `FEWEST` places or more.

    Args:
        causes: as `diagnosis.json` holds them.

    Returns:
        Groups in the order of their first causes; a cause that is in no group is one alone.
    """
    groups: dict[Any, list[Mapping[str, Any]]] = {}
    for cause in causes:
        groups.setdefault(_key(cause), []).append(cause)
    large = {key for key, group in groups.items() if len(group) >= FEWEST}
    ordered: dict[Any, list[Mapping[str, Any]]] = {}
    for number, cause in enumerate(causes):
        key = _key(cause)
        ordered.setdefault(key if key in large else number, []).append(cause)
    return list(ordered.values())


def _key(cause: Mapping[str, Any]) -> tuple[str, tuple[str, ...]]:
    units = (str(value["unit"]) for value in cause["parameters"].values())
    return str(cause["effect"]), tuple(units)


def places(causes: Sequence[Mapping[str, Any]]) -> str:
    """Name the places of some causes of one effect, or count them where they are many.

    Args:
        causes: as `diagnosis.json` holds them.

    Returns:
        Names such as `hip, knee`, or a count such as `12 motors`.
    """
    names = [str(cause["location"]) for cause in causes]
    if len(names) <= MOST_NAMED:
        return ", ".join(names)
    effect = EFFECTS.get(str(causes[0]["effect"]))
    kind = effect.kind if effect is not None else "place"
    return f"{len(names)} {'feet' if kind == 'foot' else f'{kind}s'}"


def span_text(least: float, most: float, digits: int = 3, word: str = "to") -> str:
    """Write a range, or one number where both ends read alike.

    Args:
        least: lower end.
        most: upper end.
        digits: significant digits.
        word: between the ends.

    Returns:
        The text.
    """
    return f" {word} ".join(dict.fromkeys(f"{end:.{digits}g}" for end in (least, most)))


def spans(causes: Sequence[Mapping[str, Any]]) -> list[Span]:
    """Compute the range of each parameter over causes of one effect.

    Args:
        causes: of one effect, as `diagnosis.json` holds them.

    Returns:
        One range for each parameter that all causes have.
    """
    rows = [
        {
            name: (value, words)
            for name, value, words in chosen(cause["effect"], cause["parameters"])
        }
        for cause in causes
    ]
    ranges = []
    for name in rows[0]:
        if not all(name in row for row in rows):
            continue
        values = [row[name][0] for row in rows]
        words = dict.fromkeys(row[name][1] for row in rows if row[name][1])
        ranges.append(
            Span(
                name=name,
                unit=str(values[0]["unit"]),
                least=min(float(value["value"]) for value in values),
                most=max(float(value["value"]) for value in values),
                low=min(float(value["low"]) for value in values),
                high=max(float(value["high"]) for value in values),
                words=" or ".join(words),
            )
        )
    return ranges


def telling(group: Sequence[Mapping[str, Any]]) -> str:
    """Name the size of some causes of one effect that tells most: that of `Effect.telling`, else
    the first that is clearly there, or else the first one.

    Args:
        group: causes, as `diagnosis.json` holds them.

    Returns:
        Name of the parameter, or of what follows from some; empty where they have no size.
    """
    effect = EFFECTS.get(str(group[0]["effect"]))
    nulls = {} if effect is None else {p.name: p.null for p in effect.parameters}
    sizes = [span for span in spans(group) if not span.words and span.low < span.high]
    if effect is not None and any(span.name == effect.telling for span in sizes):
        return effect.telling
    clear = [span for span in sizes if not span.low <= nulls.get(span.name, 0.0) <= span.high]
    return next((span.name for span in (*clear, *sizes)), "")


def of_every_day(difference: Mapping[str, Any]) -> str:
    """Say of a difference between references that it is no fault.

    Args:
        difference: an element of `reference_differences`.

    Returns:
        The words; empty where it may be a fault.
    """
    return ", as friction does from day to day" if difference["effect"] in FRICTION else ""
