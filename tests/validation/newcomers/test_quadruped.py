"""The quadruped: what is wrong with it is in its logs, and a healthy one stands and obeys its
model.
"""

from __future__ import annotations

import re

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import quadruped
from hyperleg_design.validation.newcomers.plant import Wrong
from hyperleg_design.validation.newcomers.quadruped import LAG, Run, built, careful_file, simulate
from hyperleg_design.validation.newcomers.quadruped_log import FEET, JOINTS
from hyperleg_design.validation.newcomers.quadruped_motion import (
    HEIGHT,
    MOTIONS,
    SOLE,
    STANCE,
    joint_angles,
)

MOTORS = tuple(name.removesuffix("_joint") for name in JOINTS)


def run(*wrongs, motion="sway", seed=3, duration=2.0):
    return simulate(wrongs, Run(motion, seed, 11, 12, "log", duration))


def of(log, kind, names):
    return np.stack([log.signals[f"{kind}/{name}"] for name in names], 1)


@pytest.fixture(scope="module")
def healthy():
    return run()


@pytest.mark.parametrize(
    "motion",
    [pytest.param(m, marks=pytest.mark.slow if i else ()) for i, m in enumerate(MOTIONS)],
)
def test_a_healthy_quadruped_stays_on_its_feet_within_its_drives(motion):
    log = run(motion=motion, duration=4.0)
    assert np.diff(log.time) == pytest.approx(0.005)
    height, upright = (log.signals[f"base_{k}"] for k in ("position/z", "orientation/w"))
    assert height.min() > 0.15
    assert height.max() < 0.36
    assert upright.min() > 0.97
    assert np.abs(of(log, "motor_torque_command", MOTORS)).max() < 0.7 * quadruped.LARGEST
    tracking = of(log, "position", JOINTS) - of(log, "position_target", JOINTS)
    assert np.abs(tracking).max() < 0.25


def test_feet_that_step_leave_the_floor_and_standing_feet_carry_the_weight(healthy):
    model, *_ = built(11)
    weight = 9.81 * model.body_mass.sum()
    force = of(healthy, "contact_force", [f"{foot}_z" for foot in FEET])
    assert force.sum(1).mean() == pytest.approx(weight, rel=0.01)
    assert (force > 2).all()
    trot = of(run(motion="trot", duration=4.0), "contact_force", [f"{foot}_z" for foot in FEET])
    assert ((trot[200:] < 3).mean(0) > 0.1).all()


def test_the_same_seed_gives_the_same_log_and_another_one_another(healthy):
    again, other = run(), run(seed=4)
    for column, values in healthy.signals.items():
        np.testing.assert_array_equal(values, again.signals[column])
        assert not np.array_equal(values, other.signals[column])


def test_the_file_is_the_description_with_friction_rotors_and_a_floor():
    careful = mujoco.MjModel.from_xml_string(careful_file())
    masses = re.findall(r'<mass value="([^"]+)"', quadruped.plain_file())
    assert careful.body_mass.sum() == pytest.approx(sum(map(float, masses)))
    assert (careful.nv, careful.nu) == (18, 12)
    assert careful.dof_frictionloss[6:] == pytest.approx(quadruped.RUBBING)
    assert careful.dof_armature[6:] == pytest.approx(quadruped.ROTOR)


def test_the_floor_gives_under_a_standing_foot_as_the_file_says():
    """Cones and impedances of the plant are not the file's, so that its contacts settle faster."""
    slopes = []
    for model in (mujoco.MjModel.from_xml_string(careful_file()), built(11)[0]):
        data, force = mujoco.MjData(model), np.zeros(6)
        targets = joint_angles(np.column_stack([STANCE, np.full(4, SOLE - HEIGHT)])[None])[0]
        quadruped._stand(model, data, targets)
        deep = []
        for load in (0.0, 20.0):
            data.xfrc_applied[model.body("trunk").id, 2] = -load
            for _ in range(round(0.5 / model.opt.timestep)):
                data.ctrl[:] = quadruped.STIFFNESS * (targets - data.qpos[7:])
                data.ctrl[:] -= quadruped.DAMPING * data.qvel[6:]
                mujoco.mj_step(model, data)
            total = 0.0
            for index in range(data.ncon):
                mujoco.mj_contactForce(model, data, index, force)
                total += force[0]
            deep.append((-np.mean([data.contact[i].dist for i in range(data.ncon)]), total))
        (depth, force_below), (more, force_above) = deep
        slopes.append((more - depth) / (force_above - force_below))
    assert slopes[1] == pytest.approx(slopes[0], rel=0.3)


