"""The space of designs that a sweep covers: sampled from one seed, made into designs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.robot.ablation import ablate
from hyperleg_design.robot.design import Design
from hyperleg_design.robot.motors import find_motor
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.values import leaves
from hyperleg_design.sweep.spaces.axis import Axis

AS_DESCRIBED = "as_described"
"""The one variant of a design that has no ablations."""


@dataclass(frozen=True)
class Map:
    """A measure to draw over two axes, or over one."""

    x: str
    y: str
    """Empty for a curve over x alone."""
    measure: str


@dataclass(frozen=True, eq=False)
class Sweep:
    """A sweep definition, checked against its base design."""

    name: str
    description: str
    base: RobotDesign
    """Design with `set` applied and the active toe; variants are made of it after the axes are
    set."""
    variants: tuple[str, ...]
    sampling: str
    """One of `SAMPLINGS`."""
    count: int
    """Samples; each is evaluated once a variant."""
    seed: int
    axes: tuple[Axis, ...]
    measures: tuple[str, ...]
    """Names of the measures to compute, of `measures.MEASURES`."""
    objectives: tuple[str, ...]
    """Columns that span Pareto fronts."""
    maps: tuple[Map, ...]
    source: str
    evaluated: tuple[str, ...] = ()
    """Protocols that the designs are meant to be evaluated under: `walk`, `t_test`."""
    trial_objectives: tuple[str, ...] = ()
    """Further objectives, measured on trials, by their full names."""
    trial_maps: tuple[Map, ...] = ()
    """Further maps, of measures of trials."""

    @property
    def has_variants(self) -> bool:
        """Whether the designs are ablations; those that describe their own tree are not."""
        return self.variants != (AS_DESCRIBED,)

    @property
    def size(self) -> int:
        """Rows of the table: samples times variants."""
        return self.count * len(self.variants)

    def samples(self) -> dict[str, np.ndarray]:
        """Draw the values of all samples; they are the same for the same seed.

        Returns:
            Values by axis, `(count,)` each.
        """
        if self.sampling == "grid":
            index = np.unravel_index(np.arange(self.count), [len(a.levels) for a in self.axes])
            return {
                axis.name: np.asarray(axis.levels)[i]
                for axis, i in zip(self.axes, index, strict=True)
            }
        positions = _positions(
            self.sampling, self.count, len(self.axes), np.random.default_rng(self.seed)
        )
        return {axis.name: axis.at(positions[:, i]) for i, axis in enumerate(self.axes)}

    def ablated(self, design: RobotDesign, variant: str) -> RobotDesign:
        """Turn a design into one of the sweep's variants.

        Args:
            design: a robot or batch.
            variant: name of the ablation.

        Returns:
            The ablated design; a design that describes its own tree is returned unchanged.
        """
        return ablate(design, variant) if isinstance(design, Design) else design

    def design(self, samples: Mapping[str, np.ndarray], variant: str) -> RobotDesign:
        """Make the batch of designs of some samples.

        Args:
            samples: values by axis, `(n,)` each.
            variant: name of the ablation.

        Returns:
            The batch of n designs.

        Raises:
            InputError: one of them makes no design.
        """
        values: dict[str, Any] = {}
        for axis in self.axes:
            values |= axis.leaf_values(self.base, np.asarray(samples[axis.name]))
        return self.ablated(self.base.with_values(values, self.name), variant)

    def to_mapping(self) -> dict[str, Any]:
        """Write all that decides the numbers in the table as plain values.

        Returns:
            Nested mappings.
        """
        used = {str(actuator.motor) for actuator in self.base.every_actuator}
        if isinstance(self.base, Design):
            parts = ("hip", "knee", "ankle", "toe")
            used |= {str(getattr(self.base.reference, f"{p}_motor")) for p in parts}
        else:
            references = {p: v for p, v in leaves(self.base).items() if p.startswith("reference.")}
            used |= {str(v) for p, v in references.items() if p.endswith(".motor")}
        used |= {str(v) for axis in self.axes if not axis.numeric for v in axis.levels}
        return {
            "name": self.name,
            "description": self.description,
            "design": self.base.to_mapping(),
            "motors": {name: _motor_mapping(name) for name in sorted(used)},
            "variants": list(self.variants),
            "sampling": self.sampling,
            "count": self.count,
            "seed": self.seed,
            "axes": {axis.name: axis.to_mapping() for axis in self.axes},
            "measures": list(self.measures),
            "objectives": list(self.objectives),
            "maps": [{"x": m.x, "y": m.y, "measure": m.measure} for m in self.maps],
            **({"evaluate": list(self.evaluated)} if self.evaluated else {}),
        }

    def digest(self) -> str:
        """Compute the SHA-256 of `to_mapping`, which tells two definitions apart.

        Returns:
            The digest in hexadecimal.
        """
        return hashlib.sha256(json.dumps(self.to_mapping(), sort_keys=True).encode()).hexdigest()


def _motor_mapping(name: str) -> dict[str, Any]:
    motor = find_motor(name)
    return {
        "constants": {k: c.value for k, c in motor.constants.items()},
        "resistance": motor.resistance_convention,
        "current": motor.current_convention,
        "presets": {
            p: {k: c.value for k, c in constants.items()} for p, constants in motor.presets.items()
        },
    }


def _positions(sampling: str, count: int, dimensions: int, rng: np.random.Generator) -> np.ndarray:
    """Points in the unit cube, `(count, dimensions)`, below 1."""
    if sampling == "random":
        return rng.random((count, dimensions))
    if sampling == "latin_hypercube":
        strata = np.stack([rng.permutation(count) for _ in range(dimensions)], -1)
        return (strata + rng.random((count, dimensions))) / count
    from scipy.stats import qmc

    # drawn to the next power of two, for which the sequence is balanced, and cut
    points: np.ndarray = qmc.Sobol(dimensions, scramble=True, rng=rng).random_base2(
        max(0, (count - 1).bit_length())
    )
    return points[:count]
