"""The space of designs that a sweep covers: read from YAML, sampled from one seed, made into
batches.

design: hyperleg                       # a shipped name, or a file: from here, or beside this one
set: {masses.law: components}          # leaves changed for all designs
variants: [toe, toe_removed_matched]   # each sample is evaluated as each of these
sampling: grid                         # or random, sobol, latin_hypercube, with count
count: 4096
seed: 0
axes:
  toe.mass: {low: 0.1, high: 0.5, steps: 9}
  actuators.knee.motor: {values: [RI60, RI70]}
  actuators.*_KFE.gear: {values: [6, 9]}    # a pattern: the same value for all that match it
  leg length: {paths: [thigh.length, shank.length], scale: {low: 0.8, high: 1.2, steps: 5}}
measures: [swing_inertia]            # all by default
objectives: [total_mass, push_off_power]   # any of `hyperleg list measures`
evaluate: [walk]                     # protocols, where objectives or maps need trials
maps: [{x: toe.mass, y: leg length, measure: swing_inertia}]
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from hyperleg_design import resources
from hyperleg_design.errors import InputError
from hyperleg_design.reading import given_path, read_yaml
from hyperleg_design.robot.design import SPRING, Design
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.names import LAYOUTS, PASSIVE
from hyperleg_design.robot.parameters import values as parameters
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.parameters.entries import check_keys
from hyperleg_design.robot.parameters.motor_paths import path_from_here
from hyperleg_design.sweep import registry
from hyperleg_design.sweep.measuring import measures
from hyperleg_design.sweep.measuring.measure import MEASURES
from hyperleg_design.sweep.spaces.axis import Axis, read_axis
from hyperleg_design.sweep.spaces.definition import AS_DESCRIBED, Map, Sweep

SAMPLINGS = ("grid", "random", "sobol", "latin_hypercube")
MAX_DESIGNS = 10_000_000
"""Above this a definition is taken for a mistake."""

_NOT_AMONG = "is not among the sweep's measures; add it there"
_OPTIONAL = (
    "name",
    "description",
    "set",
    "variants",
    "sampling",
    "count",
    "seed",
    "measures",
    "objectives",
    "maps",
    "evaluate",
)


def load_sweep(name: str | Path, *, overrides: Mapping[str, Any] | None = None) -> Sweep:
    """Read a sweep from a shipped file or a file of the user.

    Args:
        name: a shipped name such as `reduction_ratios`, or a YAML file.
        overrides: leaves changed for all designs, on top of the file's `set`.

    Returns:
        The sweep, its axes and rules checked; no design is computed yet.

    Raises:
        InputError: names file, field, value and remedy.
    """
    path = resources.find("sweeps", name)
    data = _from_here(read_yaml(path), path.parent)
    return sweep_from_mapping(data, given_path(path), path.stem, overrides=overrides)


def _from_here(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """What a file holds, with files of the design and of motors that lie beside it found."""
    replaced, axes = dict(data), data.get("axes")
    if "design" in data:
        replaced["design"] = path_from_here(data["design"], folder)
    if isinstance(axes, Mapping):
        replaced["axes"] = {name: _axis_from_here(axis, folder) for name, axis in axes.items()}
    return replaced


def _axis_from_here(axis: Any, folder: Path) -> Any:
    if not isinstance(axis, Mapping) or not isinstance(axis.get("values"), list):
        return axis
    return {**axis, "values": [path_from_here(value, folder) for value in axis["values"]]}


def sweep_from_mapping(
    data: Mapping[str, Any],
    where: str = "sweep",
    name: str = "sweep",
    *,
    overrides: Mapping[str, Any] | None = None,
) -> Sweep:
    """Build a sweep from what its file would hold.

    Args:
        data: fields by name.
        where: file, for error messages.
        name: of the sweep.
        overrides: of the base design, by dotted path.

    Returns:
        The validated sweep.

    Raises:
        InputError: names `where`, field, value and remedy.
    """
    check_keys(data, where, "", ("design", "axes"), _OPTIONAL)
    base = _base(data, where, overrides or {})
    sampling = data.get("sampling", "grid")
    if sampling not in SAMPLINGS:
        raise InputError(where, "sampling", sampling, f"expects one of {', '.join(SAMPLINGS)}")
    variants = _variants(data.get("variants"), base, where)
    axes = _axes(data["axes"], base, where, grid=sampling == "grid")
    for axis in axes:
        if set(axis.paths) & set(SPRING) and set(variants) != {PASSIVE}:
            remedy = f"only {PASSIVE} has a spring at the toe; expects variants: [{PASSIVE}]"
            raise InputError(where, f"axes.{axis.name}", list(variants), remedy)
    chosen = _measures(data.get("measures"), base, where)
    if "measures" not in data:
        chosen = _with_named(data, chosen, base)
    evaluated = _evaluated(data.get("evaluate", []), where)
    available = measures.columns(chosen, base)
    objectives = _columns(data.get("objectives", []), available, evaluated, where, "objectives")
    maps = _maps(data.get("maps", []), axes, available, evaluated, where)
    return Sweep(
        name=str(data.get("name", name)),
        description=str(data.get("description", "")).strip(),
        base=base,
        variants=variants,
        sampling=sampling,
        count=_count(data, sampling, axes, len(variants), where),
        seed=_whole(data.get("seed", 0), 0, 2**63 - 1, where, "seed"),
        axes=axes,
        measures=chosen,
        objectives=tuple(name for name in objectives if not _of_trials(name)),
        maps=tuple(m for m in maps if not _of_trials(m.measure)),
        source=where,
        evaluated=evaluated,
        trial_objectives=tuple(name for name in objectives if _of_trials(name)),
        trial_maps=tuple(m for m in maps if _of_trials(m.measure)),
    )


def _base(data: Mapping[str, Any], where: str, overrides: Mapping[str, Any]) -> RobotDesign:
    changes = data.get("set", {})
    if not isinstance(changes, Mapping):
        raise InputError(
            where, "set", changes, "expects a mapping of leaves such as {toe.mass: 0.3}"
        )
    if not isinstance(data["design"], str):
        raise InputError(
            where, "design", data["design"], "expects the name of a design or its file"
        )
    with resources.named_in(where, "design"):
        base = load_robot(data["design"])
    if isinstance(base, Design) and base.variant != "toe":
        raise InputError(
            where,
            "design",
            data["design"],
            f"is the variant {base.variant}; name its base and list it under variants",
        )
    if changes:
        base = base.with_values(changes, f"{where}: set")
    return base.with_values(overrides, "--set") if overrides else base


def _variants(value: Any, base: RobotDesign, where: str) -> tuple[str, ...]:
    if not isinstance(base, Design):
        if value is not None:
            remedy = f"{base.name} has none; leave it out"
            raise InputError(where, "variants", value, remedy)
        return (AS_DESCRIBED,)
    value = ["toe"] if value is None else value
    if not isinstance(value, list) or not value or len(set(map(str, value))) < len(value):
        raise InputError(
            where, "variants", value, f"expects a list of different ones of {', '.join(LAYOUTS)}"
        )
    for variant in value:
        if variant not in LAYOUTS:
            raise InputError(
                where,
                "variants",
                variant,
                parameters.unknown(str(variant), list(LAYOUTS), "variant"),
            )
    return tuple(value)


def _axes(data: Any, base: RobotDesign, where: str, *, grid: bool) -> tuple[Axis, ...]:
    if not isinstance(data, Mapping) or not data:
        raise InputError(
            where,
            "axes",
            data,
            "expects a mapping of at least one axis, such as toe.mass: {low: 0.1, high: 0.5, "
            "steps: 9}",
        )
    axes = tuple(
        read_axis(str(name), entry, base, where, grid=grid) for name, entry in data.items()
    )
    owner: dict[str, str] = {}
    reserved = {"variant", "rejected", *measures.columns(tuple(MEASURES))}
    for axis in axes:
        if axis.name in reserved:
            raise InputError(
                where,
                f"axes.{axis.name}",
                None,
                "is the name of another column of the table; choose another",
            )
        for path in axis.paths:
            if path in owner:
                raise InputError(
                    where, f"axes.{axis.name}", path, f"is moved by the axis {owner[path]} already"
                )
            owner[path] = axis.name
    return axes


def _count(
    data: Mapping[str, Any], sampling: str, axes: tuple[Axis, ...], variants: int, where: str
) -> int:
    if sampling == "grid":
        if "count" in data:
            raise InputError(
                where,
                "count",
                data["count"],
                "has no meaning for a grid; give steps to its axes, or another sampling",
            )
        count = 1
        for axis in axes:
            count *= len(axis.levels)
        if count * variants > MAX_DESIGNS:
            raise InputError(
                where,
                "axes",
                count * variants,
                f"makes more than {MAX_DESIGNS} designs; lower the steps, or sample with sobol",
            )
        return count
    if "count" not in data:
        raise InputError(
            where, "count", None, f"is missing; {sampling} needs the number of samples"
        )
    return _whole(data["count"], 1, MAX_DESIGNS // variants, where, "count")


def _whole(value: Any, low: int, high: int, where: str, field: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InputError(where, field, value, f"expects a whole number within {low} .. {high}")
    return value


def _measures(value: Any, base: RobotDesign, where: str) -> tuple[str, ...]:
    known = list(measures.measures_of(base))
    usual = [name for name in known if MEASURES[name].usual]
    chosen = usual if value is None else value
    if not isinstance(chosen, list) or not chosen:
        raise InputError(where, "measures", chosen, f"expects a list of some of {', '.join(known)}")
    for name in chosen:
        if name not in known:
            raise InputError(
                where,
                "measures",
                name,
                parameters.unknown(str(name), known, "measure"),
            )
    return tuple(name for name in known if name in chosen)


def _with_named(
    data: Mapping[str, Any], chosen: tuple[str, ...], base: RobotDesign
) -> tuple[str, ...]:
    """The measures of a sweep that does not list them, with those that its objectives and maps
    name.
    """
    maps, objectives = (
        part if isinstance(part, list) else [] for part in map(data.get, ("maps", "objectives"))
    )
    named = [*objectives, *(m.get("measure") for m in maps if isinstance(m, Mapping))]
    return with_columns(chosen, [str(name) for name in named], base)


def with_columns(
    chosen: tuple[str, ...], columns: Iterable[str], base: RobotDesign
) -> tuple[str, ...]:
    """Add the measures that some columns belong to.

    Args:
        chosen: names of measures.
        columns: names of columns, such as `max_joint_torque.knee`; those that no measure of the
            design has are left out.
        base: the design.

    Returns:
        Names of the measures, in the order of `measures_of`.
    """
    wanted = set(columns)
    known = measures.measures_of(base)
    return tuple(
        name for name in known if name in chosen or wanted & set(MEASURES[name].columns_of(base))
    )


def _evaluated(value: Any, where: str) -> tuple[str, ...]:
    known = list(registry.PROTOCOLS)
    if not isinstance(value, list) or any(name not in known for name in value):
        raise InputError(where, "evaluate", value, f"expects a list of {', '.join(known)}")
    return tuple(dict.fromkeys(value))


def _of_trials(name: str) -> bool:
    return bool(registry.entry(name).protocol)


def _columns(
    value: Any,
    available: tuple[str, ...],
    evaluated: tuple[str, ...],
    where: str,
    field: str,
) -> tuple[str, ...]:
    """Full names of measures that the sweep computes, or that its trials give."""
    if not isinstance(value, list):
        raise InputError(where, field, value, "expects a list of measures")
    names = []
    for name in value:
        entry = registry.resolve(str(name), evaluated, f"{where}: {field}")
        if not entry.protocol and entry.name not in available:
            measure = measures.measure_of(entry.name).name
            own = [c for c in available if c.startswith(f"{measure}.")]
            remedy = f"expects one of {', '.join(own)}" if own else _NOT_AMONG
            raise InputError(where, field, name, remedy)
        names.append(entry.name)
    return tuple(names)


def _maps(
    value: Any,
    axes: tuple[Axis, ...],
    available: tuple[str, ...],
    evaluated: tuple[str, ...],
    where: str,
) -> tuple[Map, ...]:
    if not isinstance(value, list):
        raise InputError(
            where, "maps", value, "expects a list of {x: axis, y: axis, measure: name}"
        )
    known = [axis.name for axis in axes if axis.numeric]
    maps = []
    for entry in value:
        if not isinstance(entry, Mapping) or set(entry) | {"y"} != {"x", "y", "measure"}:
            raise InputError(
                where, "maps", entry, "expects {x: axis, y: axis, measure: name}; y may be left out"
            )
        for key in ("x", "y"):
            if key in entry and (entry[key] not in known or entry["x"] == entry.get("y")):
                raise InputError(
                    where,
                    f"maps.{key}",
                    entry[key],
                    f"expects different ones of the numeric axes {', '.join(known)}",
                )
        (measure,) = _columns([entry["measure"]], available, evaluated, where, "maps.measure")
        maps.append(Map(entry["x"], entry.get("y", ""), measure))
    return tuple(maps)
