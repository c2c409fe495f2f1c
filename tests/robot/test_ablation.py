from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import transmission
from hyperleg_design.robot.ablation import DESCRIPTION, ablate, confound, variants
from hyperleg_design.robot.masses import actuator_mass, mass_table
from hyperleg_design.robot.motors import catalogue
from hyperleg_design.robot.names import VARIANTS


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
    assert {found[name]["removes"] for name in VARIANTS} == set(DESCRIPTION.values())


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
