"""Whether a policy was trained for the design that it is evaluated on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.evaluation.policy import OnnxPolicy, Policy
from hyperleg_design.robot.kinematics.dimensions import limb_mass, total_mass
from hyperleg_design.robot.parameters.values import leaves
from hyperleg_design.simulation.design_observation import RANGES, design_ranges
from hyperleg_design.simulation.drives.actuation import actuation_model
from hyperleg_design.simulation.drives.machine import rotor_inertia

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

SPECIALIST, CONDITIONED, ZERO_SHOT, UNKNOWN = "specialist", "conditioned", "zero-shot", "unknown"
_NO_ROBOT = ("masses.expected_",)
"""Leaves that are printed sums, not parts of a robot."""
_LAWS = ("reference.", "friction.", "gears.", "masses.")
"""Sections that say how masses and friction follow from the other parts."""
_SHOWN = 3


@dataclass(frozen=True)
class TrainingFit:
    """What a policy's training had to do with the design that it is evaluated on."""

    kind: str
    """`specialist`: trained on this design alone; `conditioned`: trained over a range of designs
    that it observes; `zero-shot`: trained on another design; `unknown`: it does not say."""
    changed: Mapping[str, tuple[Any, Any]] = field(default_factory=dict)
    """Leaves that differ, by path: as trained, as evaluated."""
    outside: tuple[str, ...] = ()
    """Those of them that lie outside what it was trained over."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units of the leaves that differ, by path; empty for a number without unit."""

    def text(self) -> str:
        """Describe the fit for tables.

        Returns:
            The kind, and what lies outside of the trained range.
        """
        if not self.outside:
            return self.kind
        shown = ", ".join(
            f"{path} {_short(self.changed[path][0])} -> {_short(self.changed[path][1])} "
            f"{self.units.get(path, '')}".rstrip()
            for path in self.outside[:_SHOWN]
        )
        rest = len(self.outside) - _SHOWN
        more = f" and {rest} more" if rest > 0 else ""
        return f"{self.kind}, outside the trained range: {shown}{more}"


def training_fit(policy: Policy, design: RobotDesign) -> TrainingFit:
    """Compare the design that a policy was trained on, or its ranges, with one robot.

    Args:
        policy: an ONNX policy knows the design, or the ranges of designs, that it was trained on.
        design: the robot that it is evaluated on.

    Returns:
        Whether the policy is a specialist for this robot, conditioned on designs like it, or was
        not trained for it (zero-shot), and the parameters that differ.
    """
    if not isinstance(policy, OnnxPolicy):
        return TrainingFit(UNKNOWN)
    trained, own = leaves(policy.design), leaves(design)
    if trained.keys() != own.keys():
        return TrainingFit(ZERO_SHOT)
    changed = {
        path: (trained[path], value)
        for path, value in own.items()
        if not path.startswith(_NO_ROBOT) and not _equal(trained[path], value)
    }
    parts = {path: pair for path, pair in changed.items() if not path.startswith(_LAWS)}
    if parts or _same_actuation(policy.design, design):
        changed = parts  # laws only say how a robot follows from its parts
    units = {path: design.rules[path].unit for path in changed}
    if RANGES in policy.metadata:
        ranges = design_ranges(policy.metadata[RANGES], f"{policy.name}: {RANGES}")
        beyond = set(ranges.outside(cast("Design", design)))
        outside = tuple(p for p in changed if p in beyond or p not in ranges.ranges)
        return TrainingFit(ZERO_SHOT if outside else CONDITIONED, changed, outside, units)
    return TrainingFit(ZERO_SHOT if changed else SPECIALIST, changed, tuple(changed), units)


def _same_actuation(a: RobotDesign, b: RobotDesign) -> bool:
    """Whether laws give the same masses, motors and friction to two robots of the same parts."""
    first, other = actuation_model(a), actuation_model(b)
    pairs = [
        *((getattr(first, n), getattr(other, n)) for n in ("coulomb", "viscous", "rated_torque")),
        (first.joint_from_motor, other.joint_from_motor),
        (rotor_inertia(a), rotor_inertia(b)),
        (first.envelope.peak_torque, other.envelope.peak_torque),
        *((mass(a), mass(b)) for mass in (total_mass, limb_mass)),
    ]
    return all(np.allclose(x, y, rtol=1e-6) for x, y in pairs)


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, str) or isinstance(b, str) or isinstance(a, bool):
        return bool(a == b)
    return np.shape(a) == np.shape(b) and bool(np.allclose(a, b, rtol=1e-9, atol=1e-15))


def _short(value: Any) -> str:
    if np.ndim(value):
        return "[" + " ".join(f"{v:.4g}" for v in np.ravel(value)) + "]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
