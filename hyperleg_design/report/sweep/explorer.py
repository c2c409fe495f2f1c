"""The interactive part of a sweep's page: all designs as points, a table to sort and filter, and
the robot of the point that a reader selects.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from hyperleg_design.report.page import Explorer
from hyperleg_design.report.style import variant_colour
from hyperleg_design.report.sweep.rows import base_level, base_value, thinned
from hyperleg_design.robot.kinematics.posture import default_angles, link_poses, lowest_point
from hyperleg_design.robot.kinematics.tree import build_tree
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.sweep.spaces.definition import Map, Sweep
from hyperleg_design.sweep.trial_table import view_command

MOST_POINTS = 1000
"""Designs of a page's explorer; of larger sweeps those of the fronts and maps and an even sample
of the others."""
_NO_GEOMETRY = (
    "mass",
    "gear",
    "transmission",
    "motor",
    "stiffness",
    "damping",
    "derate",
    "friction",
)
"""Words in the path of a parameter that moves no link."""


def explorer(
    sweep: Sweep,
    table: Mapping[str, Any],
    labels: Mapping[str, str],
    maps: Sequence[Map],
    front: np.ndarray,
    name: str,
) -> Explorer:
    """Prepare the points of a sweep for a page.

    Args:
        sweep: whose designs are shown.
        table: columns by name, `(n,)`: `variant`, the axes, and the measures to offer; columns
            NAME.low and NAME.high are drawn as intervals of NAME.
        labels: of the measures, with units, by column.
        maps: views to offer by a button: two axes in the measure's colour, or the measure over one.
        front: whether a design is on the Pareto front of its variant, `(n,)`.
        name: of the part, unique in its page.

    Returns:
        The explorer.
    """
    count = len(table["variant"])
    first = front | _on_maps(sweep, table, maps)
    others = np.flatnonzero(~first)
    rest = max(MOST_POINTS - int(first.sum()), MOST_POINTS // 3)
    rows = np.union1d(np.flatnonzero(first), others[thinned(others.size, rest)])
    columns: list[dict[str, Any]] = [
        {
            "name": "variant",
            "label": "variant" if sweep.has_variants else "none",
            "values": _texts(table["variant"][rows]),
        }
    ]
    for axis in sweep.axes:
        values = table[axis.name][rows]
        base: Any = base_level(axis, sweep) if sweep.sampling == "grid" else base_value(axis, sweep)
        columns.append(
            {
                "name": axis.name,
                "label": axis.label,
                "values": _numbers(values) if axis.numeric else _texts(values),
                "axis": True,
                "log": axis.log,
                "base": _plain(base),
            }
        )
    columns += [
        {"name": column, "label": labels[column], "values": _numbers(table[column][rows])}
        | {
            end: _numbers(table[f"{column}.{end}"][rows])
            for end in ("low", "high")
            if f"{column}.{end}" in table
        }
        for column in labels
    ]
    axes = {axis.name: table[axis.name][rows] for axis in sweep.axes}
    drawings, robot = _drawings(sweep, axes, table["variant"][rows])
    return Explorer(
        name,
        {
            "columns": columns,
            "front": front[rows].astype(int).tolist(),
            "colours": {v: variant_colour(v) for v in sweep.variants},
            "views": [_view(chosen, labels) for chosen in maps],
            "grid": sweep.sampling == "grid",
            "look": _commands(sweep, axes, table["variant"][rows]),
            "drawings": drawings,
            "robot": robot,
            "shown": f"{len(rows)} designs"
            + (f", a sample of {count}" if len(rows) < count else ""),
        },
    )


def _on_maps(sweep: Sweep, table: Mapping[str, Any], maps: Sequence[Map]) -> np.ndarray:
    """Designs of a grid whose parameters are unchanged but for those that a map is over, `(n,)`."""
    on_map = np.zeros(len(table["variant"]), bool)
    for chosen in maps if sweep.sampling == "grid" else ():
        held = [axis for axis in sweep.axes if axis.name not in (chosen.x, chosen.y)]
        same = [table[axis.name] == base_level(axis, sweep) for axis in held]
        on_map |= np.all([np.ones_like(on_map), *same], axis=0)
    return on_map


def _view(chosen: Map, labels: Mapping[str, str]) -> dict[str, str]:
    label = labels.get(chosen.measure, chosen.measure)
    if chosen.y:
        over = f"{chosen.x} and {chosen.y}"
        return {"x": chosen.x, "y": chosen.y, "colour": chosen.measure, "text": f"{label}, {over}"}
    view = {"x": chosen.x, "y": chosen.measure, "colour": "variant"}
    return view | {"text": f"{label} over {chosen.x}"}


def _commands(sweep: Sweep, axes: Mapping[str, np.ndarray], variants: np.ndarray) -> list[str]:
    """What shows each design in three dimensions."""
    return [
        view_command(sweep, {name: values[i] for name, values in axes.items()} | {"variant": v})
        for i, v in enumerate(variants)
    ]


def _drawings(
    sweep: Sweep, axes: Mapping[str, np.ndarray], variants: np.ndarray
) -> tuple[list[Any], list[int]]:
    """Side views without repeats, and which one is each design's; designs that differ in nothing
    that moves a link share one.
    """
    shaping = [
        a.name
        for a in sweep.axes
        if not all(any(word in path for word in _NO_GEOMETRY) for path in a.paths)
    ]
    known: dict[tuple[str, ...], int] = {}
    drawn: dict[str, list[int]] = {}
    keys = list(zip(map(str, variants), *(map(str, axes[name]) for name in shaping), strict=True))
    for row, key in enumerate(keys):
        if key not in known:
            known[key] = len(known)
            drawn.setdefault(key[0], []).append(row)
    drawings: list[Any] = [None] * len(known)
    for variant, rows in drawn.items():
        designs = sweep.design({name: values[rows] for name, values in axes.items()}, variant)
        for place, row in enumerate(rows):
            design = designs.take(place) if designs.batch_shape else designs
            drawings[known[keys[row]]] = side_view(design)
    return drawings, [known[key] for key in keys]


def side_view(design: RobotDesign) -> list[list[float]]:
    """Compute lines from each joint to those behind it and to the pads, seen from the right in the
    default posture.

    Args:
        design: one robot.

    Returns:
        x and z of begin and end of each line [mm], `(lines, 4)`; z is 0 at the floor.
    """
    tree = build_tree(design)
    poses = link_poses(tree, default_angles(tree))
    floor = lowest_point(tree, poses)
    lines = []
    for link in tree.links:
        rotation, origin = poses[link.name]
        ends = [poses[j.child][1] for j in tree.joints if j.parent == link.name]
        ends += [origin + rotation @ np.array(pad.position) for pad in link.pads]
        if link.name == tree.base:
            for shape in link.visuals:
                half = rotation @ np.array([0.0, 0.0, shape.size[-1] / 2])
                middle = origin + rotation @ np.array(shape.position)
                ends += [middle + half]
        lines += [[origin[0], origin[2] - floor, end[0], end[2] - floor] for end in ends]
    rounded = {tuple(round(1e3 * v) for v in line) for line in lines}
    return [list(line) for line in sorted(rounded) if line[:2] != line[2:]]


def _numbers(values: Any) -> list[float | None]:
    numbers = np.asarray(values, float)
    return [float(f"{v:.5g}") if np.isfinite(v) else None for v in numbers]


def _texts(values: Any) -> list[str]:
    return [str(v) for v in values]


def _plain(value: Any) -> Any:
    return float(value) if isinstance(value, int | float | np.number) else str(value)
