"""A design that writes its kinematic tree out: any limbs, joints, links, pads and actuation.

A file of `family: tree` holds one root link (`trunk`) and what hangs from it, described once, with
the `copies` of it that the robot has. The sections `links`, `joints`, `actuators`, `transmission`,
`rods` and `pads` hold one section a name; a design's class has a field for each of those names, so
that every number has a dotted path such as `joints.knee.coulomb` that can be replaced, swept and
batched.

The map from motors to joints, `joint_from_motor`, has the entry `gear * transmission.MOTOR.JOINT`,
or, for a motor with a section in `rods`, what that linkage gives in the posture.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar

from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.fields import number
from hyperleg_design.robot.parameters.model_sections import (
    Contact,
    FrictionModel,
    GearModel,
    StopModel,
)
from hyperleg_design.robot.parameters.sections import Electrical
from hyperleg_design.robot.parameters.values import Checked
from hyperleg_design.robot.trees.tree_sections import (
    LimbCopy,
    LinkSection,
    PadSection,
    ReferenceActuator,
    Rod,
    TreeActuator,
    TreeJointSection,
    TreeMassModel,
    Trunk,
)

NAMED: Mapping[str, type] = {
    "limbs": LimbCopy,
    "links": LinkSection,
    "joints": TreeJointSection,
    "actuators": TreeActuator,
    "reference": ReferenceActuator,
    "rods": Rod,
    "pads": PadSection,
}
"""Sections that hold one section of a class for each name."""


@dataclass(frozen=True, eq=False, kw_only=True)
class TreeDesign(RobotDesign):
    """A robot with its tree written out; each file's names make a class of their own."""

    family: ClassVar[str] = "tree"
    bases: tuple[str, ...] = ()
    """Names of the designs that its file is based on, the nearest first, by whose
    policies it may walk."""
    trunk: Trunk
    masses: TreeMassModel = field(default_factory=TreeMassModel)
    electrical: Electrical
    contact: Contact
    stops: StopModel = field(default_factory=StopModel)
    friction: FrictionModel = field(default_factory=FrictionModel)
    gears: GearModel = field(default_factory=GearModel)

    def _head(self) -> dict[str, Any]:
        return {"family": self.family, "name": self.name}

    def _named(self, section: str) -> dict[str, Any]:
        held: Any = getattr(self, section)
        return {f.name: getattr(held, f.name) for f in dataclasses.fields(held)}

    @property
    def copies(self) -> tuple[str, ...]:
        """Names of the copies of the limb; one empty name where there is but one."""
        return tuple(self._named("limbs")) or ("",)

    @property
    def copy_sections(self) -> dict[str, LimbCopy]:
        """The copies of the limb by name."""
        return self._named("limbs") or {"": LimbCopy()}

    @property
    def root_link(self) -> str:
        """Path of the section of the root link."""
        return f"links.{self.trunk.link}"

    @property
    def link_sections(self) -> dict[str, LinkSection]:
        """Links by name, the trunk's root first."""
        return self._named("links")

    @property
    def all_joints(self) -> dict[str, TreeJointSection]:
        """Joints of one limb by name, fixed ones among them, parents before children."""
        return self._named("joints")

    @property
    def joint_sections(self) -> dict[str, TreeJointSection]:
        """Joints of one limb that move, by name."""
        return {n: joint for n, joint in self.all_joints.items() if joint.type != "fixed"}

    @property
    def actuator_sections(self) -> dict[str, TreeActuator]:
        """Motors of one limb by name."""
        return self._named("actuators")

    @property
    def reference_sections(self) -> dict[str, ReferenceActuator]:
        """Motors and gears for which the masses are declared, by name of the motor."""
        return self._named("reference")

    @property
    def rod_sections(self) -> dict[str, Rod]:
        """Posture-dependent linkages by name of the motor."""
        return self._named("rods")

    @property
    def pad_sections(self) -> dict[str, PadSection]:
        """Pads of one limb, and of the trunk, by name."""
        return self._named("pads")

    def ratio(self, motor: str, joint: str) -> Any:
        """Look up the reduction from a motor's gear to a joint.

        Args:
            motor: name of the motor.
            joint: name of the joint.

        Returns:
            The reduction [-]; zero where the motor does not drive the joint.
        """
        return getattr(getattr(getattr(self, "transmission"), motor, None), joint, 0.0)  # noqa: B009


def named_class(name: str, parts: Mapping[str, type]) -> type:
    """Make a dataclass with one section for each name.

    Args:
        name: of the class.
        parts: class of each section, by name.

    Returns:
        The dataclass; the same one for the same arguments.
    """
    return _named_class(name, tuple(parts.items()))


@cache
def _named_class(name: str, parts: tuple[tuple[str, type], ...]) -> type:
    return dataclasses.make_dataclass(name, parts, frozen=True, eq=False, kw_only=True)


@cache
def ratios_class(joints: tuple[str, ...]) -> type:
    """Make a dataclass with a reduction for each joint that a motor drives.

    Args:
        joints: names of the joints.

    Returns:
        The dataclass; the same one for the same joints.
    """
    leaves = [(joint, Any, number("", -1000, 1000)) for joint in joints]
    return dataclasses.make_dataclass(
        "Ratios", leaves, bases=(Checked,), frozen=True, eq=False, kw_only=True
    )
