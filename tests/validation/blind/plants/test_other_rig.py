from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.validation.blind.excitation import motion
from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.other_rig import simulate_other
from hyperleg_design.validation.blind.plants.rig import simulate
from hyperleg_design.validation.blind.plants.rig_build import build_rig
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.wrong import Wrong


@pytest.mark.parametrize("name", ["arm", "servo"])
def test_both_plants_move_alike_where_they_should(name):
    """Smooth motion, no friction, stiff transmissions: two integrators, drives and controllers of
    the same physics.
    """
    robot = replace(chain(name), coulomb=0 * chain(name).coulomb)
    targets = motion("multisine", robot, 1.5, 200.0, np.random.default_rng(0))[None]
    plant = build_rig(robot, perfect(robot))
    first, second = (
        simulate([plant], targets, 200.0, seeds=[0])[0],
        simulate_other([plant], targets, 200.0, seeds=[0])[0],
    )
    assert (
        np.abs(first.position - second.position).max() < 0.06 * np.ptp(first.position, axis=0).max()
    )


def test_a_gear_sticks_until_its_breakaway():
    robot = chain("servo")
    held = np.tile(robot.rest, (1, 100, 1))
    plant = build_rig(robot, perfect(robot), [Wrong("coulomb_friction", "swing", 0.25, {})])
    trace = simulate_other([plant], held, 200.0, seeds=[0])[0]
    assert np.all(trace.motor_velocity[-200:] == 0.0)


def test_encoders_sit_on_the_rotors():
    robot = chain("servo")
    targets = motion("multisine", robot, 1.0, 200.0, np.random.default_rng(1))[None]
    soft = build_rig(robot, perfect(robot), [Wrong("transmission_elasticity", "swing", 300.0, {})])
    stiff = simulate_other([build_rig(robot, perfect(robot))], targets, 200.0, seeds=[0])[0]
    bent = simulate_other([soft], targets, 200.0, seeds=[0])[0]
    assert np.abs(stiff.encoder - stiff.position).max() < 2e-3
    assert np.abs(bent.encoder - bent.position).max() > 6e-3
