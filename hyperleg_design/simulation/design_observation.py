"""What a policy may observe of its own design: chosen numbers of the robot, scaled by the ranges
over which designs are drawn in training.

A policy that is conditioned on its design has these numbers in its observation; its file carries
the ranges, so that an evaluation can say whether a design lies inside them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters import values as parameters

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

RANGES = "design_ranges"
"""Metadata of a policy that is conditioned on its design: its ranges."""
WITHIN = 1e-9
"""Share of a range by which rounding may put a number outside of it."""


@dataclass(frozen=True)
class Range:
    """Values that one leaf of a design takes in training."""

    low: float
    """Smallest value, in the unit of the leaf."""
    high: float
    """Largest value, in the unit of the leaf."""
    log: bool = False
    """Whether its logarithm is observed, for leaves that are drawn evenly in it."""

    def __post_init__(self) -> None:
        if not (np.isfinite([self.low, self.high]).all() and self.low < self.high):
            raise InputError(
                "design ranges", "", [self.low, self.high], "expects finite low < high"
            )
        if self.log and self.low <= 0:
            raise InputError("design ranges", "low", self.low, "must be positive with log")

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """Scale values linearly, or their logarithms: -1 at the low end, 1 at the high one.

        Args:
            values: `(...)`.

        Returns:
            The scaled values [-], `(...)`.
        """
        low, high = (np.log([self.low, self.high])) if self.log else (self.low, self.high)
        place = np.log(values) if self.log else values
        return np.asarray(2 * (place - low) / (high - low) - 1)


@dataclass(frozen=True)
class DesignRanges:
    """The design part of an observation: one number a leaf, in the order of `ranges`."""

    ranges: Mapping[str, Range]
    """Ranges by dotted path of the leaf."""

    @property
    def columns(self) -> list[str]:
        """A name for each number."""
        return [f"design.{path}" for path in self.ranges]

    def numbers(self, design: RobotDesign) -> np.ndarray:
        """Compute the numbers of a design that a policy observes.

        Args:
            design: a robot or a batch of n.

        Returns:
            The numbers, within -1 .. 1 inside the ranges, `(k,)` or `(n, k)`.
        """
        values = [
            bounds.scaled(np.asarray(design[path], float)) for path, bounds in self.ranges.items()
        ]
        return np.stack(np.broadcast_arrays(*values), -1)

    def outside(self, design: RobotDesign) -> list[str]:
        """List the leaves of a robot that lie outside their range.

        Args:
            design: one robot.

        Returns:
            Dotted paths.
        """
        numbers = self.numbers(design)
        return [
            path
            for path, value in zip(self.ranges, numbers, strict=True)
            if not abs(value) <= 1 + 2 * WITHIN
        ]

    def check_inside(self, design: RobotDesign, where: str) -> None:
        """Check that a policy with these ranges was trained over a robot.

        Args:
            design: one robot.
            where: policy or file, for error messages.

        Raises:
            InputError: the robot lacks a leaf of the ranges, or has a value outside of them.
        """
        missing = [path for path in self.ranges if path not in design.rules]
        if missing:
            raise InputError(
                where,
                missing[0],
                None,
                f"is observed by the policy, but {design.name} has no such leaf; choose a robot "
                f"like those that the policy was trained on",
            )
        for path in self.outside(design)[:1]:
            bounds, value = self.ranges[path], float(design[path])
            raise InputError(
                where,
                path,
                value,
                f"expects {bounds.low:g} .. {bounds.high:g}, over which the policy was trained; "
                f"choose a design inside, or a policy of one design",
            )

    def check_leaves(self, design: RobotDesign, where: str) -> None:
        """Check that a robot has a number for every range.

        Args:
            design: the robot, or a batch of its kind.
            where: file, for error messages.

        Raises:
            InputError: a path that is no single number of the robot.
        """
        rules, robot = design.rules, design.variant or design.name
        missing = [path for path in self.ranges if path not in rules]
        if missing:
            more = f"; nor has {robot} {', '.join(missing[1:])}" if missing[1:] else ""
            remedy = f"{parameters.unknown(missing[0], sorted(rules))}{more}"
            raise InputError(where, missing[0], None, f"of {robot}: {remedy}")
        for path in self.ranges:
            if rules[path].kind != "number" or rules[path].size:
                raise InputError(where, path, None, "is not a single number; choose another leaf")

    def draw(self, count: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """Draw designs evenly over the ranges.

        Args:
            count: number of designs.
            rng: random numbers.

        Returns:
            Values by path, `(count,)` each.
        """
        drawn = {}
        for path, bounds in self.ranges.items():
            place = rng.random(count)
            drawn[path] = (
                bounds.low * (bounds.high / bounds.low) ** place
                if bounds.log
                else bounds.low + place * (bounds.high - bounds.low)
            )
        return drawn

    def to_mapping(self) -> dict[str, Any]:
        """Write the ranges as plain values, for the metadata of a policy.

        Returns:
            `{low, high, log}` by dotted path.
        """
        return {path: vars(bounds) for path, bounds in self.ranges.items()}


def design_ranges(data: Any, where: str) -> DesignRanges:
    """Build ranges from what `DesignRanges.to_mapping` gives, or what a file holds.

    Args:
        data: `{low, high}` by dotted path.
        where: file, for error messages.

    Returns:
        The validated ranges.

    Raises:
        InputError: no mapping, or no range. `check_leaves` says whether a robot has the leaves.
    """
    if not isinstance(data, Mapping) or not data:
        raise InputError(where, "", data, "expects a mapping of leaves to {low, high}")
    ranges = {}
    for path, entry in data.items():
        if not isinstance(path, str):
            raise InputError(where, str(path), entry, "expects the dotted path of a leaf")
        if not isinstance(entry, Mapping) or not {"low", "high"} <= set(entry) <= {
            "low",
            "high",
            "log",
        }:
            raise InputError(where, path, entry, "expects {low, high}, and log: true if wanted")
        try:
            ranges[path] = Range(
                float(entry["low"]), float(entry["high"]), bool(entry.get("log", False))
            )
        except (TypeError, ValueError):
            raise InputError(where, path, dict(entry), "expects numbers low and high") from None
        except InputError as error:
            raise InputError(where, path, dict(entry), error.remedy) from None
    return DesignRanges(ranges)
