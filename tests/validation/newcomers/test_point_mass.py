"""A load adds its mass, its moment and its inertia, as MuJoCo makes them of a body of its own."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import crane, servo_arm
from hyperleg_design.validation.newcomers.point_mass import add_point_mass


@pytest.mark.parametrize(
    ("xml", "body", "at"),
    [(crane.XML, "tool", (0.05, 0.0, 0.06)), (servo_arm.XML, "hand", (0.05, 0.01, 0.0))],
)
def test_a_load_adds_its_mass_and_its_moment(xml, body, at):
    model = mujoco.MjModel.from_xml_string(xml)
    link = model.body(body).id
    mass, moment = model.body_mass[link], model.body_mass[link] * model.body_ipos[link]
    add_point_mass(model, body, 0.2, at)
    assert model.body_mass[link] == pytest.approx(mass + 0.2)
    np.testing.assert_allclose(
        model.body_mass[link] * model.body_ipos[link], moment + 0.2 * np.array(at)
    )


def test_on_an_axis_it_is_a_body_of_its_own():
    """On a principal axis the inertia stays diagonal, and both models move alike."""
    text = servo_arm.XML.replace("30 .008 0", "30 .008 0").replace(
        'pos=".03 .008 0"', 'pos=".03 0 0"'
    )
    model = mujoco.MjModel.from_xml_string(text)
    add_point_mass(model, "hand", 0.2, (0.08, 0.0, 0.0))
    mujoco.mj_setConst(model, mujoco.MjData(model))
    inertial = '<inertial pos="0 0 0" mass=".2" diaginertia="1e-9 1e-9 1e-9"/>'
    load = f'<body name="load" pos=".08 0 0">{inertial}</body>'
    i = text.index('<joint name="roll"')
    end = text.index("</body>", i)
    other = mujoco.MjModel.from_xml_string(text[:end] + load + text[end:])
    posture, speed = np.array([0.3, 0.5, -0.4, 0.7, 0.2]), np.array([1.0, -2.0, 0.5, 1.5, 3.0])
    needed = []
    for one in (model, other):
        data = mujoco.MjData(one)
        data.qpos[:], data.qvel[:], data.qacc[:] = posture, speed, -speed
        mujoco.mj_inverse(one, data)
        needed.append(data.qfrc_inverse.copy())
    np.testing.assert_allclose(needed[0], needed[1], atol=1e-6)
