from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot import masses
from hyperleg_design.robot.load import load_robot
from hyperleg_design.robot.masses import actuator_mass, mass_law, mass_table
from hyperleg_design.robot.models import rigid_body_model
from hyperleg_design.robot.motors import catalogue, find_motor


def test_the_papers_masses_come_out_exactly(hyperleg):
    table = mass_table(hyperleg)
    assert table.total == pytest.approx(32.0, abs=1e-12)
    assert table.leg == pytest.approx(8.27, abs=1e-12)
    assert [table.pelvis, table.thigh, table.shank, table.foot, table.toe] == pytest.approx(
        [15.46, 5.71, 1.68, 0.66, 0.22], abs=1e-12
    )
    assert all(h.change == 0 for h in table.housed)


def test_a_toe_of_300_g(hyperleg):
    assert mass_table(hyperleg.with_values({"toe.mass": 0.3})).total == pytest.approx(
        32.16, abs=1e-12
    )


@given(motor=st.sampled_from(sorted(catalogue())), gear=st.floats(4, 12))
@settings(max_examples=30)
def test_a_heavier_motor_makes_a_heavier_thigh_by_the_difference(hyperleg, motor, gear):
    values = {"actuators.knee.motor": motor, "actuators.knee.gear": gear}
    table = mass_table(hyperleg.with_values({**values, "gears.law": "declared"}))
    rate = hyperleg.masses.gear_mass_per_torque
    new, old = find_motor(motor), find_motor("RI70")
    difference = (
        new.mass + rate * gear * new.peak_torque() - old.mass - rate * 7 * old.peak_torque()
    )
    assert table.thigh == pytest.approx(5.71 + difference, abs=1e-12)
    assert table.total == pytest.approx(32.0 + 2 * difference, abs=1e-12)
    assert (table.shank, table.foot, table.toe) == (1.68, 0.66, 0.22)


def test_there_are_two_ankle_motors_and_four_in_the_pelvis(hyperleg):
    difference = find_motor("RI70").mass - find_motor("RI60").mass + 0.01 * 7 * (2.68 - 1.63)
    assert mass_table(
        hyperleg.with_values({"actuators.ankle.motor": "RI70", "gears.law": "declared"})
    ).thigh == pytest.approx(5.71 + 2 * difference, abs=1e-12)
    lighter = actuator_mass("U8", 25.0, 0.01) - actuator_mass("U10", 25.0, 0.01)
    table = mass_table(
        hyperleg.with_values({"actuators.hip_yaw.motor": "U8", "actuators.hip_roll.motor": "U8"})
    )
    assert table.pelvis == pytest.approx(15.46 + 4 * lighter, abs=1e-12)
    assert table.thigh == pytest.approx(5.71, abs=1e-12)


def test_a_motor_housed_elsewhere_takes_its_mass_along(hyperleg):
    moved = actuator_mass("RI60", 7.0, 0.01)
    table = mass_table(hyperleg.with_values({"actuators.toe.housed_in": "shank"}))
    assert (table.thigh, table.shank) == (
        pytest.approx(5.71 - moved, abs=1e-12),
        pytest.approx(1.68 + moved, abs=1e-12),
    )
    table = mass_table(hyperleg.with_values({"actuators.ankle.housed_in": "pelvis"}))
    assert (table.thigh, table.pelvis) == (
        pytest.approx(5.71 - 2 * moved, abs=1e-12),
        pytest.approx(15.46 + 4 * moved, abs=1e-12),
    )
    assert table.total == pytest.approx(32.0, abs=1e-12)


def test_structure_grows_with_length_and_actuators_do_not(hyperleg):
    table = mass_table(
        hyperleg.with_values({"thigh.length": 0.37 * 1.1, "shank.length": 0.345 * 1.2})
    )
    housed = (
        actuator_mass("U10", 25.0, 0.01)
        + actuator_mass("RI70", 7.0, 0.01)
        + 3 * actuator_mass("RI60", 7.0, 0.01)
    )
    assert table.thigh == pytest.approx((5.71 - housed) * 1.1 + housed, abs=1e-12)
    assert table.shank == pytest.approx(1.68 * 1.2, abs=1e-12)
    assert table.structure["thigh"] == pytest.approx((5.71 - housed) * 1.1, abs=1e-12)


def test_a_batch_is_its_designs(hyperleg):
    batch = hyperleg.with_values(
        {
            "toe.mass": np.array([0.2, 0.3, 0.4]),
            "actuators.knee.motor": np.array(["RI70", "RI80", "U8"]),
            "thigh.length": np.array([0.37, 0.4, 0.3]),
            "actuators.toe.position_fraction": np.array([0.7, 0.1, 0.2]),
        }
    )
    table = mass_table(batch)
    for index in range(3):
        one = mass_table(batch.take(index))
        for name in ("pelvis", "thigh", "shank", "foot", "toe", "leg", "total"):
            assert np.broadcast_to(getattr(table, name), 3)[index] == pytest.approx(
                getattr(one, name), rel=1e-15
            )


def test_the_fixed_law_takes_the_declared_masses(hyperleg):
    fixed = hyperleg.with_values(
        {"masses.law": "fixed", "actuators.knee.motor": "RI100", "thigh.length": 0.45}
    )
    assert mass_table(fixed).total == pytest.approx(32.0, abs=1e-12)


@pytest.fixture
def halving():
    @mass_law("halving")
    def law(design):
        table = masses.components(design)
        return dataclasses.replace(table, pelvis=table.pelvis / 2)

    yield law
    del masses._LAWS.by_name["halving"]


@pytest.mark.usefixtures("halving")
def test_a_law_of_ones_own(hyperleg):
    assert mass_table(hyperleg.with_values({"masses.law": "halving"})).total == pytest.approx(
        32.0 - 15.46 / 2, abs=1e-12
    )


def test_a_law_that_nobody_registered(hyperleg):
    with pytest.raises(InputError, match=r"masses\.law = 'halving'.*components, fixed"):
        hyperleg.with_values({"masses.law": "halving"})


def test_segments_weigh_more_than_what_they_house(hyperleg):
    with pytest.raises(InputError, match=r"thigh\.mass = 2\.9.*reference build"):
        hyperleg.with_values({"thigh.mass": 2.9})
    with pytest.raises(InputError, match=r"pelvis\.mass = 15\.46.*gear_mass_per_torque"):
        hyperleg.with_values({"masses.gear_mass_per_torque": 0.05})


def test_a_tree_has_masses_by_link():
    design = load_robot("mini_cheetah")
    table = mass_table(design)
    assert list(table.links) == list(design.link_sections)
    weighed = sum(float(body.mass) for name, body in table.links.items() if name != "trunk")
    assert table.limb == pytest.approx(weighed)
    assert table.total == pytest.approx(rigid_body_model(design).tree.mass)
