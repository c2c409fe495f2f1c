"""How a design is modelled: what its sections mean in MuJoCo and in masses."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.laws.gear import gear_change
from hyperleg_design.robot.mjcf import mujoco_model
from hyperleg_design.robot.parameters.model_sections import (
    Contact,
    FrictionModel,
    GearModel,
    MassModel,
    StopModel,
)


def test_stops_and_contacts_are_mujocos_parameters(hyperleg):
    values = {
        "stops.time_constant": 0.03,
        "stops.damping_ratio": 0.7,
        "stops.impedance": 0.9,
        "contact.friction": 0.6,
        "contact.torsional_friction": 0.02,
        "contact.time_constant": 0.015,
        "contact.damping_ratio": 1.5,
        "contact.pad_radius": 0.011,
    }
    model = mujoco_model(hyperleg.with_values(values))
    hinges = model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE
    np.testing.assert_allclose(model.jnt_solref[hinges], [[0.03, 0.7]] * hinges.sum())
    np.testing.assert_allclose(model.jnt_solimp[hinges][:, 1], 0.9)
    pads = np.array(["_pad_" in model.geom(i).name for i in range(model.ngeom)])
    assert pads.any()
    np.testing.assert_allclose(model.geom_friction[pads][:, :2], [[0.6, 0.02]] * pads.sum())
    np.testing.assert_allclose(model.geom_solref[pads], [[0.015, 1.5]] * pads.sum())
    np.testing.assert_allclose(model.geom_size[pads][:, 0], 0.011)


def test_ballast_adds_its_mass_to_each_thigh(hyperleg):
    heavy = hyperleg.with_values({"masses.thigh_ballast": 0.4, "masses.expected_total": 0.0})
    before, after = masses.mass_table(hyperleg), masses.mass_table(heavy)
    assert float(after.thigh) == pytest.approx(float(before.thigh) + 0.4)
    assert float(after.total) == pytest.approx(float(before.total) + 0.8)


@pytest.mark.parametrize(
    ("section", "compute"),
    [("masses", masses.mass_table), ("friction", joint_friction), ("gears", gear_change)],
)
def test_an_unknown_law_is_named_with_those_that_are(hyperleg, section, compute):
    with pytest.raises(InputError, match=rf"{section}\.law = 'newton': expects one of \w+, "):
        compute(hyperleg.with_values({f"{section}.law": "newton"}))


@pytest.mark.parametrize(
    ("section", "leaves", "words"),
    [
        (MassModel, {"gear_mass_per_torque": 0.01, "thigh_ballast": 25}, "thigh_ballast.*25.*kg"),
        (FrictionModel, {"motor_share": 1.1}, r"motor_share.*1\.1"),
        (GearModel, {"loss_per_doubling": -0.01}, "loss_per_doubling"),
        (StopModel, {"impedance": 1.0}, "impedance"),
        (StopModel, {"time_constant": 20.0}, "time_constant.*20.* s"),
        (
            Contact,
            {
                "friction": 0.8,
                "torsional_friction": 0.01,
                "pad_radius": 12.0,
                "time_constant": 0.01,
                "damping_ratio": 1.0,
            },
            "contact: pad_radius.*12.* m",
        ),
    ],
)
def test_numbers_of_another_unit_are_refused(section, leaves, words):
    with pytest.raises(InputError, match=words):
        section(**leaves)
