"""Inertia added to a body, against MuJoCo's own mass matrix and against the same body built so."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.model.body_inertia import add_inertia, add_mass
from hyperleg_design.gap.model.mechanism import inertial_parameters

ARM = """<mujoco><worldbody><body name="a"><joint name="j" axis="1 0.3 0"/>
<inertial pos="0.1 0 0.2" mass="2" fullinertia="0.03 0.04 0.05 0.01 -0.005 0.002"/>
<body name="b" pos="0 0 1"><joint name="k" axis="0 1 0"/><geom size="0.1" mass="0.5"/>{more}</body>
</body></worldbody></mujoco>"""
BALL = '<geom type="sphere" size="0.05" pos="{x} {y} {z}" mass="{mass}"/>'


def mass_matrix(model):
    data = mujoco.MjData(model)
    data.qpos[:] = [0.3, -0.7]
    mujoco.mj_forward(model, data)
    full = np.zeros((2, 2))
    mujoco.mj_fullM(model, data, full)
    return full


@pytest.mark.parametrize("place", [(0.0, 0.3, 0.0), (-0.2, 0.1, 0.4)])
def test_a_ball_added_is_a_ball_built_in(place):
    x, y, z = place
    built = mujoco.MjModel.from_xml_string(ARM.format(more=BALL.format(x=x, y=y, z=z, mass=1.5)))
    changed = mujoco.MjModel.from_xml_string(ARM.format(more=""))
    own = 0.4 * 1.5 * 0.05**2 * np.eye(3)
    add_inertia(changed, "b", inertial_parameters(1.5, np.array(place), own))
    np.testing.assert_allclose(mass_matrix(changed), mass_matrix(built), rtol=1e-9)
    index = built.body("b").id
    np.testing.assert_allclose(changed.body_ipos[index], built.body_ipos[index])


def test_what_is_added_can_be_taken_away():
    model = mujoco.MjModel.from_xml_string(ARM.format(more=""))
    before = mass_matrix(model)
    added = inertial_parameters(0.7, np.array([0.1, -0.2, 0.3]), 0.01 * np.eye(3))
    add_inertia(model, "a", added)
    assert np.abs(mass_matrix(model) - before).max() > 1e-2
    add_inertia(model, "a", -added)
    np.testing.assert_allclose(mass_matrix(model), before, rtol=1e-9)


def test_a_point_mass_moves_the_centre_and_what_mujoco_precomputes():
    model = mujoco.MjModel.from_xml_string(ARM.format(more=""))
    index = model.body("b").id
    mass, place = model.body_mass[index], model.body_ipos[index].copy()
    above = model.body_subtreemass[0]
    add_mass(model, "b", 2.0, np.array([0.0, 0.3, 0.0]))
    assert model.body_mass[index] == mass + 2.0
    np.testing.assert_allclose(model.body_ipos[index], (mass * place + [0, 0.6, 0]) / (mass + 2.0))
    assert model.body_subtreemass[0] == pytest.approx(above + 2.0)
