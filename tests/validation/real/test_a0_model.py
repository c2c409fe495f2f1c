"""The model file of the A0 double pendulum."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.validation.real.a0_model import (
    JOINTS,
    TIP_MASS,
    DoublePendulum,
    read_model,
)

MODEL = DoublePendulum(
    mass=(0.6, 0.7),
    com=(0.25, 0.17),
    inertia=(0.05, 0.026),
    length=(0.3, 0.2),
    armature=(0.003, 0.004),
    coulomb=(0.15, 0.12),
    viscous=(0.01, 0.02),
)


def inverse(model, q, v, a):
    """Torques by MuJoCo's inverse dynamics, without Coulomb friction `(t, 2)`."""
    compiled = mujoco.MjModel.from_xml_string(replace(model, coulomb=(0.0, 0.0)).mjcf())
    data, torque = mujoco.MjData(compiled), np.zeros_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(compiled, data)
        torque[k] = data.qfrc_inverse
    return torque


def makers(m, q, v, a):
    """The makers' equation of motion, without their terms in `Ir` alone and Coulomb friction."""
    coupling = m.mass[1] * m.length[0] * m.com[1]
    cos, sin = np.cos(q[:, 1]), np.sin(q[:, 1])
    inertia = m.inertia[0] + m.inertia[1] + m.mass[1] * m.length[0] ** 2 + 2 * coupling * cos
    cross = m.inertia[1] + coupling * cos
    first, both = np.sin(q[:, 0]), np.sin(q.sum(1))
    lever = m.mass[0] * m.com[0] + m.mass[1] * m.length[0]
    weight = m.gravity * m.mass[1] * m.com[1] * both
    shoulder = (
        (inertia + m.armature[0]) * a[:, 0]
        + cross * a[:, 1]
        - coupling * sin * (2 * v[:, 0] * v[:, 1] + v[:, 1] ** 2)
        + m.gravity * lever * first
        + weight
    )
    elbow = cross * a[:, 0] + (m.inertia[1] + m.armature[1]) * a[:, 1]
    elbow += coupling * sin * v[:, 0] ** 2 + weight
    return np.stack([shoulder, elbow], 1) + np.array(m.viscous) * v


def test_the_mjcf_moves_as_the_makers_equations_say():
    rng = np.random.default_rng(4)
    q, v, a = rng.normal(size=(3, 50, 2)) * np.array([2.0, 3.0, 20.0])[:, None, None]
    for model in (MODEL, MODEL.without_rotors(), MODEL.without_friction(*JOINTS)):
        np.testing.assert_allclose(
            inverse(model, q, v, a), makers(model, q, v, a), rtol=1e-9, atol=1e-9
        )


def test_the_tip_left_out_is_half_a_kilogram_at_the_end_of_link_two():
    light = MODEL.without_tip()
    length = MODEL.length[1]
    assert MODEL.mass[1] - light.mass[1] == pytest.approx(TIP_MASS)
    moment = MODEL.mass[1] * MODEL.com[1] - light.mass[1] * light.com[1]
    assert moment == pytest.approx(TIP_MASS * length)
    assert MODEL.inertia[1] - light.inertia[1] == pytest.approx(TIP_MASS * length**2)
    assert light.mass[0] == MODEL.mass[0]


def test_a_damaged_model_file_is_refused(tmp_path):
    path = tmp_path / "model.yml"
    path.write_text("m1: 0.5\nm2: heavy\n")
    with pytest.raises(InputError, match="m2"):
        read_model(path)
    with pytest.raises(InputError):
        read_model(tmp_path / "none.yml")


def test_a_load_that_is_taken_off_is_a_point_mass():
    model = DoublePendulum(
        (1.0, 0.8), (0.2, 0.15), (0.06, 0.04), (0.3, 0.3), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    )
    less = model.without_load(1, 0.3, 0.2)
    assert less.mass[1] + 0.3 == pytest.approx(0.8)
    assert less.mass[1] * less.com[1] + 0.3 * 0.2 == pytest.approx(0.8 * 0.15)
    assert less.inertia[1] + 0.3 * 0.2**2 == pytest.approx(0.04)
    assert (less.mass[0], less.com[0], less.inertia[0]) == (1.0, 0.2, 0.06)
