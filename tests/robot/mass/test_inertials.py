from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.errors import InputError
from hyperleg_design.robot.laws.gear import gear_change
from hyperleg_design.robot.mass.inertials import LEG_LINKS, inertials
from hyperleg_design.robot.masses import mass_table


def cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def about(inertial, point: np.ndarray) -> np.ndarray:
    """Inertia about a point, by the parallel-axis theorem with cross-product matrices."""
    arm = cross(inertial.com - point)
    return inertial.inertia - inertial.mass * arm @ arm


@given(st.data())
@settings(max_examples=25)
def test_every_link_is_a_body(random_designs, data):
    design = data.draw(random_designs)
    for name, inertial in inertials(design).items():
        assert inertial.mass >= 0
        if inertial.mass == 0:
            assert name == "toe_plate"
            assert design.toe.joint == "locked"
            continue
        principal = np.linalg.eigvalsh(inertial.inertia)
        assert principal[0] > 0, name
        assert principal[2] <= (principal[0] + principal[1]) * (1 + 1e-12), name
        np.testing.assert_array_equal(inertial.inertia, inertial.inertia.T)


@given(st.data())
@settings(max_examples=25)
def test_links_add_up_to_the_mass_table(random_designs, data):
    design = data.draw(random_designs)
    found, table = inertials(design), mass_table(design)
    assert sum(found[name].mass for name in LEG_LINKS) == pytest.approx(table.leg, rel=1e-14)
    assert found["pelvis"].mass == pytest.approx(table.pelvis, rel=1e-14)
    carriers = found["hip_yaw_carrier"].mass + found["hip_roll_carrier"].mass
    assert found["thigh"].mass + carriers == pytest.approx(table.thigh, rel=1e-14)
    assert found["foot"].mass + found["ankle_cross"].mass == pytest.approx(table.foot, rel=1e-14)


@given(st.data())
@settings(max_examples=15)
def test_the_right_leg_mirrors_the_left(random_designs, data):
    design = data.draw(random_designs)
    left, right = inertials(design, 1.0), inertials(design, -1.0)
    mirror = np.diag([1.0, -1.0, 1.0])
    for name in LEG_LINKS:
        np.testing.assert_array_equal(right[name].com, mirror @ left[name].com)
        np.testing.assert_allclose(
            right[name].inertia, mirror @ left[name].inertia @ mirror, atol=1e-17
        )


def test_declared_values_stand_in_the_reference_build(hyperleg):
    thigh = inertials(hyperleg)["thigh"]
    np.testing.assert_allclose(thigh.com, [0, 0.010, -0.36 * 0.37], atol=1e-15)
    np.testing.assert_allclose(
        np.diag(thigh.inertia), 4.91 * (np.array([0.28, 0.285, 0.14]) * 0.37) ** 2, rtol=1e-12
    )


def test_another_motor_is_a_point_at_its_place(hyperleg):
    """The new thigh is the old one, a point of the difference in mass at the motor, and a point of
    the larger stage at the knee: first and second moments add.
    """
    old, new = (
        inertials(d)["thigh"]
        for d in (hyperleg, hyperleg.with_values({"actuators.knee.motor": "RI80"}))
    )
    heavier = hyperleg.with_values({"actuators.knee.motor": "RI80"})
    stage = gear_change(heavier).stage_mass["knee"]
    points = (
        (new.mass - old.mass - stage, np.array([0, 0, -0.30 * 0.37])),
        (stage, np.array([0, 0, -0.37])),
    )
    assert all(mass > 0.02 for mass, _ in points)
    first = old.mass * old.com + sum(mass * place for mass, place in points)
    np.testing.assert_allclose(new.mass * new.com, first, atol=1e-14)
    zero = np.zeros(3)
    second = about(old, zero) - sum(mass * cross(p) @ cross(p) for mass, p in points)
    np.testing.assert_allclose(about(new, zero), second, atol=1e-14)


@pytest.mark.parametrize("fraction", [0.0, 0.9])
def test_a_motor_moved_within_the_thigh_moves_the_centre_of_mass(hyperleg, fraction):
    old, new = (
        inertials(d)["thigh"]
        for d in (hyperleg, hyperleg.with_values({"actuators.ankle.position_fraction": fraction}))
    )
    both = 2 * (0.1559 + 0.01 * 7 * 1.63)
    assert new.mass == pytest.approx(old.mass, rel=1e-14)
    assert new.mass * new.com[2] == pytest.approx(
        old.mass * old.com[2] - both * (fraction - 0.5) * 0.37, abs=1e-12
    )


def test_a_motor_moved_to_the_shank_makes_the_leg_harder_to_swing(hyperleg):
    moved = hyperleg.with_values(
        {"actuators.ankle.housed_in": "shank", "actuators.ankle.position_fraction": 0.5}
    )
    old, new = inertials(hyperleg)["shank"], inertials(moved)["shank"]
    assert new.mass == pytest.approx(old.mass + 2 * (0.1559 + 0.01 * 7 * 1.63), rel=1e-12)
    assert about(new, np.zeros(3))[1, 1] > about(old, np.zeros(3))[1, 1]


def test_pelvis_motors_sit_at_both_hips(hyperleg):
    lighter = hyperleg.with_values({"actuators.hip_yaw.motor": "U8"})
    old, new = inertials(hyperleg)["pelvis"], inertials(lighter)["pelvis"]
    assert new.mass < old.mass
    np.testing.assert_allclose(new.com[:2], 0, atol=1e-15)
    assert new.com[2] > old.com[2]  # mass at the hips, below, went


def test_a_batch_is_its_designs(hyperleg):
    batch = hyperleg.with_values(
        {
            "thigh.length": np.linspace(0.3, 0.4, 4),
            "actuators.knee.motor": np.array(["RI70", "RI80", "RI70", "RI60"]),
            "foot.com": np.linspace(-0.01, 0.01, 12).reshape(4, 3),
            "actuators.ankle.position_fraction": np.array([0.5, 0.2, 0.5, 0.8]),
        }
    )
    many = inertials(batch)
    for index in range(4):
        for name, one in inertials(batch.take(index)).items():
            for field in ("mass", "com", "inertia"):
                value = getattr(one, field)
                taken = np.broadcast_to(getattr(many[name], field), (4, *value.shape))[index]
                np.testing.assert_allclose(taken, value, rtol=1e-12, atol=1e-15)


def test_an_inertia_that_no_body_has_is_refused(hyperleg):
    slim = hyperleg.with_values(
        {"thigh.gyration_fraction": [0.03, 0.03, 0.03], "actuators.hip_pitch.motor": "U8"}
    )
    with pytest.raises(InputError, match=r"thigh\.gyration_fraction.*too small"):
        inertials(slim)
