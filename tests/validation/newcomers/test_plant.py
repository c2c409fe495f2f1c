"""Newcomers' plants: what is wrong with them is in their logs, and the healthy ones are whole."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import plant
from hyperleg_design.validation.newcomers.plant import Wrong, built, moment, motion, simulate
from hyperleg_design.validation.newcomers.robots import ROBOTS

ARM = ROBOTS["two_link"]
SHORT = 4.0


@pytest.fixture(autouse=True)
def short(monkeypatch):
    monkeypatch.setattr(plant, "DURATION", SHORT)


def run(*wrongs, robot=ARM, seed=3):
    return simulate(robot, wrongs, seed, 11, "log")


@pytest.mark.parametrize("name", list(ROBOTS))
def test_healthy_robots_follow_their_targets_within_their_drives(name):
    robot = ROBOTS[name]
    log = run(robot=robot)
    model = mujoco.MjModel.from_xml_string(robot.xml)
    for i in range(model.njnt):
        joint = model.joint(i).name
        error = log.signals[f"position/{joint}"] - log.signals[f"position_target/{joint}"]
        assert np.abs(error[200:]).max() < 0.6
        low, high = model.jnt_range[i]
        assert (log.signals[f"position/{joint}"] > low).all()
        assert (log.signals[f"position/{joint}"] < high).all()
    for i in range(model.nu):
        torque = log.signals[f"motor_torque/{model.actuator(i).name}"]
        assert np.abs(torque).max() < 0.9 * model.actuator_ctrlrange[i, 1]
    assert (np.diff(log.time) > 0).all()


def test_the_same_seed_gives_the_same_log_and_another_one_another():
    first, again, other = run(), run(), run(seed=4)
    for column, values in first.signals.items():
        np.testing.assert_array_equal(values, again.signals[column])
        assert not np.array_equal(values, other.signals[column])


def test_the_log_obeys_the_model_that_made_it():
    """Inverse dynamics of the robot as built gives the logged torques back, friction aside."""
    log = run()
    model, zero = built(ARM, 11)
    model.dof_frictionloss[:] = 0
    data = mujoco.MjData(model)
    names = ("shoulder", "elbow")
    q = np.stack([log.signals[f"position/{j}"] for j in names], 1) - zero
    v = np.stack([log.signals[f"velocity/{j}"] for j in names], 1)
    torque = np.stack([log.signals[f"motor_torque/m_{j}"] for j in names], 1)
    a = np.gradient(v, log.time, axis=0)
    needed = np.zeros_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        needed[k] = data.qfrc_inverse
    left = (torque - needed)[100:-10]
    nominal, _ = built(ARM, 11)
    assert (np.abs(np.median(np.abs(left), 0) - nominal.dof_frictionloss) < 0.12).all()


def test_a_weak_motor_an_encoder_and_a_delay_are_in_the_log():
    right = run()
    zero = run(Wrong("zero", 1, 0.06))
    gap = zero.signals["position/elbow"] - right.signals["position/elbow"]
    lag = zero.signals["position_target/elbow"] - zero.signals["position/elbow"]
    assert np.isfinite(gap).all()
    assert np.abs(lag).max() < 0.6
    late = run(Wrong("late", size=0.01))
    command, given = (
        late.signals[f"{kind}/m_shoulder"] for kind in ("motor_torque_command", "motor_torque")
    )
    by_shift = [np.std(command[10 - k : -10 - k] - given[10:-10]) for k in range(6)]
    assert int(np.argmin(by_shift)) == 2
    weak = run(Wrong("weak", 0, 0.7))
    power = [
        np.std(x.signals["motor_torque/m_shoulder"] * f) for x, f in ((right, 1.0), (weak, 0.7))
    ]
    assert power[1] == pytest.approx(power[0], rel=0.15)


def test_gears_and_tendons_turn_motors_into_joints():
    model = mujoco.MjModel.from_xml_string(ROBOTS["coupled"].xml)
    np.testing.assert_allclose(
        moment(model), [[9, 0, 0, 0], [0, 9, 0, 0], [0, 0, 8, 6], [0, 0, 8, -6]]
    )


def test_a_soft_belt_and_play_part_motor_and_joint_and_stay_finite():
    for wrong in (Wrong("soft", 1, 14.0), Wrong("play", 1, 0.03)):
        log = run(wrong)
        assert all(np.isfinite(v).all() for v in log.signals.values())
        assert np.abs(log.signals["velocity/elbow"]).max() < 60


def test_smooth_targets_do_not_jump_and_stepped_ones_do(monkeypatch):
    monkeypatch.setattr(plant, "DURATION", 14.0)
    for name, robot in ROBOTS.items():
        targets = motion(robot, np.random.default_rng(1))
        acceleration = np.abs(np.diff(targets, 2, axis=0)).max() / plant.STEP**2
        assert (acceleration > 150) == robot.steps, (name, acceleration)


def test_what_no_plant_knows_is_refused():
    with pytest.raises(ValueError, match="haunted"):
        run(Wrong("haunted"))
