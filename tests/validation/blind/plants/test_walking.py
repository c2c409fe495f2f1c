from dataclasses import replace

import numpy as np
import pytest

from hyperleg_design.validation.blind.plants.nuisance import perfect
from hyperleg_design.validation.blind.plants.rig_build import build_rig
from hyperleg_design.validation.blind.plants.stand import Stand
from hyperleg_design.validation.blind.plants.walking import (
    Ground,
    WalkingPlant,
    simulate_walking,
    walking_model,
)
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.robots.chain import GRAVITY
from hyperleg_design.validation.blind.walker import NOMINAL_GROUND

STILL = Stand(0.0, 0.0, 0.0, 0.0, np.ones(5))
MOVING = Stand(0.22, 0.04, 0.04, 0.008, np.array([0.6, 0.4, 0.7, 0.5, 0.4]), spread=0.1, turn=0.1)


@pytest.fixture(scope="module")
def robot():
    return chain("hyperleg")


def plant(robot, **changes):
    model = walking_model(robot, robot, Ground(1.0, *NOMINAL_GROUND), 1.0, GRAVITY)
    return replace(
        WalkingPlant(
            model, build_rig(robot, perfect(robot)), np.zeros(3), np.zeros(3), np.zeros(3)
        ),
        **changes,
    )


def test_a_robot_that_stands_weighs_what_it_weighs(robot):
    made = plant(robot)
    trace = simulate_walking(made, robot, STILL, 1.0, 200.0, 0)
    assert not trace.fell
    weight = made.model.body_mass.sum() * 9.81
    np.testing.assert_allclose(trace.contact[500:, :, 2].sum(1).mean(), weight, rtol=0.005)
    assert np.linalg.norm(trace.accelerometer[500:].mean(0)) == pytest.approx(9.81, rel=0.005)
