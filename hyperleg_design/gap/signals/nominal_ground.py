"""The nominal ground under feet: friction, and how it bears their pads, from a robot's model.

k and c are MuJoCo's of the foot's shapes: with i(d) the impedance of `solimp` and R = (1 - i) / i
times the body's inverse weight, F = (i k' d + b' d') / R, k' = 1 / (i_max T r)^2 and
b' = 2 / (i_max T) of `solref` (T, r), or the two given as they are where negative; a pyramid of
friction makes it 2 / (mu^2 (1 + mu^2)) as stiff.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.gap.model.subject import Subject

if TYPE_CHECKING:
    import mujoco


@dataclass(frozen=True, eq=False)
class Law:
    """How the model's ground bears p pads."""

    spring: np.ndarray
    """Stiffness over mass k' of each pad `(p,)` [1/s^2]."""
    damper: np.ndarray
    """Damping over mass b' of each pad `(p,)` [1/s]."""
    weight: np.ndarray
    """Inverse of the inertia that a pad stands for [1/kg], `(p,)`."""
    impedance: np.ndarray
    """MuJoCo's `solimp`: least, most, width, middle, power, `(p, 5)`."""
    weakest: float = 1.0
    """Friction along the flat sides of its cone over that along the edges: a pyramid's holds less
    there, and nobody knows its edges."""

    @property
    def creep(self) -> float:
        """Tangential force over speed of one pad below the cone, of the softest at its softest
        [Ns/m].
        """
        return float(np.min(self.damper * self._mass(self.impedance[:, 0])))

    def force(
        self, depth: np.ndarray, sink: np.ndarray, spring: float = 1.0, damper: float = 1.0
    ) -> np.ndarray:
        """Compute the vertical force on all pads together; pads push and never pull.

        Args:
            depth: under the floor `(t, p)` [m].
            sink: its rate `(t, p)` [m/s].
            spring: scale of k'.
            damper: scale of b'.

        Returns:
            The force [N], `(t,)`.
        """
        impedance = self._impedance(depth)
        push = (
            spring * self.spring * impedance * depth + damper * self.damper * sink
        ) * self._mass(impedance)
        return np.asarray(np.where(depth > 0, np.maximum(push, 0.0), 0.0 * depth).sum(-1))

    def mass(self, depth: np.ndarray) -> np.ndarray:
        """Compute 1 / R of pads under the floor, by which contacts resist acceleration.

        Args:
            depth: under the floor [m], `(t, p)`.

        Returns:
            The mass [kg], `(t, p)`; zero above the floor.
        """
        return np.asarray(np.where(depth > 0, self._mass(self._impedance(depth)), 0.0))

    def _mass(self, impedance: np.ndarray) -> np.ndarray:
        return np.asarray(impedance / ((1 - impedance) * self.weight))

    def _impedance(self, depth: np.ndarray) -> np.ndarray:
        least, most, width, middle, power = self.impedance.T
        x = np.clip(np.nan_to_num(depth) / width, 0.0, 1.0)
        rising = x**power / middle ** (power - 1)
        falling = 1 - (1 - x) ** power / (1 - middle) ** (power - 1)
        return np.asarray(least + (most - least) * np.where(x < middle, rising, falling))


def foot_bodies(subject: Subject, foot: int) -> tuple[str, ...]:
    """List the links of a foot that may touch the ground.

    Args:
        subject: the robot.
        foot: index of the foot.

    Returns:
        Names of the links.
    """
    return tuple(dict.fromkeys(subject.tree.links[p.link] for p in subject.pads if p.foot == foot))


def foot_geoms(model: mujoco.MjModel, bodies: tuple[str, ...]) -> list[int]:
    """List the shapes of some bodies that collide.

    Args:
        model: the compiled model.
        bodies: names.

    Returns:
        Indices of the shapes.
    """
    ids = {model.body(name).id for name in bodies}
    return [
        g
        for g in range(model.ngeom)
        if int(model.geom_bodyid[g]) in ids and (model.geom_contype[g] or model.geom_conaffinity[g])
    ]


def floor_geoms(model: mujoco.MjModel) -> list[int]:
    """List the shapes of the world that collide.

    Args:
        model: the compiled model.

    Returns:
        Their indices.
    """
    return [
        g
        for g in range(model.ngeom)
        if model.geom_bodyid[g] == 0 and (model.geom_contype[g] or model.geom_conaffinity[g])
    ]


def floor_height(model: mujoco.MjModel) -> float | None:
    """Look up how high the highest plane of the world lies.

    Args:
        model: the compiled model.

    Returns:
        Its height [m]; None where the world has none that collides.
    """
    import mujoco

    plane = mujoco.mjtGeom.mjGEOM_PLANE
    heights = [model.geom_pos[g, 2] for g in floor_geoms(model) if model.geom_type[g] == plane]
    return float(max(heights)) if heights else None


def pair_settings(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Look up the contact settings between a shape and the floor, as MuJoCo mixes them.

    Args:
        model: the compiled model.
        geom: index of the shape.

    Returns:
        Friction `(3,)`, `solref` `(2,)`, and the number of contact dimensions.
    """
    other = next(iter(floor_geoms(model)), geom)
    ranks = model.geom_priority[geom], model.geom_priority[other]
    if other == geom or ranks[0] != ranks[1]:
        chosen = other if ranks[0] < ranks[1] else geom
        return (
            model.geom_friction[chosen].copy(),
            model.geom_solref[chosen].copy(),
            int(model.geom_condim[chosen]),
        )
    friction = np.maximum(model.geom_friction[geom], model.geom_friction[other])
    parts = model.geom_solmix[[geom, other]]
    share = parts[0] / parts.sum() if parts.sum() > 0 else 0.5
    own, theirs = model.geom_solref[geom], model.geom_solref[other]
    solref = (
        share * own + (1 - share) * theirs
        if own[0] > 0 and theirs[0] > 0
        else np.minimum(own, theirs)
    )
    return friction, solref, int(max(model.geom_condim[geom], model.geom_condim[other]))


def nominal_ground(subject: Subject, links: tuple[str, ...]) -> tuple[float, Law]:
    """Read the nominal ground under some links.

    Args:
        subject: the robot.
        links: names of links with pads.

    Returns:
        Friction coefficient of the ground under the first link, and how the ground bears one pad of
        each link.
    """
    import mujoco

    model = subject.model
    rows: list[tuple[float, float, float, np.ndarray]] = []
    coefficient = 0.0
    for link in links:
        geom = foot_geoms(model, (link,))[0]
        friction, solref, dimensions = pair_settings(model, geom)
        coefficient = coefficient or float(friction[0])
        impedance = model.geom_solimp[geom].copy()
        impedance[:2] = np.clip(impedance[:2], 1e-4, 0.9999)
        impedance[2] = max(impedance[2], 1e-9)
        most = impedance[1]
        weight = max(float(model.body_invweight0[model.geom_bodyid[geom], 0]), 1e-9)
        if model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL and dimensions > 1:
            weight *= (
                float(friction[0]) ** 2 * (1 + float(friction[0]) ** 2) / (2 * model.opt.impratio)
            )
        if solref[0] > 0:
            rows.append(
                (1 / (most * solref[0] * solref[1]) ** 2, 2 / (most * solref[0]), weight, impedance)
            )
        else:
            rows.append((-solref[0] / most**2, -solref[1] / most, weight, impedance))
    spring, damper, weights, impedances = (np.array(values) for values in zip(*rows, strict=True))
    pyramid = model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
    return coefficient, Law(
        spring, damper, weights, impedances, float(np.sqrt(0.5)) if pyramid else 1.0
    )
