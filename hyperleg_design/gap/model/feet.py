"""Feet of a compiled robot, and the pads with which they touch the ground."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from hyperleg_design.gap.model import robot_file
from hyperleg_design.gap.model.mechanism import BASE, Mechanism
from hyperleg_design.gap.model.subject import Pad


def pads_of(model: Any, tree: Mechanism, feet: Mapping[str, int] | None = None) -> tuple[Pad, ...]:
    """List the spheres, ends of capsules and corners of boxes that collide on moving links.

    Args:
        model: compiled.
        tree: of the same robot.
        feet: foot of each link that belongs to one, with -1 - foot for a link of which only spheres
            do; by default all links do, to the first.

    Returns:
        The pads, in the order of the model.
    """
    import mujoco

    pads = []
    for geom in range(model.ngeom):
        name = model.body(int(model.geom_bodyid[geom])).name
        if name not in tree.links or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        sphere = model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE
        if feet is not None and (name not in feet or (feet[name] < 0 and not sphere)):
            continue
        foot = 0 if feet is None else feet[name] if feet[name] >= 0 else -1 - feet[name]
        points, radius = robot_file.touching_points(model, geom)
        label = model.geom(geom).name or f"{name}_{geom}"
        for index, point in enumerate(points):
            title = label if len(points) == 1 else f"{label}_{index}"
            place = float(point[0]), float(point[1]), float(point[2])
            pads.append(Pad(title, foot, tree.links.index(name), place, radius))
    return tuple(pads)


def feet_of(model: Any, tree: Mechanism) -> tuple[tuple[str, ...], tuple[Pad, ...]]:
    """Find the feet: the outermost links with shapes that collide; spheres further up the same limb
    are pads of that foot too.

    Args:
        model: compiled.
        tree: of the same robot.

    Returns:
        Names of the feet, and their pads.
    """
    names = [model.body(b).name for b in range(model.nbody)]
    collides = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    touching = set(model.geom_bodyid[collides].tolist())

    def limb(body: int) -> bool:
        return names[body] in tree.links and tree.link_joint[tree.links.index(names[body])] != BASE

    feet: list[str] = []
    foot_of: dict[str, int] = {}
    for leaf in sorted(set(range(1, model.nbody)) - set(model.body_parentid.tolist())):
        body = leaf
        while body and body not in touching:
            body = int(model.body_parentid[body])
        if not limb(body) or names[body] in feet:
            continue
        foot_of[names[body]] = len(feet)
        above = int(model.body_parentid[body])
        while limb(above):
            foot_of.setdefault(names[above], -1 - len(feet))  # below zero: spheres only
            above = int(model.body_parentid[above])
        feet.append(names[body])
    return tuple(feet), pads_of(model, tree, foot_of)
