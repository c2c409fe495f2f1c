"""All measures by one name each: those that `analyze` and sweeps compute of a design, and those
that `evaluate` measures of its trials.

A measure of trials is named `PROTOCOL.NAME`, such as `walk.cost_of_transport`; the name alone is
enough where only one of the protocols at hand has it.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures as trial_measures
from hyperleg_design.sweep.measuring import measures as sizing
from hyperleg_design.sweep.measuring.measure import MEASURES, TREE

PROTOCOLS = {"walk": trial_measures.WALK, "t_test": trial_measures.T_TEST}
"""Measures of trials by protocol."""
MOST_NEAREST = 5
"""Measures that the error of an unknown one names."""
_WAYPOINT = re.compile(r"waypoint_[1-9]\d*")
"""Measures that a T-test has for each waypoint of its course."""
_BETTER = {trial_measures.LESS: "low", trial_measures.MORE: "high", trial_measures.NEITHER: ""}


@dataclass(frozen=True)
class Entry:
    """One number of a design."""

    name: str
    """Column of a table."""
    unit: str
    better: str
    """`low`, `high`, or empty where neither is."""
    doc: str
    protocol: str = ""
    """Protocol of the trials that it is measured in; empty for a measure of the design alone."""


@cache
def entries() -> dict[str, Entry]:
    """List all measures, those of designs first.

    Returns:
        Entries by name.
    """
    known = {
        column: Entry(column, m.unit, m.better, m.doc)
        for m in MEASURES.values()
        for column in m.columns
    }
    for protocol, table in PROTOCOLS.items():
        for name, entry in table.items():
            full = f"{protocol}.{name}"
            known[full] = Entry(full, entry.unit, _BETTER[entry.better], entry.meaning, protocol)
    return known


def entry(name: str) -> Entry:
    """Look up a measure by its full name.

    Joints of a design that writes its tree out and arrivals at waypoints, which only some designs
    and protocols have, are among them.

    Args:
        name: full, such as `walk.cost_of_transport`.

    Returns:
        The entry of the registry.

    Raises:
        KeyError: no such measure.
    """
    known = entries()
    if name in known:
        return known[name]
    protocol, _, rest = name.partition(".")
    if is_waypoint(protocol, rest):
        arrival = trial_measures.measure_of(rest)
        return Entry(name, arrival.unit, _BETTER[arrival.better], arrival.meaning, protocol)
    measure = sizing.measure_of(name)
    if TREE not in measure.families:
        raise KeyError(name)
    return Entry(name, measure.unit, measure.better, measure.doc)


def is_waypoint(protocol: str, name: str) -> bool:
    """Decide whether a measure of a trial is the time of arrival at a waypoint of a protocol's
    course.

    Args:
        protocol: kind of the protocol.
        name: of the measure.

    Returns:
        True if it is.
    """
    return protocol == "t_test" and bool(_WAYPOINT.fullmatch(name))


def is_measure(name: str) -> bool:
    """Decide whether a full name is that of a measure; see `entry`.

    Args:
        name: the full name.

    Returns:
        True if it is.
    """
    try:
        entry(name)
    except KeyError:
        return False
    return True


def resolve(name: str, protocols: Sequence[str] = (), where: str = "measures") -> Entry:
    """Find a measure by its full name or by its name in a trial.

    Args:
        name: full, or that of a trial alone.
        protocols: that are run.
        where: for messages.

    Returns:
        The entry of the registry.

    Raises:
        InputError: no such measure, one of a protocol that is not run, or one of several.
    """
    if is_measure(name):
        match = entry(name)
        if match.protocol and match.protocol not in protocols:
            raise InputError(
                where, "", name, f"needs that {match.protocol} is evaluated (--evaluate)"
            )
        return match
    at_hand = [p for p in protocols if is_measure(f"{p}.{name}")]
    if len(at_hand) == 1:
        return entry(f"{at_hand[0]}.{name}")
    if at_hand:
        full = " or ".join(f"{p}.{name}" for p in at_hand)
        raise InputError(where, "", name, f"is measured by several protocols; give {full}")
    having = [p for p in PROTOCOLS if is_measure(f"{p}.{name}")]
    if having:
        raise InputError(
            where, "", name, f"needs that {' or '.join(having)} is evaluated (--evaluate)"
        )
    nearest = ", ".join(nearest_measures(name))
    question = f"did you mean {nearest}? " if nearest else ""
    remedy = f"no such measure; {question}hyperleg list measures shows all"
    raise InputError(where, "", name, remedy)


def nearest_measures(name: str) -> list[str]:
    """List measures that a name that does not exist may stand for.

    Args:
        name: such as `mass` or `walk.cot`.

    Returns:
        Full names, the shortest first: of measures that have the name as one of their words
        (`leg_mass`) or as their initials (`walk.cost_of_transport`) or, where there are none, of
        those that are spelled most alike.
    """
    protocol, _, last = name.rpartition(".")
    alike = []
    for full in entries():
        own, _, measure = full.rpartition(".")
        words = measure.split("_")
        initials = "".join(word[:1] for word in words)
        if protocol in ("", own) and (last in words or last == initials):
            alike.append(full)
    near = sorted(alike, key=len) or difflib.get_close_matches(name[:100], entries(), n=3)
    return near[:MOST_NEAREST]


def label(name: str) -> str:
    """Write a measure's name with unit, for figures and tables.

    Args:
        name: of the measure.

    Returns:
        The text.
    """
    unit = entry(name).unit
    text = name.replace("_", " ").replace(".", ", ")
    return f"{text} [{unit.replace('^2', '²')}]" if unit else text
