"""What a sizing measure is, and the register of all of them, which `measures` fills."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.reading import summary_line
from hyperleg_design.robot import (
    transmission,
)
from hyperleg_design.robot.load import FAMILIES
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sweep.measuring.batch import Batch

HYPERLEG, TREE = FAMILIES
BOTH = FAMILIES
"""Families of the measures that every design has."""


@dataclass(frozen=True)
class Measure:
    """A column, or one a part, of a sweep's table."""

    name: str
    unit: str
    """SI; empty for ratios."""
    better: str
    """`low` or `high`: what a designer wants of it."""
    parts: tuple[str, ...]
    """Suffixes of its columns; empty for one column named after it."""
    doc: str
    compute: Callable[[Batch], np.ndarray]
    families: tuple[str, ...] = (HYPERLEG,)
    """Families of the designs that have it."""
    usual: bool = True
    """Whether a sweep that does not say which measures it wants computes it."""
    parts_of: Callable[[Any], Iterable[str]] = transmission.joint_names
    """Parts of a design that writes its tree out: its joints by default."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of its columns for HyperLeg."""
        return self.columns_of(None)

    def columns_of(self, design: RobotDesign | None) -> tuple[str, ...]:
        """Name the columns of the measure.

        Args:
            design: a robot; HyperLeg where there is none.

        Returns:
            One name for each part, or one for the whole robot.
        """
        tree = self.parts and isinstance(design, TreeDesign)
        parts = self.parts_of(design) if tree else self.parts
        return tuple(f"{self.name}.{part}" for part in parts) or (self.name,)


MEASURES: dict[str, Measure] = {}
"""All measures by name, in the order of the table."""


def measure(
    unit: str,
    better: str,
    parts: tuple[str, ...] = (),
    *,
    families: tuple[str, ...] = (HYPERLEG,),
    usual: bool = True,
    name: str = "",
    parts_of: Callable[[Any], Iterable[str]] = transmission.joint_names,
) -> Callable[[Callable[[Batch], np.ndarray]], Callable[[Batch], np.ndarray]]:
    """Register a function as a measure; its docstring is the measure's.

    Args:
        unit: of the values; empty without one.
        better: `low` or `high`, the direction that is better.
        parts: joints or motors that the measure has a value for each of; empty for one value a
            design.
        families: of the designs that have the measure.
        usual: whether sweeps that do not list their measures compute it.
        name: of the measure; that of the function by default.
        parts_of: gives the parts of a design that describes its own tree; its joints by default.

    Returns:
        A decorator, which returns the function unchanged.

    Raises:
        ValueError: the name is taken, or docstring or direction is missing.
    """

    def register(function: Callable[[Batch], np.ndarray]) -> Callable[[Batch], np.ndarray]:
        title, doc = name or function.__name__, summary_line(function)
        if title in MEASURES or better not in ("low", "high") or not doc:
            raise ValueError(
                f"measure {title} is there already, or lacks a docstring or a direction"
            )
        MEASURES[title] = Measure(
            title, unit, better, parts, doc, function, families, usual, parts_of
        )
        return function

    return register
