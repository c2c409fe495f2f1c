"""Reading designs that write their tree out, and checking each whenever one is made."""

from __future__ import annotations

import dataclasses
import keyword
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError
from hyperleg_design.robot.parameters import fields as parameter_fields
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.entries import check_keys, checked_mapping
from hyperleg_design.robot.parameters.values import Origin
from hyperleg_design.robot.trees.tree_check import check_tree_design, ordered
from hyperleg_design.robot.trees.tree_design import NAMED, TreeDesign, named_class, ratios_class

FAMILY = TreeDesign.family
"""What `family:` says in a file of this kind."""
OPTIONAL = (
    "limbs",
    "reference",
    "transmission",
    "rods",
    "pads",
    "masses",
    "electrical",
    "contact",
    "stops",
    "friction",
    "gears",
)
"""Sections that a file may leave out."""
DEFAULTS: Mapping[str, Mapping[str, Any]] = {
    "electrical": {
        "constants": {"value": "vendor", "label": "assumed", "source": "the catalogue's"},
        "efficiency_out": {"value": 0.9, "label": "assumed", "source": "as HyperLeg's"},
        "efficiency_regen": {"value": 0.8, "label": "assumed", "source": "as HyperLeg's"},
    },
    "contact": {
        "friction": {"value": 1.0, "label": "assumed", "source": "rubber on dry floor"},
        "torsional_friction": {"value": 0.005, "label": "assumed", "source": "spherical pads"},
        "pad_radius": {"value": 0.015, "label": "assumed", "source": "small rubber pad"},
        "time_constant": {"value": 0.02, "label": "assumed", "source": "MuJoCo default"},
        "damping_ratio": {"value": 1.0, "label": "assumed", "source": "critical"},
    },
}
"""What stands in a section that a file leaves out."""


@dataclasses.dataclass(frozen=True, eq=False, kw_only=True)
class CheckedTreeDesign(TreeDesign):
    """A tree design that is checked whenever one is made, so also when values are replaced."""

    def __post_init__(self) -> None:
        check_tree_design(self)

    @override
    def lapsed(self, values: Mapping[str, Any]) -> dict[str, float]:
        total = "masses.expected_total"
        replaced = any(path.startswith("links.") and path.endswith(".mass") for path in values)
        return {total: 0.0} if replaced and total not in values and np.any(self[total]) else {}

    def __reduce__(self) -> Any:
        plain = {p: v for p, v in parameters.leaves(self).items() if isinstance(v, np.ndarray)}
        batched = {p: plain[p] for p in self.batch_sizes()}
        single = self.take(0) if batched else self
        return _restored, (
            single.to_mapping(),
            self.name,
            self.source,
            dict(self.origins),
            batched,
            self.bases,
            self.path,
        )


def _restored(
    data: Mapping[str, Any],
    name: str,
    source: str,
    origins: Mapping[str, Origin],
    batched: Mapping[str, np.ndarray],
    bases: tuple[str, ...] = (),
    path: str = "",
) -> TreeDesign:
    design = tree_design_from_mapping(data, name, source or name)
    restored = design.with_values(batched, name) if batched else design
    return dataclasses.replace(restored, source=source, path=path, origins=origins, bases=bases)


@cache
def _design_class(sections: tuple[tuple[str, type], ...]) -> type[CheckedTreeDesign]:
    return dataclasses.make_dataclass(
        "CheckedTreeDesign",
        sections,
        bases=(CheckedTreeDesign,),
        frozen=True,
        eq=False,
        kw_only=True,
    )


def tree_design_from_mapping(data: Mapping[str, Any], name: str, where: str) -> TreeDesign:
    """Build a design from what its file holds, or from what `TreeDesign.to_mapping` gives.

    Args:
        data: sections by name, as YAML gives them.
        name: of the design where `data` has none.
        where: file, for errors.

    Returns:
        The validated design.

    Raises:
        InputError: no tree, a joint without a motor, a motor that is not in the catalogue, an
            unknown or missing field, or a value that makes no sense.
    """
    name, variant = str(data.get("name", name)), str(data.get("variant", ""))
    rest = {k: v for k, v in data.items() if k not in ("name", "variant", "family", "description")}
    known = ("trunk", *NAMED, *(key for key in OPTIONAL if key not in NAMED))
    check_keys(rest, where, "", [key for key in known if key not in OPTIONAL], tuple(OPTIONAL))
    sections = {
        key: dict(checked_mapping(rest.get(key, {}), where, key, SECTIONS)) for key in NAMED
    }
    for key, held in sections.items():
        for item in held:
            _check_identifier(item, where, f"{key}.{item}")
    _check_trunk(rest["trunk"], where)
    joints = sections["joints"]
    ends = {
        n: tuple(
            str(_plain(checked_mapping(j, where, f"joints.{n}", SECTIONS).get(e, "")))
            for e in _ENDS
        )
        for n, j in joints.items()
    }
    root = str(_plain(rest["trunk"].get("link", "")))
    order = ordered(ends, sections["links"], root, where)  # type: ignore[arg-type]
    sections["joints"] = {n: joints[n] for n in order}
    if not sections["reference"]:
        sections["reference"] = {
            motor: {
                k: v
                for k, v in checked_mapping(held, where, f"actuators.{motor}", SECTIONS).items()
                if k in ("motor", "gear")
            }
            for motor, held in sections["actuators"].items()
        }
    for motor in sections["actuators"]:
        if motor not in sections["reference"]:
            raise InputError(where, f"reference.{motor}", None, "is missing")
    for motor in sections["rods"]:
        if motor not in sections["actuators"]:
            remedy = parameters.unknown(motor, list(sections["actuators"]))
            raise InputError(where, f"rods.{motor}", None, remedy.replace("field", "motor"))
    ratios = _transmission(rest.get("transmission"), sections, where)
    types: dict[str, type] = {
        key: named_class(key.capitalize(), dict.fromkeys(held, NAMED[key]))
        for key, held in sections.items()
    }
    types["transmission"] = named_class(
        "Transmission", {motor: ratios_class(tuple(held)) for motor, held in ratios.items()}
    )
    cls = _design_class(tuple(types.items()))
    origins: dict[str, Origin] = {}
    parts: dict[str, Any] = {}
    given = {**rest, **sections, "transmission": ratios}
    for key, section in parameter_fields.section_types(cls).items():
        content = given.get(key, DEFAULTS.get(key, {}))
        parts[key] = parameters.from_mapping(section, content, where, key, origins)
    return cls(name=name, variant=variant, origins=origins, source=where, **parts)


