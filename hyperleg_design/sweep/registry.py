"""All measures by one name each: those that `analyze` and sweeps compute of a design, and those
that `evaluate` measures of its trials.

A measure of trials is named `PROTOCOL.NAME`, such as `walk.cost_of_transport`; the name alone is
enough where only one of the protocols at hand has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation import measures as trial_measures
from hyperleg_design.robot import parameters
from hyperleg_design.sweep import measures as sizing

PROTOCOLS = {"walk": trial_measures.WALK, "t_test": trial_measures.T_TEST}
"""Measures of trials by protocol."""
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

    @property
    def of_trial(self) -> str:
        """Name of the measure in a single trial, as `hyperleg evaluate` prints it."""
        return self.name.split(".", 1)[1] if self.protocol else self.name


@cache
def entries() -> dict[str, Entry]:
    """All measures by name, those of designs first."""
    known = {
        column: Entry(column, m.unit, m.better, m.doc)
        for m in sizing.MEASURES.values()
        for column in m.columns
    }
    for protocol, table in PROTOCOLS.items():
        for name, entry in table.items():
            full = f"{protocol}.{name}"
            known[full] = Entry(full, entry.unit, _BETTER[entry.better], entry.meaning, protocol)
    return known


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
    known = entries()
    if name in known and not known[name].protocol:
        return known[name]
    if name in known:
        if known[name].protocol not in protocols:
            raise InputError(
                where, "", name, f"needs that {known[name].protocol} is evaluated (--evaluate)"
            )
        return known[name]
    at_hand = [p for p in protocols if f"{p}.{name}" in known]
    if len(at_hand) == 1:
        return known[f"{at_hand[0]}.{name}"]
    if at_hand:
        full = " or ".join(f"{p}.{name}" for p in at_hand)
        raise InputError(where, "", name, f"is measured by several protocols; give {full}")
    having = [p for p in PROTOCOLS if f"{p}.{name}" in known]
    if having:
        raise InputError(
            where, "", name, f"needs that {' or '.join(having)} is evaluated (--evaluate)"
        )
    raise InputError(
        where,
        "",
        name,
        parameters.unknown(name, sorted(known)).replace("such field", "such measure")
        + "; hyperleg list measures shows all",
    )


def label(name: str) -> str:
    """Write a measure's name with unit, for figures and tables.

    Args:
        name: of the measure.

    Returns:
        The text.
    """
    entry = entries()[name]
    text = name.replace("_", " ").replace(".", ", ")
    return f"{text} [{entry.unit.replace('^2', '²')}]" if entry.unit else text
