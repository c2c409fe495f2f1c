"""Inertia added to a body of a compiled MuJoCo model."""

from __future__ import annotations

from typing import Any

import numpy as np

from hyperleg_design.gap.model.mechanism import (
    inertial_parameters,
    mass_properties,
    quaternion_rotation,
)


def add_inertia(model: Any, body: str, added: np.ndarray) -> None:
    """Add inertial parameters to those of a body of a compiled model, which changes in place.

    Args:
        model: the compiled model; what it precomputes (`mj_setConst`) stays as it was.
        body: name of the body.
        added: in the body's frame, as `mechanism.inertial_parameters` gives them, `(10,)`.
    """
    import mujoco

    index = model.body(body).id
    turned = quaternion_rotation(model.body_iquat[index])
    own = inertial_parameters(
        float(model.body_mass[index]),
        model.body_ipos[index],
        turned @ np.diag(model.body_inertia[index]) @ turned.T,
    )
    mass, com, inertia = mass_properties(own + added)
    values, vectors = np.linalg.eigh(inertia)
    if np.linalg.det(vectors) < 0:
        vectors[:, 0] *= -1
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, vectors.ravel())
    model.body_mass[index] = mass
    model.body_ipos[index] = com
    model.body_inertia[index] = values
    model.body_iquat[index] = quaternion
    model.body_simple[index] = model.body_sameframe[index] = 0  # what the compiler took for granted


def add_mass(model: Any, body: str, mass: float, com: np.ndarray) -> None:
    """Put a point mass on a body of a compiled model, which changes in place.

    Args:
        model: the compiled model.
        body: name of the body.
        mass: [kg].
        com: in the body's frame [m], `(3,)`.
    """
    import mujoco

    add_inertia(model, body, inertial_parameters(mass, com, np.zeros((3, 3))))
    mujoco.mj_setConst(model, mujoco.MjData(model))
