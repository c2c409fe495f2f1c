"""A design of HyperLeg's family: read from YAML, overridden, and checked each time.

Designs of any family are read by `robot.load.load_robot`.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml
from typing_extensions import override

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, parse_yaml, read_yaml
from hyperleg_design.robot.ablation import ablate, states
from hyperleg_design.robot.base_file import base_file
from hyperleg_design.robot.checks.consistency import check_design
from hyperleg_design.robot.masses import check_printed, lapsed
from hyperleg_design.robot.names import LAYOUTS, PASSIVE
from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.hyperleg import SPRING_LEAVES, HyperLeg
from hyperleg_design.robot.parameters.motor_paths import with_motor_paths
from hyperleg_design.robot.parameters.values import Origin

if TYPE_CHECKING:
    from typing import Self

SPRING = tuple(f"toe.{leaf}" for leaf in SPRING_LEAVES)
"""Paths of the leaves that only a passive toe has."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Design(HyperLeg):
    """A biped of HyperLeg's family, checked whenever one is made, so also when values are
    replaced.
    """

    def __post_init__(self) -> None:
        check_design(self)

    @override
    def with_values(
        self, values: Mapping[str, Any], where: str = "override", label: str = "user"
    ) -> Self:
        replaced = super().with_values(values, where, label)
        check_printed(replaced, where)
        return replaced

    @override
    def lapsed(self, values: Mapping[str, Any]) -> dict[str, float]:
        return lapsed(self, values)


def load_design(
    name: str | Path = "hyperleg",
    *,
    overrides: Mapping[str, Any] | Iterable[str] = (),
    overlays: Iterable[str | Path] = (),
    variant: str | None = None,
) -> Design:
    """Read a design of HyperLeg's family, and apply changes to it.

    Args:
        name: a shipped name (`hyperleg`, or an ablation of it such as `toe_removed`) or a YAML
            file. A file holds a whole design, whose `variant:` says what it is, or `base: NAME`
            (or a path) with the leaves that differ and the `variant:` to make of it.
        overrides: mapping of dotted paths to values, or texts `path=value`.
        overlays: YAML files with nested leaves, applied in order before `overrides`.
        variant: toe layout to make of it, one of `LAYOUTS`.

    Returns:
        The validated design, one robot.

    Raises:
        InputError: names file, field, value and remedy.
    """
    design, own_variant = _read(resources.find("descriptions", name))
    chosen = design.by_path(parse_overrides(overrides))
    design = changed(design, overrides=chosen, overlays=overlays)
    if own_variant and variant and own_variant != variant:
        raise InputError(
            "variant",
            "",
            variant,
            f"{design.name} is already the variant {own_variant}; start from its base",
        )
    ablated = ablate(design, variant or own_variant or design.variant)
    for path, value in chosen.items():
        if not np.array_equal(ablated[path], design[path]):
            raise InputError(
                "--set",
                path,
                value,
                f"the variant {ablated.variant} sets this itself; use another variant or leave it "
                "out",
            )
        if path in SPRING and ablated.toe.joint != "passive":
            raise InputError(
                "--set", path, value, f"only {PASSIVE} has a spring at the toe; start from it"
            )
    return ablated


def changed(
    design: Design,
    *,
    overrides: Mapping[str, Any] | Iterable[str] = (),
    overlays: Iterable[str | Path] = (),
) -> Design:
    """Copy a design with other values, given in the forms that `load_design` takes.

    Args:
        design: a robot or batch.
        overrides: values by dotted path, or texts `path=value`.
        overlays: files with some leaves of a design, applied before the overrides.

    Returns:
        The validated copy.

    Raises:
        InputError: names file, field, value and remedy.
    """
    for overlay in overlays:
        path = overlay_file(overlay)
        design = _overlaid(design, read_yaml(path), given_path(path))
    chosen = parse_overrides(overrides)
    return design.with_values(chosen, "--set") if chosen else design


def overlay_file(name: str | Path) -> Path:
    """Find a file of parameters that differ from a design's.

    Args:
        name: its path.

    Returns:
        The path.

    Raises:
        InputError: there is no such file.
    """
    try:
        return resources.find("descriptions", name)
    except InputError as error:
        reason = error.remedy.split(";")[0]
        remedy = f"{reason}; expects a YAML file with the parameters that differ"
        raise InputError("--set-file", "", str(name), remedy) from None


def design_from_mapping(data: Mapping[str, Any], where: str) -> Design:
    """Build a whole design from what `Design.to_mapping` gives, as policies and results carry it.

    Args:
        data: sections by name.
        where: file, for error messages.

    Returns:
        The validated design.

    Raises:
        InputError: no mapping, an unknown or missing field, or a value that makes no sense.
    """
    if not isinstance(data, Mapping):
        raise InputError(where, "", data, "expects a mapping of a design's sections")
    variant = data.get("variant", "toe")
    if variant not in LAYOUTS:
        raise InputError(where, "variant", variant, f"expects one of {', '.join(LAYOUTS)}")
    rest = {k: v for k, v in data.items() if k not in ("name", "variant")}
    return _build(rest, str(data.get("name", where)), where, {}, variant)


