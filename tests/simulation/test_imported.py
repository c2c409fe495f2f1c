"""Robots that others described, made designs by import: they have the dynamics that Pinocchio reads
from the file, and stand.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest
import yaml

from hyperleg_design.robot.importing import import_robot
from hyperleg_design.robot.laws.gear import rotor_inertia
from hyperleg_design.robot.transmission import joint_from_motor, reflected_inertia
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.model import simulation_model
from hyperleg_design.simulation.tasks import load_task
from hyperleg_design.simulation.terms.mirror import mirror_joints
from hyperleg_design.sizing.other_robots import robots_folder


def joint(stiffness: float, damping: float, angle: float = 0.0) -> dict[str, float]:
    return {"stiffness": stiffness, "damping": damping, "default_deg": angle}


ROBOTS = {
    "a1": (
        "a1_description/urdf/a1.urdf",
        {
            "actuators": {"*": {"motor": "GL80", "gear": 9}},
            "joints": {
                "*_hip_joint": joint(100, 3),
                "*_thigh_joint": joint(100, 3, 45),
                "*_calf_joint": joint(100, 3, -90),
            },
            "pads": {"*_foot": {}},
        },
    ),
    "anymal": (
        "anymal_b_simple_description/robots/anymal.urdf",
        {
            "actuators": {"*": {"motor": "RI80", "gear": 25}},
            "joints": {
                "*_HAA": joint(200, 5),
                "?F_HFE": joint(200, 5, 40),
                "?H_HFE": joint(200, 5, -40),
                "?F_KFE": joint(200, 5, -80),
                "?H_KFE": joint(200, 5, 80),
            },
            "pads": {"*_FOOT": {}},
        },
    ),
    "g1": (
        "g1_description/urdf/g1_29dof_rev_1_0.urdf",
        {
            "actuators": {"*": {"motor": "RI70", "gear": 18}},
            "joints": {
                "*": joint(40, 1),
                "*_hip_*": joint(300, 5),
                "*_hip_pitch_joint": joint(300, 5, -18),
                "*_knee_joint": joint(300, 5, 35),
                "*_ankle_roll_joint": joint(200, 2),
                "*_ankle_pitch_joint": joint(200, 2, -17),
                "waist_*": joint(300, 5),
            },
            "pads": {"*_ankle_roll_link": {}},
        },
    ),
}


@pytest.fixture(scope="module", params=ROBOTS)
def imported(request, tmp_path_factory):
    file, data = ROBOTS[request.param]
    path = tmp_path_factory.mktemp("import") / "motors.yaml"
    path.write_text(yaml.safe_dump(data))
    return robots_folder() / file, import_robot(robots_folder() / file, path)[0]


def test_mass_matrix_and_gravity_are_pinocchios(imported: tuple[Path, object]) -> None:
    """In a random posture; the rotors, which the file does not have, are added by hand."""
    file, design = imported
    model, layout = simulation_model(design), layout_of(design)
    theirs = pinocchio.buildModelFromUrdf(str(file), pinocchio.JointModelFreeFlyer())
    if "floating_base_joint" in theirs.names:
        theirs = pinocchio.buildModelFromUrdf(str(file))
    joints = [theirs.joints[theirs.getJointId(name)] for name in layout.joints]
    rng = np.random.default_rng(0)
    angles = layout.default + rng.uniform(-0.3, 0.3, len(layout.joints))
    data, q = mujoco.MjData(model), pinocchio.neutral(theirs)
    data.qpos[3:7], data.qpos[7:] = (1, 0, 0, 0), angles
    q[[j.idx_q for j in joints]] = angles
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    there = theirs.createData()
    own = np.array([*range(6), *(j.idx_v for j in joints)])
    rigid = np.triu(pinocchio.crba(theirs, there, q))
    rigid = (rigid + np.triu(rigid, 1).T)[np.ix_(own, own)]
    rotors = reflected_inertia(joint_from_motor(design), rotor_inertia(design))
    rigid[6:, 6:] += rotors
    # anymal's root is a placeholder of 3e-6 kg m^2 about one axis, which import makes a ball
    np.testing.assert_allclose(mass, rigid, atol=4e-6 if design.name == "anymal" else 1e-8)
    gravity = pinocchio.computeGeneralizedGravity(theirs, there, q)
    np.testing.assert_allclose(data.qfrc_bias, gravity[own], atol=1e-6)
    assert model.body_mass.sum() == pytest.approx(pinocchio.computeTotalMass(theirs))


def test_it_stands_for_two_seconds_and_has_a_mirror(imported: tuple[Path, object]) -> None:
    task = load_task("walk_any")
    fine = dataclasses.replace(task.physics, time_step=0.0025, substeps=8)
    _, design = imported
    environment = Environment(design, task.changed(physics=fine), simulations=1, threads=1)
    environment.reset()
    for _ in range(100):
        step = environment.step(np.zeros((1, environment.action_size)))
        assert not step.ending.any()
    mirrored = mirror_joints(environment.layout)
    assert sorted(mirrored.index) == list(range(environment.action_size))
    np.testing.assert_array_equal(mirrored.index[mirrored.index], np.arange(len(mirrored.index)))
    load = environment.chunks[0].sensors[-1, 0, ::6][: len(environment.layout.pads)].sum()
    assert load == pytest.approx(environment.layout.weight, rel=0.15)
