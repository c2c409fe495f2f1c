"""A foot pad and a contact's settings say the same."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.evaluation.foot_pad import FootPad, heel_area, heel_mass, pad_of_contact


def test_the_pad_of_a_contact_has_its_time_constant(design):
    pad = pad_of_contact(design, 2.0)
    assert pad.time_constant(2.0) == pytest.approx(float(design.contact.time_constant))
    assert pad.stiffness == pytest.approx(2.0 / 0.02**2)
    assert pad.damping(2.0) == pytest.approx(2 * 2.0 / 0.02)
    assert pad_of_contact(design, 2.0, 0.01).modulus == pytest.approx(4 * pad.modulus)
    assert heel_area(design) == pytest.approx(2 * np.pi * 0.012**2)


@pytest.mark.parametrize("mass", [0.5, 3.0])
def test_mujoco_bounces_a_mass_as_on_the_pad(mass):
    """A ball on a contact with little damping rings with the frequency of the pad's spring."""
    mujoco = pytest.importorskip("mujoco")
    pad = FootPad(modulus=1e5, thickness=0.012, area=1e-3, damping_ratio=0.05)
    constant = pad.time_constant(mass)
    text = f"""<mujoco><option timestep="1e-4" gravity="0 0 -1"/><worldbody>
      <geom type="plane" size="1 1 1"/>
      <body pos="0 0 0.0095"><joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.01" mass="{mass}" solref="{constant} 0.05" solimp="0.99 0.99 1e-5" priority="1" condim="1"/></body>
    </worldbody></mujoco>"""  # noqa: E501
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_REFSAFE
    height = []
    for _ in range(20_000):
        mujoco.mj_step(model, data)
        height.append(data.qpos[0] + 0.0095 - 0.01)
    below = np.array(height) < 0
    edges = np.flatnonzero(np.diff(below.astype(int)))
    contact = (edges[1] - edges[0]) * 1e-4 if below[0] == 0 else edges[0] * 1e-4
    start = np.flatnonzero(below)[0]
    if start == 0:  # begins in the pad: from the deepest point on, a quarter of a period
        contact *= 2
    assert contact == pytest.approx(np.pi * np.sqrt(mass / pad.stiffness), rel=0.15)


def test_the_mass_behind_the_heel_is_part_of_the_robot(planned_trial):
    samples = np.array([0, 40, 80])
    left, right = (heel_mass(planned_trial, samples, np.full(3, foot)) for foot in (0, 1))
    for found in (left, right):
        assert np.all((found > 0.3) & (found < planned_trial.mass))


def test_no_mass_is_refused(design):
    with pytest.raises(InputError, match="positive mass"):
        pad_of_contact(design, 0.0)
    with pytest.raises(InputError, match="positive mass"):
        pad_of_contact(design, 1.0).time_constant(-1.0)
