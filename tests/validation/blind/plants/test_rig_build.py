"""From what is wrong to the plant: each effect changes what it means and nothing else."""

from __future__ import annotations

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from hyperleg_design.validation.blind.plants.nuisance import of_robot, perfect
from hyperleg_design.validation.blind.plants.rig_build import Reach, build_rig, tilted
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.wrong import CATALOGUE, ODDITIES, WALKING_ONLY, Wrong
from tests.validation.blind.shapes import SHAPES

PLACES = {"voltage_sag": "battery", "command_delay": "robot", "packet_loss": "robot"}
CHANGED = {
    "coulomb_friction": {"coulomb", "static"},
    "viscous_friction": {"viscous"},
    "stribeck_friction": {"static", "stribeck_speed"},
    "load_dependent_friction": {"load_friction"},
    "torque_constant": {"torque_scale"},
    "torque_saturation": {"peak_torque"},
    "thermal_derating": {"start_temperature", "derating"},
    "voltage_sag": {"supply"},
    "command_delay": {"delay"},
    "actuator_bandwidth": {"lag"},
    "rotor_inertia": {"rotor_inertia"},
    "transmission_elasticity": {"belt_stiffness", "belt_damping"},
    "backlash": {"backlash"},
    "transmission_ratio": {"joint_from_motor"},
    "encoder_offset": {"offset"},
    "controller_gain": {"stiffness", "damping"},
    "cogging": {"cogging", "cogging_order", "cogging_phase"},
    "joint_spring": {"spring", "spring_rest"},
    "torque_ripple": {"ripple"},
    "friction_patch": {"patch", "patch_middle"},
    "hysteresis": {"hysteresis"},
    "packet_loss": {"loss"},
    "periodic_push": {"push", "push_frequency"},
    "hardening_spring": {"hardening"},
    "cross_coupling": {"coupling"},
    "sensor_drift": {"drift"},
    "fluid_drag": {"drag"},
    "encoder_eccentricity": {"eccentricity"},
    "payload": set(),
    "link_mass": set(),
    "link_com": set(),
    "tilted_gravity": set(),
}
"""Fields of the plant that each effect changes; none where it is the rigid bodies that change."""


@pytest.fixture(scope="module")
def arm():
    return chain("arm")


@pytest.fixture(scope="module")
def leg():
    """Coupled: several motors at a joint."""
    return chain("leg")


def wrong_of(effect, robot, size=0.1):
    link = robot.links[-1]
    place = link.name if effect in ("payload", "link_mass", "link_com") else link.joint
    return Wrong(effect, PLACES.get(effect, place), size, SHAPES.get(effect, {}))


def fields(plant):
    return {f.name: getattr(plant, f.name) for f in dataclasses.fields(plant) if f.name != "model"}


def test_every_effect_of_a_rig_is_here():
    assert set(CHANGED) == {*CATALOGUE, *ODDITIES} - set(WALKING_ONLY)


@pytest.mark.parametrize("effect", CHANGED)
def test_an_effect_changes_its_own_fields_alone(effect, arm):
    day = of_robot(arm, np.random.default_rng(0))
    m, n = len(arm.motors), len(arm.joints)
    reach = Reach(0.5 * arm.peak_torque, np.ones(m))
    healthy = fields(build_rig(arm, day))
    changed = fields(build_rig(arm, day, [wrong_of(effect, arm)], reach))
    differing = {k for k in healthy if not np.array_equal(healthy[k], changed[k])}
    assert differing == CHANGED[effect]
    for key in differing:
        before, after = np.broadcast_arrays(healthy[key], changed[key])
        where = np.argwhere(np.atleast_1d(before != after))
        if effect not in PLACES and before.ndim == 1:
            assert where.ravel().tolist() in ([n - 1], [m + n - 1])  # of the last joint alone


@pytest.mark.parametrize("effect", [e for e, names in CHANGED.items() if not names])
def test_effects_of_the_bodies_change_what_gravity_asks_for(effect, arm):
    def held(plant):
        zero = np.zeros(len(arm.joints))
        return pin.rnea(plant.model, plant.model.createData(), arm.rest, zero, zero)

    healthy = held(build_rig(arm, perfect(arm)))
    changed = held(build_rig(arm, perfect(arm), [wrong_of(effect, arm)]))
    assert np.abs(changed - healthy).max() > 1e-3


def test_a_healthy_perfect_plant_is_the_data_sheets(arm):
    plant = build_rig(arm, perfect(arm))
    m = len(arm.motors)
    np.testing.assert_array_equal(plant.joint_from_motor, arm.joint_from_motor)
    np.testing.assert_array_equal(plant.coulomb[m:], arm.coulomb)
    np.testing.assert_array_equal(plant.static, plant.coulomb)
    assert not np.any(plant.coulomb[:m])
    # a rotor on its belt, the joint held, rings at the frequency that is asked for
    frequency = np.sqrt(plant.belt_stiffness / plant.rotor_inertia) / (2 * np.pi)
    np.testing.assert_allclose(frequency, 120.0)


def test_sizes_are_shares_of_what_they_name(arm):
    peak = np.abs(arm.joint_from_motor) @ arm.peak_torque
    day = perfect(arm)
    healthy = build_rig(arm, day)
    friction = build_rig(arm, day, [wrong_of("coulomb_friction", arm)])
    assert (friction.coulomb - healthy.coulomb)[-1] == pytest.approx(0.1 * peak[-1])
    constant = build_rig(arm, day, [wrong_of("torque_constant", arm)])
    assert constant.torque_scale[-1] == pytest.approx(0.9)
    elastic = build_rig(arm, day, [wrong_of("transmission_elasticity", arm, 4.0)])
    assert healthy.belt_stiffness[-1] / elastic.belt_stiffness[-1] == pytest.approx(4.0)

    def ratio(plant):
        root = np.sqrt(plant.belt_stiffness * plant.rotor_inertia)
        return plant.belt_damping / (2 * root)

    np.testing.assert_allclose(ratio(elastic), ratio(healthy))  # as damped as before


def test_a_limit_is_never_above_the_data_sheets(arm):
    m = len(arm.motors)
    far = Reach(100 * arm.peak_torque, np.ones(m))
    wrong = wrong_of("torque_saturation", arm)
    np.testing.assert_array_equal(
        build_rig(arm, perfect(arm), [wrong], far).peak_torque, arm.peak_torque
    )


def test_friction_at_a_motor_of_coupled_ones_is_the_rotors(leg):
    row = leg.motors.index("left_ankle_right")  # there is no joint of this name
    day = perfect(leg)
    plant = build_rig(leg, day, [Wrong("coulomb_friction", leg.motors[row], 0.1, {})])
    added = plant.coulomb - build_rig(leg, day).coulomb
    assert np.flatnonzero(added).tolist() == [row]
    assert added[row] == pytest.approx(0.1 * leg.peak_torque[row])


def test_gravity_keeps_its_size_when_a_rig_leans():
    for angle in (0.0, 0.1, 0.35):
        for heading in (0.0, 1.0, 4.0):
            gravity = tilted(angle, heading)
            assert np.linalg.norm(gravity) == pytest.approx(9.81)
            assert np.arccos(-gravity[2] / 9.81) == pytest.approx(angle, abs=1e-7)
    assert tilted(0.2, np.pi / 2)[0] == pytest.approx(0.0, abs=1e-12)