@pytest.mark.slow
def test_torques_lag_and_a_weak_motor_needs_more():
    log = run(motion="trot", duration=4.0)
    asked, given = (log.signals[f"{k}/FR_calf"] for k in ("motor_torque_command", "motor_torque"))
    rate = np.gradient(asked, log.time)
    late = -np.sum((given - asked) * rate) / np.sum(rate**2)
    assert 0.5 * LAG < late < 4 * LAG
    right = np.abs(run().signals["motor_torque/FR_calf"]).mean()
    weak = np.abs(run(Wrong("weak", 2, 0.7)).signals["motor_torque/FR_calf"]).mean()
    assert 0.7 * weak == pytest.approx(right, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wrong", "column", "least"),
    [
        (Wrong("dry", 8, 1.0), "motor_torque/RR_calf", 0.1),
        (Wrong("zero", 5, 0.04), "base_orientation/x", 1e-3),
        (Wrong("gain", 9, 0.5), "motor_torque/RL_hip", 0.05),
        (Wrong("lossy", 4, 0.3), "motor_torque/FL_thigh", 0.05),
        (Wrong("hysteresis", 1, 1.5), "motor_torque/FR_thigh", 0.05),
        (
            Wrong("load", size=0.6, body="trunk", at=(0.08, 0.03, 0.09)),
            "contact_force/FR_foot_z",
            1,
        ),
        (Wrong("push", size=30.0, body="trunk"), "contact_force/FR_foot_y", 1.0),
        (Wrong("rope", size=400.0, body="RR_calf"), "contact_force/RR_foot_z", 2.0),
        (Wrong("soft", 3, 4.0), "base_position/z", 1e-4),
        (Wrong("tilt", size=0.05), "contact_force/FR_foot_x", 0.5),
        (Wrong("lost", size=0.3), "motor_torque/FR_calf", 0.02),
        (Wrong("gyro", 0, 0.02), "gyro/x", 0.015),
    ],
    ids=lambda value: value.what if isinstance(value, Wrong) else None,
)
def test_what_is_wrong_shows_in_its_signal(healthy, wrong, column, least):
    log = run(wrong)
    assert all(np.isfinite(values).all() for values in log.signals.values())
    change = log.signals[column] - healthy.signals[column]
    assert np.sqrt(np.mean(change**2)) > least


def test_a_slippery_foot_slides_where_others_stand():
    force = of(
        run(Wrong("slippery", 0, 0.3), duration=4.0),
        "contact_force",
        [f"FR_foot_{a}" for a in "xyz"],
    )
    loaded = force[:, 2] > 15
    share = np.linalg.norm(force[loaded, :2], axis=1) / force[loaded, 2]
    assert share.max() < 0.3 * quadruped.FLOOR * 1.35


def test_a_load_adds_its_mass_and_its_moment():
    model, *_ = built(11)
    body = model.body("RL_calf").id
    mass, moment = model.body_mass[body], model.body_mass[body] * model.body_ipos[body]
    at = np.array([0.0, 0.01, -0.15])
    quadruped._load(model, body, 0.2, at)
    assert model.body_mass[body] == pytest.approx(mass + 0.2)
    np.testing.assert_allclose(model.body_mass[body] * model.body_ipos[body], moment + 0.2 * at)


def test_what_no_quadruped_knows_is_refused():
    with pytest.raises(ValueError, match="haunted"):
        run(Wrong("haunted"))
