"""The analysis plan of a study, fixed before its trainings are run: outcomes, arms, margins and
when a training counts as finished.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.measures import T_TEST, WALK
from hyperleg_design.evaluation.result import arrivals_only
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import (
    check_keys,
    checked_mapping,
    checked_number,
    checked_whole_number,
)
from hyperleg_design.robot.parameters.fields import number, text
from hyperleg_design.robot.parameters.values import Checked

if TYPE_CHECKING:
    import pandas as pd

MEASURES = {"walk": WALK, "t_test": T_TEST}
"""Measures of each protocol."""
ONLY_COMPLETE = (
    "time",
    "mean_speed",
    "energy",
    "battery_energy",
    "power",
    "joule_power",
    "mechanical_power",
    "positive_power",
    "negative_power",
    "driver_loss",
    "battery_power",
    "cost_of_transport",
    "battery_cost_of_transport",
)
"""Measures of a whole run, which one that ends early cannot give: its power is that of a fall. They
count over arrivals only."""


def counted(table: pd.DataFrame, measure: str) -> pd.DataFrame:
    """Leave out what trials that did not arrive give of a measure of whole runs.

    Args:
        table: of trials.
        measure: name of a column.

    Returns:
        The table; of the measures `ONLY_COMPLETE`, values of arrivals only, NaN elsewhere.
    """
    return arrivals_only(table, measure) if measure in ONLY_COMPLETE else table


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(Checked):
    """A measure that is compared between arms."""

    protocol: Any = text(*MEASURES)
    """Protocol under which the outcome is measured."""
    measure: Any = text()
    """Name, of `evaluation/measures.py`."""
    trials: Any = text("all", "arrived")
    """Trials that count."""
    margin: Any = number("", 0.001, 1, default=1.0)
    """Relative difference of the means within which arms count as equivalent [-]; of primary
    outcomes only."""

    @property
    def name(self) -> str:
        """Full name of the outcome: its protocol, a dot, and its measure."""
        return f"{self.protocol}.{self.measure}"


@dataclass(frozen=True, eq=False, kw_only=True)
class PlateauRule(Checked):
    """When the reward of a training has stopped rising; see `plateau`."""

    share: Any = number("", 0.05, 0.5, default=0.2)
    """Share of the steps, at the end of a training, that is judged [-]."""
    level: Any = number("", 1e-6, 0.5, default=0.05)
    """Level of the one-sided test of a gain [-]."""
    gain: Any = number("", 0.0, 1, default=0.02)
    """Gain over the mean's magnitude up to which a certain gain is too small to matter [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AnalysisPlan(Checked):
    """What is compared and how."""

    name: str
    active: str
    """Design whose benefit is asked about."""
    compared: str
    """Design that it is compared with."""
    attribution: tuple[str, ...]
    """Further designs, that tell joint, motor and mass apart."""
    seeds: Mapping[str, int]
    """Fewest trainings of each design, by protocol."""
    level: Any = number("", 1e-6, 0.5, default=0.05)
    """Level of the two-sided test of each primary outcome, and of the family of the others [-]."""
    power: Any = number("", 0.5, 0.999, default=0.8)
    """Power at which the smallest detectable difference is stated [-]."""
    primary: tuple[Outcome, ...]
    secondary: tuple[Outcome, ...]
    """Corrected together by Holm's method."""
    plateau: PlateauRule = field(default_factory=PlateauRule)

    @property
    def designs(self) -> tuple[str, ...]:
        """All arms of the study: the active toe, the compared design and those for attribution."""
        return (self.active, self.compared, *self.attribution)


def load_plan(name: str | Path = "analysis_plan") -> AnalysisPlan:
    """Read an analysis plan from a shipped file or a file of the user.

    Args:
        name: a shipped name, or a YAML file.

    Returns:
        The validated plan.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find("sim", name, noun="analysis_plan")
    return plan_from_mapping(read_yaml(path), given_path(path))


def plan_from_mapping(data: Mapping[str, Any], where: str) -> AnalysisPlan:
    """Build an analysis plan from nested mappings, as YAML gives them.

    Args:
        data: fields of the plan by name.
        where: name of the file, for error messages.

    Returns:
        The validated plan.

    Raises:
        InputError: unknown or missing field, a measure that the protocol does not have, an outcome
            named twice, or one that needs arrivals and asks for all trials.
    """
    needed = ("name", "arms", "attribution", "seeds", "level", "power", "primary", "secondary")
    check_keys(data, where, "", needed, ("plateau",))
    arms, seeds = data["arms"], data["seeds"]
    if not isinstance(arms, Mapping) or set(arms) != {"active", "compared"}:
        raise InputError(where, "arms", arms, "expects active and compared, a design each")
    if not isinstance(data["attribution"], list):
        raise InputError(where, "attribution", data["attribution"], "expects a list of designs")
    if not isinstance(seeds, Mapping) or set(seeds) != set(MEASURES):
        raise InputError(where, "seeds", seeds, f"expects a number for {', '.join(MEASURES)}")
    primary, secondary = (
        tuple(
            _outcome(entry, where, f"{kind}.{i}", primary=kind == "primary")
            for i, entry in enumerate(_list(data[kind], where, kind))
        )
        for kind in ("primary", "secondary")
    )
    names = [outcome.name for outcome in (*primary, *secondary)]
    for name in names:
        if names.count(name) > 1:
            raise InputError(where, "secondary", name, "is an outcome twice; name it once")
    plan = AnalysisPlan(
        name=str(data["name"]),
        active=str(arms["active"]),
        compared=str(arms["compared"]),
        attribution=tuple(str(design) for design in data["attribution"]),
        seeds={
            key: checked_whole_number(value, where, f"seeds.{key}", 2, 1000)
            for key, value in seeds.items()
        },
        level=checked_number(data["level"], where, "level"),
        power=checked_number(data["power"], where, "power"),
        primary=primary,
        secondary=secondary,
        plateau=parameters.from_mapping(PlateauRule, data.get("plateau", {}), where, "plateau"),
    )
    if len(set(plan.designs)) < len(plan.designs):
        raise InputError(where, "arms", list(plan.designs), "names a design twice")
    return plan


def _outcome(data: Any, where: str, path: str, *, primary: bool) -> Outcome:
    data = checked_mapping(data, where, path)
    if primary != ("margin" in data):
        remedy = "is missing" if primary else "stands with primary outcomes only"
        raise InputError(where, f"{path}.margin", data.get("margin"), remedy)
    outcome = parameters.from_mapping(Outcome, data, where, path)
    if outcome.measure not in MEASURES[outcome.protocol]:
        raise InputError(
            where,
            f"{path}.measure",
            outcome.measure,
            parameters.unknown(outcome.measure, sorted(MEASURES[outcome.protocol])),
        )
    if outcome.measure in ONLY_COMPLETE and outcome.trials != "arrived":
        raise InputError(
            where,
            f"{path}.trials",
            outcome.trials,
            f"{outcome.measure} of a run that ends early is not comparable; expects arrived",
        )
    return outcome


def _list(value: Any, where: str, path: str) -> list[Any]:
    if not isinstance(value, list) or not value:
        raise InputError(where, path, value, "expects a list of outcomes")
    return value
