"""A UR10 as others describe it, with neither friction nor rotors, against a plant in a plain MuJoCo
loop that has both, beside gears that give and masses that are a little wrong.
"""

import re
from functools import cache

import mujoco
import numpy as np
import pytest

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.logs.metadata import Metadata
from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.sizing.other_robots import robots_folder

pytestmark = pytest.mark.slow

NAMES = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
JOINTS = tuple(f"{name}_joint" for name in NAMES)
LIFT = 1
COULOMB = np.array([14.0, 16.0, 9.0, 3.2, 2.8, 2.4])
STRIBECK = np.array([5.0, 5.0, 3.0, 1.2, 1.0, 1.0])
VISCOUS = np.array([12.0, 14.0, 8.0, 2.2, 2.0, 1.6])
ROTOR = np.array([3.2, 3.2, 1.6, 0.32, 0.32, 0.32])
STIFFNESS = np.array([22e3, 22e3, 14e3, 5e3, 5e3, 5e3])
"""[Nm, Nm, Nms/rad, kg m^2, Nm/rad]"""
LOADED, ONSET, TURN, GEAR_DAMPING, LINK_ROTOR = 0.03, 0.05, 0.002, 20.0, 0.02
"""Friction over load [-], speeds of Stribeck friction and of its turning over [rad/s], damping of
gears [Nms/rad], part of the rotors that is rigid with the links [kg m^2].
"""
GAINS = np.array([4000, 4000, 2500, 600, 600, 300.0]), np.array([200, 200, 120, 25, 25, 12.0])
POSE = np.array([0.2, -1.2, 1.3, -1.0, 1.2, 0.3])
SWING = np.array([0.5, 0.4, 0.45, 0.6, 0.6, 0.8])
STEP, CONTROL, LOGGED, SECONDS = 5e-4, 4, 16, 20.0
NOISE = 1e-5, 2e-3, 0.003 * np.array([150, 150, 100, 30, 30, 30.0])
"""Of positions, speeds and torques [rad, rad/s, Nm]."""


def described():
    text = (robots_folder() / "ur_description" / "urdf" / "ur10_robot.urdf").read_text()
    shown = r"<(visual|collision|transmission|gazebo)\b.*?</\1>"
    return re.sub(shown, "", text, flags=re.DOTALL)


def built():
    """The robot as it is: other masses, centres and inertias than described."""
    model, rng = mujoco.MjModel.from_xml_string(described()), np.random.default_rng(5)
    for body in range(1, model.nbody):
        model.body_mass[body] *= 1 + 0.08 * rng.standard_normal()
        model.body_inertia[body] *= 1 + 0.15 * np.abs(rng.standard_normal())
        model.body_ipos[body] += 0.012 * rng.standard_normal(3)
    model.dof_armature[:], model.opt.timestep = LINK_ROTOR, STEP
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def swings(path):
    """Of each joint, five sines that fade in: amplitude, turns, phase `(joints, 5)`."""
    rng, harmonic = np.random.default_rng(100 + path), np.arange(5)
    draws = rng.uniform(size=(len(JOINTS), 5, 3))
    turns = 2 * np.pi * (0.08 + 0.09 * harmonic + 0.05 * draws[..., 0])
    size = SWING[:, None] / (1 + harmonic) * (0.5 + 0.5 * draws[..., 1])
    return size, turns, 2 * np.pi * draws[..., 2]


@cache
def recorded(path, seed, more_viscous=0.0, less_coulomb=0.0):
    """A log of one motion on one day."""
    model, rng = built(), np.random.default_rng(seed)
    data, (size, turns, phase) = mujoco.MjData(model), swings(path)
    coulomb = COULOMB * (1 + 0.02 * rng.standard_normal(6))
    viscous = VISCOUS * (1 + 0.02 * rng.standard_normal(6))
    viscous[LIFT] += more_viscous
    coulomb[LIFT] -= less_coulomb

    def wanted(time):
        begun = min(time / 1.5, 1.0)
        fade = begun**2 * (3 - 2 * begun)
        return POSE + fade * (size * np.sin(turns * time + phase)).sum(1)

    motor, speed, sum_of_errors = wanted(0.0), np.zeros(6), np.zeros(6)
    data.qpos[:] = motor
    before, torque, rows = motor, np.zeros(6), []
    for tick in range(round(SECONDS / STEP)):
        target = wanted(tick * STEP)
        if tick % CONTROL == 0:
            read = motor + NOISE[0] * rng.standard_normal(6)
            turning = speed + NOISE[1] * rng.standard_normal(6)
            period = CONTROL * STEP
            sum_of_errors += 2 * GAINS[0] * (target - read) * period
            asked = (target - before) / period - turning
            torque = GAINS[0] * (target - read) + GAINS[1] * asked + sum_of_errors
            torque, before = np.clip(torque + data.qfrc_bias, -330, 330), target
        if tick % LOGGED == 0:
            told = torque + NOISE[2] * rng.standard_normal(6)
            rows.append([tick * STEP, *target, *read, *turning, *told])
        through = STIFFNESS * (motor - data.qpos) + GEAR_DAMPING * (speed - data.qvel)
        dry = coulomb + STRIBECK * np.exp(-((speed / ONSET) ** 2)) + LOADED * np.abs(through)
        # friction turns over within a step, so that its slope is part of the inertia
        slope = coulomb / TURN / np.cosh(np.clip(speed / TURN, -20, 20)) ** 2 + viscous
        left = torque - through - dry * np.tanh(speed / TURN) - viscous * speed
        speed = speed + STEP * left / (ROTOR + STEP * slope)
        motor = motor + STEP * speed
        data.qfrc_applied[:] = through
        mujoco.mj_step(model, data)
    table = np.array(rows)
    signals = ("position_target", "position", "velocity", "motor_torque")
    columns = [f"{signal}/{joint}" for signal in signals for joint in JOINTS]
    named = dict(zip(columns, table[:, 1:].T, strict=True))
    return Log(f"ur10_{path}_{seed}", table[:, 0], named, Metadata(base="fixed", session=str(seed)))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("ur10") / "ur10.urdf"
    path.write_text(described())
    return path


@pytest.fixture(scope="module")
def references():
    return [recorded(1, 11), recorded(2, 12)]


def test_a_healthy_robot_is_as_it_was_however_much_its_model_lacks(model, references):
    found = diagnose(model, [recorded(1, 13), recorded(2, 14)], references)
    assert found.verdict == "none"
    lacking = {(one["effect"], one["location"]) for one in found.lacks["causes"]}
    assert {("coulomb_friction", joint) for joint in JOINTS} <= lacking
    assert {("viscous_friction", joint) for joint in JOINTS} <= lacking


def test_viscous_friction_is_told_beside_all_friction_that_the_model_lacks(model, references):
    found = diagnose(model, [recorded(1, 15, 9.0), recorded(2, 16, 9.0)], references)
    assert found.verdict == "explained"
    assert [(one.effect, one.location) for one in found.causes] == [
        ("viscous_friction", JOINTS[LIFT])
    ]
    assert 6.0 < found.causes[0].parameters["damping"].value < 12.0


def test_friction_may_be_less_than_in_the_references_though_the_model_has_none(model, references):
    less = [recorded(path, seed, less_coulomb=5.0) for path, seed in ((1, 17), (2, 18))]
    found = diagnose(model, less, references)
    assert found.verdict == "explained"
    assert [(one.effect, one.location) for one in found.causes] == [
        ("coulomb_friction", JOINTS[LIFT])
    ]
    assert found.causes[0].parameters["torque"].value == pytest.approx(-5.0, abs=1.5)
