"""Inertia of rotors and tendons in models that are put together, against MuJoCo's mass matrix."""

from __future__ import annotations

import copy

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from hyperleg_design.gap.model.assembling import add_rotors, add_tendon
from hyperleg_design.gap.model.tendons import Tendon
from hyperleg_design.gap.signals.loading import load_subject

JOINTS = ("first", "second", "third")
CHAIN = """<mujoco><worldbody><body><joint name="first" axis="0 1 0"/><geom size="0.05" mass="1"/>
<body pos="0 0 -0.3"><joint name="second" axis="0 1 0"/><geom size="0.05" mass="0.5"/>
<body pos="0 0.1 -0.3"><joint name="third" axis="1 0 0"/><geom size="0.04" mass="0.2"
pos="0 0 -0.1"/></body></body></body></worldbody></mujoco>"""
ROBOTS = ("hyperleg", "arm", "coupled", "heavy_hip", "pendulum")
COEFFICIENT = st.floats(-30, 30).filter(lambda x: x == 0 or abs(x) > 1e-3)


@pytest.fixture(scope="module", params=ROBOTS)
def subject(request, robot_files, tmp_path_factory):
    if request.param == "heavy_hip":  # armature of a joint beside the rotors of coupled motors
        path = tmp_path_factory.mktemp("robot") / "heavy_hip.xml"
        text = robot_files["coupled"].read_text()
        path.write_text(text.replace('name="hip"', 'name="hip" armature="0.04"'))
        return load_subject(path)
    return load_subject(robot_files.get(request.param, request.param))


def mass_matrix(model: mujoco.MjModel, seed: int = 0) -> np.ndarray:
    """At a random posture."""
    data = mujoco.MjData(model)
    hinges = model.jnt_qposadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
    data.qpos[hinges] = np.random.default_rng(seed).uniform(-1, 1, len(hinges))
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def added(spec: mujoco.MjSpec) -> np.ndarray:
    """What the tendons of a specification add to the mass matrix of the chain."""
    return mass_matrix(spec.compile()) - mass_matrix(mujoco.MjModel.from_xml_string(CHAIN))


@settings(max_examples=20)
@given(
    arrays(float, (3, 2), elements=COEFFICIENT),
    arrays(float, 2, elements=st.floats(1e-6, 0.1)),
)
def test_rotors_add_their_reflected_inertia(matrix, rotor):
    matrix[0, 0] = matrix[0, 0] or 1.0
    matrix[1, 1] = matrix[1, 1] or 1.0
    spec = mujoco.MjSpec.from_string(CHAIN)
    add_rotors(spec, JOINTS, ("m", "n"), matrix, rotor)
    # kinetic energy of a rotor of speed M' q_dot
    expected = sum(
        inertia * np.outer(column, column) for column, inertia in zip(matrix.T, rotor, strict=True)
    )
    np.testing.assert_allclose(added(spec), expected, atol=1e-9 * max(np.abs(expected).max(), 1))


def test_a_tendon_adds_its_armature_where_its_speed_is():
    coefficients = np.array([1.5, 0.0, -0.7])
    spec = mujoco.MjSpec.from_string(CHAIN)
    add_tendon(
        spec,
        "coupling",
        JOINTS,
        Tendon(0, "coupling", coefficients, 0.02, 0.0, 0.0, 0.0, (0.0, 0.0)),
    )
    model = spec.compile()
    assert model.tendon_num[0] == 2
    np.testing.assert_allclose(added(spec), 0.02 * np.outer(coefficients, coefficients), atol=1e-12)


def test_armature_of_a_subject_is_what_its_model_adds_to_rigid_bodies(subject):
    count, model = len(subject.joints), copy.copy(subject.model)
    with_rotors = mass_matrix(model)
    model.dof_armature[:], model.tendon_armature[:] = 0.0, 0.0
    found = (with_rotors - mass_matrix(model))[-count:, -count:]
    np.testing.assert_allclose(found, subject.armature, atol=1e-9 * np.abs(found).max())


def test_friction_is_the_subjects_alone_and_no_array_can_be_written(subject):
    first = subject.model.nv - len(subject.joints)
    assert not subject.model.dof_frictionloss[first:].any()
    assert not subject.model.dof_damping[first:].any()
    held = [value for value in vars(subject).values() if isinstance(value, np.ndarray)]
    assert len(held) > 10
    for value in held:
        assert not value.flags.writeable


def test_inertia_of_a_subject_is_positive(subject):
    np.testing.assert_allclose(subject.armature, subject.armature.T, atol=1e-15)
    assert np.linalg.eigvalsh(subject.armature).min() >= -1e-12
    assert (subject.position_low < subject.position_high).all()
    with pytest.raises(ValueError, match="read-only"):
        subject.armature[0, 0] = 1.0