_ENDS = ("parent", "child")
SECTIONS = "of names to sections"
"""What the parts of a file are, for error messages."""


def _plain(value: Any) -> Any:
    return value.get("value") if isinstance(value, Mapping) else value


def _check_trunk(trunk: Any, where: str) -> None:
    if not isinstance(trunk, Mapping) or "link" not in trunk:
        raise InputError(where, "trunk.link", None, "is missing: the name of the root link")


def _check_identifier(name: Any, where: str, path: str) -> None:
    """Names become parts of dotted paths, and names in URDF and MJCF."""
    if not (isinstance(name, str) and name.isidentifier() and not keyword.iskeyword(name)):
        remedy = "expects letters, digits and underscores, not a digit first"
        raise InputError(where, path, name, remedy)


def _transmission(
    data: Any, sections: Mapping[str, Mapping[str, Any]], where: str
) -> dict[str, dict[str, Any]]:
    """Reductions behind the gears, by motor and joint.

    A motor that is not mentioned, and has no rod, drives the joint of its own name, one to one.
    """
    motors = list(sections["actuators"])
    joints = [
        n for n, j in sections["joints"].items() if _plain(j.get("type", "revolute")) != "fixed"
    ]
    given = dict(checked_mapping(data or {}, where, "transmission", SECTIONS))
    if "joint_from_motor" in given:
        given = _from_matrix(given, motors, joints, sections, where)
    for motor in given:
        if motor not in motors:
            remedy = parameters.unknown(str(motor), motors, "motor")
            raise InputError(where, f"transmission.{motor}", None, remedy)
    entries: dict[str, dict[str, Any]] = {}
    for motor in motors:
        if motor in sections["rods"]:
            if given.get(motor):
                remedy = "has a rod, which sets its reductions; leave one of the two out"
                raise InputError(where, f"transmission.{motor}", None, remedy)
            continue
        entry = given.get(motor)
        if entry is None:
            if motor not in joints:
                raise InputError(
                    where,
                    f"transmission.{motor}",
                    None,
                    f"is missing: there is no moving joint of the name {motor}, so say which "
                    f"joints this motor drives, such as {{{joints[0] if joints else 'knee'}: 1}}",
                )
            entry = {motor: {"value": 1.0, "label": "derived", "source": "gear alone"}}
        elif not isinstance(entry, Mapping) or "value" in entry:
            entry = {motor: entry}
        for joint in entry:
            if joint not in joints:
                remedy = parameters.unknown(str(joint), joints, "moving joint")
                if joint in sections["joints"]:
                    remedy = "is fixed or locked, so no motor drives it; leave one of the two out"
                raise InputError(where, f"transmission.{motor}.{joint}", None, remedy)
        entries[motor] = dict(entry)
    return entries


def _from_matrix(
    given: Mapping[str, Any],
    motors: list[str],
    joints: list[str],
    sections: Mapping[str, Mapping[str, Any]],
    where: str,
) -> dict[str, dict[str, Any]]:
    """Reductions from a matrix of total ones, rows joints, columns motors; gears divided out."""
    place = "transmission.joint_from_motor"
    for key in given:
        if key not in ("joint_from_motor", "joints", "motors"):
            remedy = "expects joint_from_motor with the names of its rows (joints) and columns"
            raise InputError(where, f"transmission.{key}", None, f"{remedy} (motors)")
    value, origin = parameters.labelled(given["joint_from_motor"], where, place)
    rows = [str(n) for n in given.get("joints", joints)]
    columns = [str(n) for n in given.get("motors", motors)]
    for names, known, what in ((rows, joints, "joints"), (columns, motors, "motors")):
        if sorted(names) != sorted(known):
            remedy = f"expects each of {', '.join(known)} once"
            raise InputError(where, f"transmission.{what}", names, remedy)
    try:
        matrix = np.array(value, float)
    except (TypeError, ValueError):
        matrix = np.full(0, np.nan)
    if matrix.shape != (len(rows), len(columns)) or not np.all(np.isfinite(matrix)):
        held = f"holds {' by '.join(map(str, matrix.shape))} numbers; " if matrix.ndim == 2 else ""
        remedy = (
            f"{held}expects {len(rows)} rows of {len(columns)} finite numbers: a row for each of "
            f"{', '.join(rows)}, a column for each of {', '.join(columns)}"
        )
        raise InputError(where, place, None if held else value, remedy)
    entries: dict[str, dict[str, Any]] = {}
    for column, motor in enumerate(columns):
        gear = float(_plain(sections["actuators"][motor].get("gear", 1.0)))
        entries[motor] = {
            joint: {
                "value": matrix[row, column] / gear,
                "label": origin.label,
                "source": origin.source,
            }
            for row, joint in enumerate(rows)
            if matrix[row, column]
        }
    return entries
