"""What every family of designs shares: labelled leaves by dotted path, replaced and batched.

A *family* is a way to describe robots. HyperLeg's (`robot.design.Design`) is a few parameters of a
biped; the other (`robot.trees.tree_design.TreeDesign`) is any kinematic tree, written out. Both
describe one limb and say which copies of it the robot has; joints and motors are those of one limb.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.reading import short_name
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.fields import Rule
from hyperleg_design.robot.parameters.values import Origin

if TYPE_CHECKING:
    from typing import Self


@dataclass(frozen=True, eq=False, kw_only=True)
class RobotDesign:
    """A robot of any family, or a batch of robots that differ in numbers and motors only."""

    family: ClassVar[str]
    """Name of the family, as `family:` in a file says it."""
    name: str
    variant: str = ""
    """Ablation that made it; informative."""
    origins: Mapping[str, Origin] = field(default_factory=dict, repr=False)
    """Origin of each leaf, by dotted path."""
    source: str = ""
    """File it was read from, by its folder and name, for messages."""
    path: str = ""
    """Path of that file from the working directory; empty where there is no file."""

    @property
    def copies(self) -> tuple[str, ...]:
        """Names of the copies of the limb; one empty name where the robot is written out whole.

        Raises:
            NotImplementedError: in this class; each family of designs has its own answer.
        """
        raise NotImplementedError

    @property
    def joint_sections(self) -> Mapping[str, Any]:
        """Sections of the joints of one limb that move, by name, from the base outward.

        Raises:
            NotImplementedError: in this class; each family of designs has its own answer.
        """
        raise NotImplementedError

    @property
    def actuator_sections(self) -> Mapping[str, Any]:
        """Sections of the motors of one limb that are installed, by name.

        Raises:
            NotImplementedError: in this class; each family of designs has its own answer.
        """
        raise NotImplementedError

    @property
    def every_actuator(self) -> tuple[Any, ...]:
        """Sections of all motors of one limb, one a motor; also of one that is not installed."""
        return tuple(self.actuator_sections.values())

    @property
    def electrical_section(self) -> Any:
        """Section on the battery and the drivers."""
        return getattr(self, "electrical")  # noqa: B009

    @property
    def contact_section(self) -> Any:
        """Section on the pads and the ground."""
        return getattr(self, "contact")  # noqa: B009

    @property
    def stop_section(self) -> Any:
        """Stops at the ends of the joints' ranges."""
        return getattr(self, "stops")  # noqa: B009

    @property
    def root_link(self) -> str:
        """Path of the section of the link that all others hang from, which has a mass.

        Raises:
            NotImplementedError: in this class; each family of designs has its own answer.
        """
        raise NotImplementedError

    @property
    def rules(self) -> Mapping[str, Rule]:
        """Rules of all leaves by dotted path."""
        cls: Any = type(self)
        return parameters.rules(cls)

    @property
    def batch_shape(self) -> tuple[int, ...]:
        """Shape of the batch: `()` for one robot, `(n,)` for `n` robots."""
        sizes = self._batch_sizes.values()
        return (max(sizes),) if sizes else ()

    def batch_sizes(self) -> dict[str, int]:
        """Find the leaves that hold a batch.

        Returns:
            Length of the batch by dotted path.
        """
        return dict(self._batch_sizes)

    @cached_property
    def _batch_sizes(self) -> dict[str, int]:
        """What `batch_sizes` returns; a design does not change, and many functions ask for it."""
        values = ((path, rule, self[path]) for path, rule in self.rules.items())
        return {
            path: len(value)
            for path, rule, value in values
            if isinstance(value, np.ndarray) and value.ndim > (1 if rule.size else 0)
        }

    def __getitem__(self, path: str) -> Any:
        """Value of a leaf by dotted path, `design["contact.friction"]`."""
        value: Any = self
        for part in path.split("."):
            try:
                value = getattr(value, part)
            except AttributeError:
                raise InputError(
                    self.name,
                    path,
                    None,
                    parameters.unknown(path, sorted(self.rules)),
                ) from None
        return value

    def with_values(
        self, values: Mapping[str, Any], where: str = "override", label: str = "user"
    ) -> Self:
        """Copy the design with other values of some leaves.

        A printed sum of masses is no longer checked where a mass in it is replaced (`lapsed`).

        Args:
            values: numbers, texts, or arrays of either with the batch in front, by dotted path, or
                by a pattern of paths such as `actuators.*_knee.gear`.
            where: what to name in errors.
            label: origin of the new values.

        Returns:
            The validated copy.

        Raises:
            InputError: unknown path, or a value or combination that makes no sense.
        """
        values = self.by_path(values)
        sums = self.lapsed(values)
        source = short_name(Path(where))
        lapse = Origin("derived", f"lapsed: a mass was replaced by {source}")
        origins = {**self.origins, **dict.fromkeys(values, Origin(label, source))}
        origins |= dict.fromkeys(sums, lapse)
        return self._replaced({**values, **sums}, where, origins)

    def lapsed(self, values: Mapping[str, Any]) -> dict[str, float]:
        """List the printed sums of masses that no longer hold when some leaves are replaced.

        Args:
            values: of the leaves, by dotted path.

        Returns:
            Paths of the sums, each with the value 0, which means no check.
        """
        return {}

    def by_path(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Put the paths that match a pattern in its place.

        Args:
            values: by dotted path, or by a pattern such as `actuators.*_knee.gear`.

        Returns:
            Values by path; a pattern that nothing matches stays.
        """
        return {
            path: value
            for pattern, value in values.items()
            for path in parameters.matching(str(pattern), self.rules)
        }

    def _replaced(
        self, values: Mapping[str, Any], where: str, origins: Mapping[str, Origin]
    ) -> Self:
        """A copy with leaves replaced; errors of the whole design name what replaced them."""
        try:
            return parameters.with_values(self, values, where, origins=origins)
        except InputError as error:
            own = str(self.source or self.name)
            if error.where != own:  # the replacement, or the file of a motor that it names
                raise
            raise InputError(
                f"{own} with {where}",
                error.field,
                error.value,
                error.remedy,
                bad=error.bad,
            ) from None

    def take(self, index: int) -> Self:
        """Take one robot of a batch; its values keep their origins.

        Args:
            index: of the robot.

        Returns:
            The single robot.

        Raises:
            IndexError: the batch is not that long.
        """
        values = {
            path: self[path][0 if size == 1 else index] for path, size in self.batch_sizes().items()
        }
        if not values:
            return self
        plain = {path: str(v) if isinstance(v, str) else v for path, v in values.items()}
        return parameters.with_values(self, plain, f"{self.name}[{index}]")

    def rows(self, index: np.ndarray) -> Self:
        """Make a batch of the robots with these numbers, which may repeat.

        All its number leaves are arrays with the batch in front, whichever differ, so that what is
        computed of a robot does not depend on what others of the batch differ in, to the last
        digit.

        Args:
            index: `(n,)`, of robots of a batch; zeros for copies of a single robot.

        Returns:
            The batch of n robots.
        """
        cls: Any = type(self)
        values: dict[str, Any] = {}
        for path, value in parameters.leaves(self).items():
            own, rule = np.asarray(value), parameters.rules(cls)[path]
            if rule.kind != "number" and not own.ndim:
                continue
            core = 1 if rule.size else 0
            batch = own if own.ndim > core else own[None]
            values[path] = batch[np.zeros_like(index) if len(batch) == 1 else index]
        return parameters.with_values(self, values, self.name)

    def _head(self) -> dict[str, Any]:
        """What stands before the leaves in `to_mapping`."""
        return {"name": self.name, "variant": self.variant}

    def to_mapping(self) -> dict[str, Any]:
        """Write all leaves as nested plain mappings.

        Returns:
            Each leaf with value, label and source where they are known.
        """
        result: dict[str, Any] = self._head()
        for path, value in parameters.leaves(self).items():
            place = result
            *sections, last = path.split(".")
            for section in sections:
                place = place.setdefault(section, {})
            origin = self.origins.get(path)
            plain = value.tolist() if isinstance(value, np.ndarray) else value
            place[last] = (
                plain
                if origin is None
                else {"value": plain, "label": origin.label, "source": origin.source}
            )
        return result


def prefixed(copy: str, name: str) -> str:
    """Name a joint, motor or link of one copy of the limb.

    Args:
        copy: name of the copy, such as `left`; empty where the robot is described as a whole.
        name: within the limb, such as `knee`.

    Returns:
        The full name, such as `left_knee`.
    """
    return f"{copy}_{name}" if copy else name
