"""What `RigPlant` and `Trace` state of their fields is so in every rig that is built and run."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.plant import RigPlant
from hyperleg_design.validation.blind.plants.rig import simulate
from hyperleg_design.validation.blind.plants.rig_build import build_rig
from hyperleg_design.validation.blind.robots.catalogue import chain

JOINTS = {
    *("spring", "spring_rest", "stiffness", "damping", "offset", "resolution", "patch"),
    *("patch_middle", "hysteresis", "push", "hardening", "drift", "drag", "eccentricity", "rest"),
}
COORDINATES = {"coulomb", "static", "stribeck_speed", "viscous", "bristle", "load_friction"}
OTHERS = {"joint_from_motor": "nm", "declared": "nm", "coupling": "nn"}


def build(name):
    robot = chain(name)
    return robot, build_rig(robot, perfect(robot))


@pytest.mark.parametrize("name", ["arm", "leg"])
def test_arrays_have_a_place_for_each_motor_joint_or_coordinate(name):
    robot, plant = build(name)
    n, m = plant.joint_from_motor.shape
    sizes = {"n": n, "m": m}
    assert n == len(robot.rest)
    for field in dataclasses.fields(RigPlant):
        value = getattr(plant, field.name)
        if not isinstance(value, np.ndarray):
            continue
        shape = tuple(sizes[letter] for letter in OTHERS.get(field.name, "m"))
        if field.name in JOINTS:
            shape = (n,)
        elif field.name in COORDINATES:
            shape = (m + n,)
        assert value.shape == shape, field.name


@pytest.mark.parametrize("name", ["arm", "leg"])
def test_a_plant_without_fault_has_the_declared_matrix_and_nothing_outside_the_catalogue(name):
    _, plant = build(name)
    assert np.array_equal(plant.joint_from_motor, plant.declared)
    for oddity in ("ripple", "patch", "hysteresis", "push", "hardening", "coupling", "drift"):
        assert not np.any(getattr(plant, oddity)), oddity
    assert plant.loss == 0
    assert np.all(plant.static >= plant.coulomb)
    assert np.all(plant.peak_torque <= plant.stall_torque)


def test_a_trace_has_a_row_a_tick_and_energy_only_on_request():
    robot, plant = build("leg")
    target = np.tile(robot.rest, (1, 20, 1))
    for energy in (False, True):
        trace = simulate([plant], target, 200.0, seeds=[0], energy=energy)[0]
        assert np.allclose(np.diff(trace.time), 1e-3)
        for field in dataclasses.fields(trace):
            assert len(getattr(trace, field.name)) == len(trace.time), field.name
        assert np.isfinite(trace.energy).all() == energy