def _read(path: Path, seen: tuple[Path, ...] = ()) -> tuple[Design, str | None]:
    """Design of a file before ablation, and the variant that the file asks for."""
    data = with_motor_paths(read_yaml(path), path.parent)
    where = given_path(path)
    if path.resolve() in seen:
        raise InputError(where, "base", data.get("base"), "leads back to itself")
    if data.get("family", "hyperleg") != "hyperleg":
        remedy = (
            "is of another family; this needs a design of HyperLeg's, such as hyperleg; read "
            "others with load_robot"
        )
        raise InputError(where, "family", data["family"], remedy)
    variant = data.get("variant")
    if variant is not None and variant not in LAYOUTS:
        raise InputError(where, "variant", variant, f"expects one of {', '.join(LAYOUTS)}")
    name = data.get("name", re.sub(r"[^A-Za-z0-9_.-]+", "_", path.stem))
    rest = {k: v for k, v in data.items() if k not in ("base", "variant", "name", "family")}
    if "base" not in data:
        origins: dict[str, Origin] = {}
        return _build(rest, name, where, origins, variant or "toe"), None
    base, base_variant = _read(base_file(path, data["base"]), (*seen, path.resolve()))
    return dataclasses.replace(
        _overlaid(base, rest, where), name=name, source=where
    ), variant or base_variant


def parse_overrides(overrides: Mapping[str, Any] | Iterable[str]) -> dict[str, Any]:
    """Parse overrides into a mapping.

    Args:
        overrides: values by dotted path, or texts `path=value` with the value in YAML.

    Returns:
        Values by dotted path.

    Raises:
        InputError: a text without `=`, or a value that is not YAML.
    """
    if isinstance(overrides, Mapping):
        return dict(overrides)
    parsed: dict[str, Any] = {}
    for item in overrides:
        path, equals, raw = item.partition("=")
        if not equals or not path.strip():
            raise InputError("--set", "", item, "expects path=value, such as toe.mass=0.3")
        try:
            parsed[path.strip()] = parse_yaml(raw)
        except yaml.YAMLError:
            raise InputError(
                "--set", path, raw, "is no value in YAML; quote it, or write a ratio as one number"
            ) from None
    return parsed


def _build(
    data: dict[str, Any], name: str, where: str, origins: dict[str, Origin], variant: str
) -> Design:
    sections = parameter_fields.section_types(Design)
    optional = {f.name for f in dataclasses.fields(Design) if f.default_factory is not MISSING}
    for key in data:
        if key not in sections:
            raise InputError(
                where, str(key), data[key], parameters.unknown(str(key), sorted(sections))
            )
    parts: dict[str, Any] = {}
    for key, cls in sections.items():
        if key not in data:
            if key in optional:
                continue
            raise InputError(where, key, None, "is missing")
        parts[key] = parameters.from_mapping(cls, data[key], where, key, origins)
    for path in parameters.rules(Design):
        origins.setdefault(path, Origin("assumed", "default of the field"))
    design = Design(name=name, origins=origins, source=where, variant=variant, **parts)
    check_printed(design, where)
    stated = (design.toe.joint, design.actuators.toe_installed)
    if variant != "toe" and stated != states(variant):
        remedy = (
            "does not fit toe.joint and actuators.toe_installed; a whole design states the "
            "variant that it is, `base:` makes one of another"
        )
        raise InputError(where, "variant", variant, remedy)
    return design


def _overlaid(design: Design, data: Mapping[str, Any], where: str) -> Design:
    values, origins = leaf_values(data, Design, where)
    if not values:
        return design
    changed = design.with_values(values, where)
    return dataclasses.replace(changed, origins={**changed.origins, **origins})


def leaf_values(
    data: Mapping[str, Any], cls: type, where: str
) -> tuple[dict[str, Any], dict[str, Origin]]:
    """Collect the values and origins of nested leaves, as a file with some of them holds.

    Args:
        data: nested mappings.
        cls: dataclass of the design, which knows all leaves.
        where: file, for error messages.

    Returns:
        Values, and origins, both by dotted path.

    Raises:
        InputError: a leaf that is neither a value nor `{value, label, source}`.
    """
    values: dict[str, Any] = {}
    origins: dict[str, Origin] = {}
    known = parameters.rules(cls)

    def walk(part: Mapping[str, Any], prefix: str) -> None:
        for key, value in part.items():
            path = f"{prefix}{key}"
            if isinstance(value, Mapping) and path not in known:
                walk(value, f"{path}.")
            else:
                values[path], origins[path] = parameters.labelled(value, where, path)

    walk(data, "")
    return values, origins
