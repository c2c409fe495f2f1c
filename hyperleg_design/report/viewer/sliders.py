"""Which parameters of a design the page offers as sliders, and what a slider's factor changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

LOWEST, HIGHEST = 0.5, 2.0
"""Range of the factors [-], that of the shipped sweeps."""
_HYPERLEG = {
    "Reductions": (
        "actuators.hip_yaw.gear",
        "actuators.hip_roll.gear",
        "actuators.hip_pitch.gear",
        "transmission.scale.knee",
        "transmission.scale.ankle_pitch",
        "transmission.scale.ankle_roll",
        "transmission.scale.toe_ankle_pitch",
        "transmission.scale.toe",
    ),
    "Masses": ("pelvis.mass", "thigh.mass", "shank.mass", "foot.mass", "toe.mass"),
    "Lengths": (
        "thigh.length",
        "shank.length",
        "foot.heel_length",
        "foot.ball_length",
        "toe.length",
    ),
}


@dataclass(frozen=True)
class Parameter:
    """A slider: a factor on some leaves of a design."""

    group: str
    """Heading under which the slider stands."""
    label: str
    """Dotted path of the leaf, or the link whose length is meant."""
    paths: tuple[str, ...]
    """Leaves that the factor multiplies; of vectors, all entries."""
    value: float
    """Of the unchanged design, for the label [unit]."""
    unit: str = ""
    """SI unit of `value`."""


def parameters_of(design: RobotDesign) -> tuple[Parameter, ...]:
    """List the sliders of a design: its reductions, masses and lengths.

    Args:
        design: one robot of any family.

    Returns:
        The parameters.
    """
    if isinstance(design, TreeDesign):
        return _of_tree(design)
    parameters = []
    for group, paths in _HYPERLEG.items():
        for path in paths:
            if design["toe.joint"] == "none" and "toe" in path:
                continue
            parameters.append(
                Parameter(group, path, (path,), float(design[path]), design.rules[path].unit)
            )
    return tuple(parameters)


def _of_tree(design: TreeDesign) -> tuple[Parameter, ...]:
    """Gears, ratios between motors and joints, masses of links, and lengths of links."""
    parameters = [
        Parameter("Reductions", path, (path,), float(design[path]))
        for name in design.actuator_sections
        for path in (f"actuators.{name}.gear",)
    ]
    parameters += [
        Parameter("Reductions", path, (path,), float(design[path]))
        for path, rule in design.rules.items()
        if path.startswith("transmission.") and rule.kind == "number" and not rule.size
        if design[path] not in (0.0, 1.0)
    ]
    for name, link in design.link_sections.items():
        if link.mass > 0:
            path = f"links.{name}.mass"
            parameters.append(Parameter("Masses", path, (path,), float(link.mass), "kg"))
    for name in design.link_sections:
        paths, length = _length(design, name)
        if length > 0 and name != design.trunk.link:
            parameters.append(Parameter("Lengths", f"length of {name}", paths, length, "m"))
    return tuple(parameters)


def _length(design: TreeDesign, link: str) -> tuple[tuple[str, ...], float]:
    """Leaves that grow with the length of a link, and how far its joints and pads reach [m]."""
    joints = [n for n, joint in design.all_joints.items() if joint.parent == link]
    pads = [n for n, pad in design.pad_sections.items() if pad.link == link]
    places = [f"joints.{n}.position" for n in joints] + [f"pads.{n}.position" for n in pads]
    reach = max((float(np.linalg.norm(design[path])) for path in places), default=0.0)
    return (*places, f"links.{link}.com", f"links.{link}.place", f"links.{link}.size"), reach


def changed(
    design: RobotDesign, parameters: tuple[Parameter, ...], factors: Mapping[str, float]
) -> RobotDesign:
    """Change a design as its sliders were moved.

    Args:
        design: as loaded.
        parameters: of `parameters_of`.
        factors: by label of the parameter [-]; those at 1 change nothing.

    Returns:
        The changed design.

    Raises:
        InputError: the values make no robot; names the field.
    """
    values: dict[str, Any] = {}
    for parameter in parameters:
        factor = factors.get(parameter.label, 1.0)
        if factor == 1.0:
            continue
        for path in parameter.paths:
            grown = np.asarray(design[path], float) * factor
            if path.endswith(".size") and str(design[path.replace(".size", ".shape")]) != "box":
                grown[0] = design[path][0]  # a cylinder or a sphere keeps its radius
            values[path] = grown if grown.ndim else float(grown)
    return design.with_values(values, "sliders") if values else design
