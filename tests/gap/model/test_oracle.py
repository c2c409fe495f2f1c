"""The check of a robot that was read against MuJoCo, itself checked by a closed form."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import robots

from hyperleg_design.gap.model.oracle import TOLERANCE, disagreements, mujoco_torques
from hyperleg_design.gap.signals.loading import load_subject

MASS, LENGTH, INERTIA, ROTOR, DAMPING = 0.5, 0.1, 0.0006, 0.003, 0.02
HELD = '<joint name="hip" axis="0 1 0" damping="0.05"/>'


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(1)
    return [rng.uniform(-2, 2, (6, 1)) for _ in range(3)]


def test_torques_of_a_pendulum_are_those_of_its_equation_of_motion(states):
    position, velocity, acceleration = states
    model = mujoco.MjModel.from_xml_string(robots.PENDULUM)
    found = mujoco_torques(model, ("swing",), *states)
    expected = (
        (INERTIA + MASS * LENGTH**2 + ROTOR) * acceleration
        + DAMPING * velocity
        + MASS * 9.81 * LENGTH * np.sin(position)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_stops_contacts_and_dry_friction_are_off_and_options_come_back(states):
    text = robots.PENDULUM.replace(
        'damping="0.02"', 'damping="0.02" frictionloss="2" range="-0.1 0.1" limited="true"'
    )
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags = int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    free = mujoco.MjModel.from_xml_string(robots.PENDULUM)
    found = mujoco_torques(model, ("swing",), *states)
    np.testing.assert_allclose(found, mujoco_torques(free, ("swing",), *states), rtol=1e-12)
    assert model.opt.disableflags == int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)


def test_options_come_back_where_a_state_is_of_another_robot(states):
    model = mujoco.MjModel.from_xml_string(robots.PENDULUM)
    with pytest.raises(ValueError, match="broadcast"):
        mujoco_torques(model, ("swing",), np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)))
    assert model.opt.disableflags == 0


@pytest.mark.parametrize("name", ["pendulum", "arm", "coupled", "geared"])
def test_robots_that_are_read_whole_agree(robot_files, name):
    text = robots.without_missing_meshes(robot_files[name].read_text())
    assert (
        disagreements(load_subject(robot_files[name]), mujoco.MjModel.from_xml_string(text)) == ()
    )


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('<body name="shank" pos="0 0 -0.3">', '<body name="shank" pos="0 0 -0.3" gravcomp="1">'),
        (
            '<joint name="knee" axis="0 1 0" damping="0.03"',
            '<joint name="knee" axis="0 1 0" damping="0.04"',
        ),
        ('mass="1.5"', 'mass="1.51"'),
    ],
)
def test_what_was_not_read_is_told_with_the_joint(robot_files, old, new):
    text = robot_files["coupled"].read_text()
    assert old in text
    whole = mujoco.MjModel.from_xml_string(text.replace(old, new))
    (note,) = disagreements(load_subject(robot_files["coupled"]), whole)
    joint = "hip" if "1.51" in new else "knee"
    assert f"at {joint}" in note or f"{joint}: by" in note or f", {joint}" in note
    assert ("knee" in note) == (joint == "knee")


def test_rounding_of_a_file_is_no_disagreement(robot_files):
    text = robot_files["coupled"].read_text()
    subject = load_subject(robot_files["coupled"])
    for share, told in ((0.1 * TOLERANCE, False), (10 * TOLERANCE, True)):
        whole = mujoco.MjModel.from_xml_string(
            text.replace('mass="1.5"', f'mass="{1.5 * (1 + share):.9f}"')
        )
        assert bool(disagreements(subject, whole)) is told
