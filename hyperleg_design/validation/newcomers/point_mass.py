"""A point mass on a link, which is what a load is in a newcomer's loop."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np


def add_point_mass(model: mujoco.MjModel, body: str, mass: float, at: Sequence[float]) -> None:
    """Put a point mass on a body whose inertia is about its own axes.

    Args:
        model: compiled; changed.
        body: its name.
        mass: of the load [kg].
        at: its place in the frame of the body `(3,)` [m].
    """
    link, place = model.body(body).id, np.array(at)
    old, centre = model.body_mass[link], model.body_ipos[link].copy()
    away = place - centre
    model.body_inertia[link] += mass * old / (mass + old) * (away @ away - away**2)
    model.body_ipos[link] = (old * centre + mass * place) / (old + mass)
    model.body_mass[link] += mass
