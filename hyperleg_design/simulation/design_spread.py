"""Designs that a training draws from, and those that are kept apart for checks: ranges of leaves,
and how many designs with which seed.
"""

from __future__ import annotations

import dataclasses
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.names import LAYOUTS
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.simulation.design_observation import DesignRanges, design_ranges
from hyperleg_design.simulation.drives.actuation import motor_friction
from hyperleg_design.simulation.drives.machine import machine_of
from hyperleg_design.simulation.model import simulation_model

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.simulation.settings import Physics

TRIES = 4
"""Designs that are drawn for each that is needed before drawing is given up: some ranges have
corners that are no robots."""


@dataclass(frozen=True, kw_only=True)
class DesignSpread:
    """What designs a training draws from; read from `sim/designs_*.yaml` or a user's file."""

    ranges: DesignRanges
    pool: int = 128
    """Designs in the pool."""
    seed: int = 1
    """Of the pool: two trainings with different seeds have the same designs."""
    redraw_every: int = 50
    """Iterations for which a simulation keeps its design."""
    held_out: int = 12
    """Designs for checks, drawn from the same ranges and never trained on."""
    held_out_seed: int = 1000
    """Of the designs for checks, other than `seed`."""
    variants: tuple[str, ...] = ()
    """Toe layouts that the ranges are meant for, of `LAYOUTS`; any robot where empty."""

    def to_mapping(self) -> dict[str, Any]:
        """Write the spread as JSON takes it.

        Returns:
            Nested mappings.
        """
        written = {"ranges": self.ranges.to_mapping(), "variants": list(self.variants)}
        return {**dataclasses.asdict(self), **written}

    def designs(self, base: RobotDesign) -> RobotDesign:
        """Draw the pool of designs for training.

        Args:
            base: the robot whose leaves are replaced.

        Returns:
            A batch of `pool` designs.

        Raises:
            InputError: another toe layout than the ranges are meant for, a leaf that the robot
                lacks, or too few robots in the ranges.
        """
        self._check_variant(base)
        return _drawn(base, self.ranges, self.pool, self.seed)

    def held_out_designs(self, base: RobotDesign) -> RobotDesign:
        """Draw the designs for checks.

        Args:
            base: the robot whose leaves are replaced.

        Returns:
            A batch of `held_out` designs.

        Raises:
            InputError: as in `designs`.
        """
        self._check_variant(base)
        return _drawn(base, self.ranges, self.held_out, self.held_out_seed)

    def check_robot(self, base: RobotDesign, physics: Physics) -> None:
        """Check that the ranges suit a robot: it has every leaf, and each changes its simulation.

        Args:
            base: the robot whose leaves are replaced.
            physics: settings of the simulation.

        Raises:
            InputError: leaves that the robot lacks, or whose two ends give the same model and
                actuation, such as those of a toe motor that is not there; too few robots in the
                ranges.
        """
        self.designs(base)
        idle = [path for path in self.ranges.ranges if not self._has_effect(path, base, physics)]
        if idle:
            remedy = (
                f"changes nothing in the simulation of {base.variant or base.name}; "
                f"leave out {', '.join(idle)}"
            )
            raise InputError("design ranges", idle[0], None, remedy)

    def _check_variant(self, base: RobotDesign) -> None:
        if self.variants and base.variant not in self.variants:
            raise InputError(
                "design ranges",
                "variants",
                list(self.variants),
                f"expects a robot of one of these toe layouts, not {base.variant or base.name}; "
                f"--designs names other ranges",
            )

    def _has_effect(self, path: str, base: RobotDesign, physics: Physics) -> bool:
        bounds = self.ranges.ranges[path]
        try:
            low, high = (
                _simulated(base.with_values({path: value}, "design ranges"), physics)
                for value in (bounds.low, bounds.high)
            )
        except InputError:  # an end may be no robot beside the other leaves of `base`
            return True
        return low != high


_WHOLE = {
    "pool": (1, 1024),
    "seed": (0, 2**31),
    "redraw_every": (1, 1e6),
    "held_out": (1, 1024),
    "held_out_seed": (0, 2**31),
}
"""Least and largest value of the numbers in a file."""


def load_design_spread(name: str | Path) -> DesignSpread:
    """Read the designs that a training draws from.

    Args:
        name: a shipped name such as `toe`, or a YAML file with `ranges:` of leaves (`low`, `high`,
            `log`), and the other fields of `DesignSpread` where they differ from its defaults.

    Returns:
        The validated spread.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find_sim("designs", name)
    return design_spread(read_yaml(path), given_path(path))


def design_spread(data: Mapping[str, Any], where: str) -> DesignSpread:
    """Build a spread of designs from nested mappings, as YAML gives them.

    Args:
        data: `ranges`, and other fields of `DesignSpread`.
        where: file, for error messages.

    Returns:
        The validated spread.

    Raises:
        InputError: unknown or missing field, or a value that makes no sense.
    """
    texts = ("description", "ranges", "variants")
    values = {key: value for key, value in data.items() if key not in texts}
    for key, value in values.items():
        if key not in _WHOLE:
            raise InputError(
                where,
                str(key),
                value,
                parameters.unknown(str(key), ["ranges", "variants", *_WHOLE]),
            )
        low, high = _WHOLE[key]
        whole = isinstance(value, int) and not isinstance(value, bool)
        if not whole or not low <= value <= high:
            raise InputError(where, key, value, f"expects a whole number, {low:g} .. {high:g}")
    variants = data.get("variants", [])
    if not isinstance(variants, list) or not all(v in LAYOUTS for v in variants):
        remedy = f"expects a list of {', '.join(LAYOUTS)}"
        raise InputError(where, "variants", variants, remedy)
    ranges = design_ranges(data.get("ranges"), f"{where}: ranges")
    spread = DesignSpread(ranges=ranges, variants=tuple(variants), **values)
    if spread.seed == spread.held_out_seed:
        raise InputError(
            where, "held_out_seed", spread.seed, "must differ from seed, or checks see the pool"
        )
    return spread


def _simulated(design: RobotDesign, physics: Physics) -> bytes:
    """All that the simulation of a robot computes with."""
    model = simulation_model(design, physics)
    buffer = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, buffer=buffer)
    machine, friction = machine_of(design), motor_friction(design)
    return buffer.tobytes() + pickle.dumps((vars(machine), friction))


def _drawn(base: RobotDesign, ranges: DesignRanges, count: int, seed: int) -> RobotDesign:
    """Designs drawn evenly over ranges, without those that are no robots, a batch.

    Raises:
        InputError: leaves that the robot lacks, or too many of the drawn designs are no robots;
            names the last one's reason.
    """
    ranges.check_leaves(base, "design ranges")
    rng = np.random.default_rng(seed)
    drawn: list[dict[str, Any]] = []
    error: InputError | None = None
    for _ in range(TRIES * count):
        values = {path: value[0] for path, value in ranges.draw(1, rng).items()}
        try:
            base.with_values(values, "design ranges")
        except InputError as reason:
            error = reason
            continue
        drawn.append(values)
        if len(drawn) == count:
            break
    else:
        assert error is not None
        raise InputError(
            "design ranges",
            error.field,
            error.value,
            f"{error.remedy}; only {len(drawn)} of {TRIES * count} drawn designs are robots: "
            f"narrow the ranges",
        )
    return base.with_values(
        {path: np.array([values[path] for values in drawn]) for path in ranges.ranges}
    )
