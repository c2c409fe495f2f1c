"""Bounds on measures that designs of a search must keep."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.trial_table import FEWEST_ARRIVALS

_BOUND = re.compile(r"\s*([\w.]+)\s*(<=|>=)\s*(\S+)\s*")


@dataclass(frozen=True)
class Constraint:
    """A bound on a measure."""

    name: str
    """Full name of the measure."""
    bound: float
    at_most: bool
    """Whether the measure must not be above the bound; else not below."""

    @property
    def text(self) -> str:
        """The constraint as `read_constraint` reads it."""
        return f"{self.name}{'<=' if self.at_most else '>='}{self.bound:.10g}"

    def violation(self, value: float) -> float:
        """Amount by which a value breaks the constraint; not positive where the constraint holds,
        infinite where the value is unknown.

        Args:
            value: of the measure.

        Returns:
            The amount, in the measure's unit.
        """
        if not np.isfinite(value):
            return float("inf")
        return value - self.bound if self.at_most else self.bound - value


def read_constraint(text: str, protocols: Sequence[str]) -> Constraint:
    """A constraint from a text such as `walk.thermal_peak<=1`.

    Args:
        text: measure, `<=` or `>=`, and a number.
        protocols: that are evaluated.

    Returns:
        The constraint.

    Raises:
        InputError: no such form, measure, or number.
    """
    match = _BOUND.fullmatch(text)
    try:
        if match is None:
            raise ValueError
        bound = float(match[3])
        if not np.isfinite(bound):
            raise ValueError
    except ValueError:
        remedy = "expects MEASURE<=NUMBER or MEASURE>=NUMBER, the number finite"
        raise InputError("--constraint", "", text, remedy) from None
    entry = registry.resolve(match[1], protocols, "--constraint")
    return Constraint(entry.name, bound, match[2] == "<=")


def usual_constraints(protocols: Sequence[str]) -> tuple[Constraint, ...]:
    """Designs that walk, with heat and torque within bounds (assumed), under each protocol.

    Args:
        protocols: that are evaluated.

    Returns:
        The constraints.
    """
    return _with_limits(protocols, Constraint("arrived", FEWEST_ARRIVALS, at_most=False))


def earlier_constraints(protocols: Sequence[str]) -> tuple[Constraint, ...]:
    """The usual constraints of searches that were begun when falls were bounded, not arrivals.

    Args:
        protocols: that are evaluated.

    Returns:
        The constraints, in the order in which databases of such searches hold them.
    """
    return _with_limits(protocols, Constraint("fell", 0.05, at_most=True))


def _with_limits(protocols: Sequence[str], ending: Constraint) -> tuple[Constraint, ...]:
    """A bound on how trials end, and those on heat and torque, under each protocol."""
    limits = (Constraint("thermal_peak", 1.0, True), Constraint("limit_share", 0.05, True))
    return tuple(
        dataclasses.replace(bound, name=f"{protocol}.{bound.name}")
        for protocol in protocols
        for bound in (ending, *limits)
    )
