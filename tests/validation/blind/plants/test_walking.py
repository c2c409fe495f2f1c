from dataclasses import replace

import mujoco
import numpy as np
import pytest

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.mjcf import mujoco_spec
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


def mass_matrix_of(model, data, bodies):
    """Sum over bodies of m Jp' Jp + Jr' R I R' Jr, from names, masses, centres and inertias."""
    total = np.zeros((model.nv, model.nv))
    at, turn = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    for name, mass, com, inertia in bodies:
        body = model.body(name).id
        rotation = data.xmat[body].reshape(3, 3)
        mujoco.mj_jac(model, data, at, turn, data.xpos[body] + rotation @ com, body)
        total += mass * at.T @ at + turn.T @ rotation @ inertia @ rotation.T @ turn
    return total


def test_links_have_the_masses_centres_and_inertias_they_were_given(robot):
    """Also those whose centre and axes the compiler took for those of the body itself."""
    rng = np.random.default_rng(3)
    masses = robot
    for link in robot.links:
        shear = 0.02 * rng.normal(size=(3, 3))
        masses = masses.with_link(
            link.name,
            mass=1.3 * link.mass,
            com=link.com + 0.01 * rng.normal(size=3),
            inertia=link.inertia + link.mass * shear @ shear.T,
        )
    model = walking_model(robot, masses, Ground(1.0, *NOMINAL_GROUND), 1.07, GRAVITY)
    nominal = mujoco_spec(load_design("hyperleg"), friction=False).compile()
    pelvis = nominal.body("pelvis").id
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, nominal.body_iquat[pelvis])
    turned = axes.reshape(3, 3)
    inertia = turned @ np.diag(nominal.body_inertia[pelvis]) @ turned.T
    bodies = [(link.name, link.mass, link.com, link.inertia) for link in masses.links]
    mass, com = nominal.body_mass[pelvis], nominal.body_ipos[pelvis]
    bodies.append(("pelvis", 1.07 * mass, com, 1.07 * inertia))
    data = mujoco.MjData(model)
    data.qpos[7:] = 0.3 * rng.normal(size=model.nq - 7)
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    np.testing.assert_allclose(full, mass_matrix_of(model, data, bodies), rtol=1e-6, atol=1e-7)
    assert model.body_subtreemass[0] == pytest.approx(model.body_mass.sum())
