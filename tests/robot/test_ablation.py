from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import DESCRIPTION, ablate, confound, variants
from hyperleg_design.robot.design import design_from_mapping, load_design
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.masses import actuator_mass, mass_table
from hyperleg_design.robot.motors import catalogue
from hyperleg_design.robot.names import PASSIVE, VARIANTS


def test_masses_of_the_papers_ablations(hyperleg):
    motor = actuator_mass("RI60", 7.0, 0.01)
    expected = {
        "toe": 32.0,
        "toe_locked": 32.0,
        "toe_removed_matched": 32.0,
        "toe_removed": 32.0 - 2 * (0.22 + motor),
    }
    for name, variant in variants(hyperleg).items():
        assert mass_table(variant).total == pytest.approx(expected[name], abs=1e-12)
        assert variant.variant == name


def test_the_sole_keeps_its_length(hyperleg):
    for variant in variants(hyperleg).values():
        assert (variant["toe.length"], variant["foot.ball_length"]) == (0.065, 0.120)


@given(
    motor=st.sampled_from(sorted(catalogue())),
    law=st.sampled_from(["components", "fixed"]),
    place=st.sampled_from(["thigh", "shank", "pelvis"]),
    ballast=st.floats(0, 0.5),
)
@settings(max_examples=30)
def test_the_matched_ablation_keeps_the_mass_of_any_design(hyperleg, motor, law, place, ballast):
    design = hyperleg.with_values(
        {
            "actuators.toe.motor": motor,
            "masses.law": law,
            "actuators.toe.housed_in": place,
            "masses.thigh_ballast": ballast,
        }
    )
    matched, removed = (
        mass_table(ablate(design, "toe_removed_matched")),
        mass_table(ablate(design, "toe_removed")),
    )
    assert matched.total == pytest.approx(mass_table(design).total, abs=1e-12)
    assert removed.total < matched.total - 2 * 0.22


def test_the_papers_confound(hyperleg):
    found = confound(hyperleg)
    torque = {name: found[name]["max_joint_torque"] for name in VARIANTS}
    assert torque["toe"]["knee"] == pytest.approx(212, rel=1e-3)
    assert torque["toe_locked"]["knee"] == torque["toe"]["knee"]
    for name in ("toe_removed_matched", "toe_removed"):
        assert torque[name]["knee"] == pytest.approx(166, abs=0.5)
        assert torque[name]["ankle_pitch"] == pytest.approx(76.3, abs=0.05)
        assert found[name]["lost"]["ankle_pitch"] == pytest.approx(111.7 - 76.3, abs=0.1)
        assert found[name]["lost"]["ankle_roll"] == 0
        assert (found[name]["motors"], found[name]["joints"]) == (6, 6)
    assert (found["toe_locked"]["motors"], found["toe_locked"]["joints"]) == (7, 6)
    assert {found[name]["removes"] for name in VARIANTS} == {DESCRIPTION[n] for n in VARIANTS}


def test_a_passive_toe_is_a_spring_at_equal_mass(hyperleg):
    passive = ablate(hyperleg.with_values({"toe.stiffness": 20.0}), PASSIVE)
    assert mass_table(passive).total == pytest.approx(32.0, abs=1e-12)
    matrix = transmission.joint_from_motor(passive)
    assert matrix.shape == (7, 6)
    np.testing.assert_array_equal(matrix[6], 0.0)
    matched = ablate(hyperleg, "toe_removed_matched")
    np.testing.assert_array_equal(matrix[:6], transmission.joint_from_motor(matched))
    torque = np.array([1.0, -2.0, 3.0, 20.0, 10.0, 1.0, 5.0])
    motor = transmission.motor_torque(matrix, torque)
    np.testing.assert_allclose(matrix @ motor, np.r_[torque[:6], 0.0], atol=1e-12)
    with pytest.raises(InputError, match="start from the toe variant"):
        ablate(passive, "toe_locked")


def test_friction_of_a_passive_toe_is_the_joints_part_and_its_damper(hyperleg):
    (coulomb, viscous), (own, of_joint) = (
        joint_friction(d)
        for d in (ablate(hyperleg.with_values({"toe.damping": 0.5}), PASSIVE), hyperleg)
    )
    share = 1.0 - hyperleg.friction.motor_share
    assert coulomb[6] == pytest.approx(own[6] * share)
    assert viscous[6] == pytest.approx(of_joint[6] * share + 0.5)
    matched = joint_friction(ablate(hyperleg, "toe_removed_matched"))
    np.testing.assert_array_equal(coulomb[:6], matched[0][:6])


def test_only_a_passive_toe_has_a_spring():
    passive = load_design("toe_passive", overrides={"toe.stiffness": 30.0})
    assert (passive.toe.stiffness, passive.variant) == (30.0, PASSIVE)
    assert passive.origins["toe.damping"].label == "assumed"
    again = design_from_mapping(passive.to_mapping(), "again")
    assert (again.toe.stiffness, again.variant) == (30.0, PASSIVE)
    assert not {"stiffness", "damping"} & set(load_design("toe").to_mapping()["toe"])
    with pytest.raises(InputError, match="only toe_passive has a spring"):
        load_design("toe", overrides={"toe.stiffness": 30.0})
    with pytest.raises(InputError, match="no motor"):
        load_design(overrides={"toe.joint": "passive"})


def test_a_batch_is_ablated_as_a_whole(hyperleg):
    batch = hyperleg.with_values(
        {"toe.mass": np.array([0.2, 0.3]), "actuators.toe.motor": np.array(["RI60", "RI70"])}
    )
    matched = ablate(batch, "toe_removed_matched")
    np.testing.assert_allclose(mass_table(matched).total, mass_table(batch).total, atol=1e-12)
    assert transmission.joint_from_motor(matched).shape == (6, 6)
    for index in range(2):
        assert mass_table(matched.take(index)).thigh == pytest.approx(
            mass_table(ablate(batch.take(index), "toe_removed_matched")).thigh, abs=1e-12
        )


def test_an_ablation_says_so(hyperleg):
    bare = ablate(hyperleg, "toe_removed")
    assert bare.origins["toe.mass"].label == "derived"
    assert ablate(bare, "toe_removed") is bare
    with pytest.raises(InputError, match="no active toe"):
        ablate(bare, "toe")
    with pytest.raises(InputError, match=r"no_toe.*toe_removed"):
        ablate(hyperleg, "no_toe")
