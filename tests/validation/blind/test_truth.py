"""The truth of a blind case in the catalogue's words, against the catalogue and the plants."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.rig_build import Reach, build_rig
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.truth import KIND, parameters, places
from hyperleg_design.validation.blind.wrong import (
    CATALOGUE,
    ODDITIES,
    SIZES,
    WALKING_ONLY,
    Wrong,
)
from tests.validation.blind.shapes import SHAPES


@pytest.fixture(scope="module")
def arm():
    return chain("arm")


def values(effect, robot, size, reach=None):
    link = robot.links[-1]
    place = {"link": link.name, "battery": "battery", "robot": "robot"}
    wrong = Wrong(effect, place.get(KIND[effect], link.joint), size, SHAPES.get(effect, {}))
    return parameters(wrong, robot, perfect(robot), reach)


def test_every_effect_has_a_kind_of_place():
    assert set(KIND) == {*CATALOGUE, *ODDITIES}


@pytest.mark.parametrize(
    "effect", sorted(set(CATALOGUE) - set(WALKING_ONLY) - {"torque_saturation"})
)
def test_parameters_have_names_and_sizes_that_the_catalogue_knows(effect, arm):
    known = {p.name: p for p in EFFECTS[effect].parameters}
    for name, value in values(effect, arm, SIZES[effect].smallest).items():
        assert known[name].low <= value <= known[name].high, name


def test_a_torque_limit_is_what_the_effect_derives_from_its_parameter(arm):
    reach = Reach(0.5 * arm.peak_torque, np.ones(len(arm.motors)))
    (told,) = values("torque_saturation", arm, 0.2, reach).items()
    subject = SimpleNamespace()
    derived = EFFECTS["torque_saturation"].derived("", np.array([1 / told[1]]), subject)
    assert derived == {told[0]: (pytest.approx(told[1]), "Nm")}


@pytest.mark.parametrize("effect", ODDITIES)
def test_an_effect_outside_the_catalogue_has_no_parameters_in_it(effect, arm):
    assert parameters(Wrong(effect, arm.joints[0], 0.1, {}), arm, perfect(arm), None) == {}


def test_what_is_told_is_what_the_plant_has(arm):
    """The plants and the truth compute the same sizes on their own."""
    day, m = perfect(arm), len(arm.motors)
    reach = Reach(0.5 * arm.peak_torque, np.ones(m))
    healthy = build_rig(arm, day)
    last = arm.joints[-1]

    def plant(effect, size):
        wrong = Wrong(effect, last, size, SHAPES.get(effect, {}))
        return build_rig(arm, day, [wrong], reach), values(effect, arm, size, reach)

    ill, told = plant("coulomb_friction", 0.05)
    assert told["torque"] == pytest.approx((ill.coulomb - healthy.coulomb)[-1])
    ill, told = plant("torque_saturation", 0.3)
    assert told["limit"] == pytest.approx(ill.peak_torque[-1])
    ill, told = plant("rotor_inertia", 0.4)
    assert told["inertia"] == pytest.approx((ill.rotor_inertia - healthy.rotor_inertia)[-1])
    ill, told = plant("transmission_elasticity", 9.0)
    assert told["compliance"] == pytest.approx(1 / ill.belt_stiffness[-1])
    ill, told = plant("transmission_ratio", 0.05)
    assert told["scale"] == pytest.approx(
        ill.joint_from_motor[-1, -1] / arm.joint_from_motor[-1, -1]
    )
    ill, told = plant("controller_gain", 0.2)
    assert told["stiffness_scale"] == pytest.approx(ill.stiffness[-1] / arm.stiffness[-1])
    assert told["damping_scale"] == pytest.approx(ill.damping[-1] / arm.damping[-1])
    ill, told = plant("joint_spring", 0.1)
    angle = 0.4
    pull = -ill.spring[-1] * (angle - ill.spring_rest[-1])
    assert -told["stiffness"] * angle - told["preload"] == pytest.approx(pull)


def test_a_link_and_the_joint_that_carries_it_are_one_place(arm):
    link = arm.links[2]
    assert places(Wrong("payload", link.name, 1.0, {}), arm) == (link.name, link.joint)
    renamed = dataclasses.replace(arm, motors=tuple(f"m_{name}" for name in arm.motors))
    joint = places(Wrong("coulomb_friction", link.joint, 0.1, {}), renamed)
    assert joint == (link.joint, renamed.motors[2])  # each joint has a motor of its own
    assert places(Wrong("voltage_sag", "battery", 0.1, {}), arm) == ("battery", "robot")


def test_a_joint_of_coupled_motors_is_not_a_motor():
    leg = chain("leg")
    joint = leg.joints[-1]
    assert places(Wrong("coulomb_friction", joint, 0.1, {}), leg) == (joint,)
