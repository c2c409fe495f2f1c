"""Reading a design of any family."""

from __future__ import annotations

import dataclasses
import re
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, cast

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.base_file import base_file
from hyperleg_design.robot.design import (
    Design,
    changed,
    design_from_mapping,
    leaf_values,
    load_design,
    overlay_file,
    parse_overrides,
)
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.motor_paths import with_motor_paths
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_load import FAMILY, tree_design_from_mapping

FAMILIES = (Design.family, FAMILY)
"""What `family:` may say; a file without it is of the first one."""

XML = (".urdf", ".xml", ".mjcf", ".xacro")
"""Endings of files that describe robots, but are no designs."""


def load_robot(
    name: str | Path = "hyperleg",
    *,
    overrides: Mapping[str, Any] | Iterable[str] = (),
    overlays: Iterable[str | Path] = (),
    variant: str | None = None,
) -> RobotDesign:
    """Read a design of any family.

    Args:
        name: a shipped name (`hyperleg`, `mini_cheetah`) or a YAML file. A file holds a whole
            design, or `base: NAME` (or a path) with the leaves that differ.
        overrides: mapping of dotted paths to values, or texts `path=value`.
        overlays: YAML files with nested leaves, applied in order before `overrides`.
        variant: ablation to make of a HyperLeg, one of `names.VARIANTS`.

    Returns:
        The checked design, one robot, of its file's family.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find("descriptions", name)
    if family_of(path) != FAMILY:
        design = load_design(name, overrides=overrides, overlays=overlays, variant=variant)
        return dataclasses.replace(design, path=str(path))
    if variant:
        raise InputError("variant", "", variant, f"{name} has no variants; leave it out")
    tree = dataclasses.replace(_read(path), path=str(path))
    return changed_robot(tree, overrides=overrides, overlays=overlays)


def changed_robot(
    design: RobotDesign,
    *,
    overrides: Mapping[str, Any] | Iterable[str] = (),
    overlays: Iterable[str | Path] = (),
) -> RobotDesign:
    """Copy a design of any family with other values, given in the forms that `load_robot` takes.

    Args:
        design: a robot or batch.
        overrides: values by dotted path, or texts `path=value`.
        overlays: files with some leaves of a design, applied before the overrides.

    Returns:
        The validated copy.

    Raises:
        InputError: names file, field, value and remedy.
    """
    if isinstance(design, Design):
        return changed(design, overrides=overrides, overlays=overlays)
    tree = cast("TreeDesign", design)
    for overlay in overlays:
        place = overlay_file(overlay)
        tree = _overlaid(tree, read_yaml(place), given_path(place))
    chosen = parse_overrides(overrides)
    return tree.with_values(chosen, "--set") if chosen else tree


def design_argument(design: RobotDesign) -> str:
    """Name a design as `--design` takes it.

    Args:
        design: a robot or batch.

    Returns:
        The name of a shipped design, else the path of the file that it was read from, quoted for
        a shell. A relative path counts from the working directory in which it was read.
    """
    path = Path(design.path)
    if design.path and path.parent != resources.content_folder("descriptions"):
        return shlex.quote(design.path)
    return path.stem or design.name


def robot_from_mapping(data: Mapping[str, Any], where: str) -> RobotDesign:
    """Build a design of any family from what its `to_mapping` gives.

    Args:
        data: sections by name.
        where: file, for error messages.

    Returns:
        The validated design.

    Raises:
        InputError: no mapping, an unknown or missing field, or a value that makes no sense.
    """
    if isinstance(data, Mapping) and data.get("family") == FAMILY:
        return tree_design_from_mapping(data, where, where)
    return design_from_mapping(data, where)


def family_of(path: Path) -> str:
    """Find the family of the design in a file; where the file has a base, that of the base.

    Args:
        path: of the file.

    Returns:
        One of `FAMILIES`.

    Raises:
        InputError: a URDF or MJCF, an unknown family, or a base that leads back to itself.
    """
    seen: list[Path] = []
    while True:
        if path.suffix.lower() in XML:
            remedy = "is no design; hyperleg import makes one of a URDF or MJCF and its motors"
            raise InputError(given_path(path), "", None, remedy)
        data = read_yaml(path)
        if "axes" in data:
            remedy = "belongs to a sweep, not to a design; hyperleg sweep run takes this file"
            raise InputError(given_path(path), "axes", None, remedy)
        family = data.get("family")
        if family is not None and family not in FAMILIES:
            remedy = f"expects one of {', '.join(FAMILIES)}"
            raise InputError(given_path(path), "family", family, remedy)
        if family or not isinstance(data.get("base"), str) or path.resolve() in seen:
            return family or FAMILIES[0]
        seen.append(path.resolve())
        path = base_file(path, data["base"])


def _read(path: Path, seen: tuple[Path, ...] = ()) -> TreeDesign:
    data, where = with_motor_paths(read_yaml(path), path.parent), given_path(path)
    if path.resolve() in seen:
        raise InputError(where, "base", data.get("base"), "leads back to itself")
    name = str(data.get("name", re.sub(r"[^A-Za-z0-9_.-]+", "_", path.stem)))
    if "base" not in data:
        return tree_design_from_mapping(data, name, where)
    base = _read(base_file(path, data["base"]), (*seen, path.resolve()))
    rest = {k: v for k, v in data.items() if k not in ("base", "family", "name", "description")}
    design = _overlaid(base, rest, where)
    bases = (base.name, *base.bases)
    return dataclasses.replace(design, name=name, source=where, bases=bases)


def _overlaid(design: TreeDesign, data: Mapping[str, Any], where: str) -> TreeDesign:
    values, origins = leaf_values(data, type(design), where)
    if not values:
        return design
    changed = design.with_values(values, where)
    return dataclasses.replace(changed, origins={**changed.origins, **origins})
