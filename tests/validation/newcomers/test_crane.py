"""The crane: what is wrong with it is in its logs, and a healthy one is whole."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import crane
from hyperleg_design.validation.newcomers.crane import (
    DRIVES,
    JOINTS,
    LAG,
    LIVE,
    MOTIONS,
    MOTORS,
    Run,
    built,
    simulate,
)
from hyperleg_design.validation.newcomers.plant import Wrong


def run(*wrongs, motion="picks", drive="filtered", seed=3, duration=3.0):
    return simulate(wrongs, Run(motion, drive, seed, 11, "log", duration))


def of(log, kind, names=JOINTS):
    return np.stack([log.signals[f"{kind}/{name}"] for name in names], 1)


@pytest.mark.parametrize(
    "motion",
    [pytest.param(m, marks=pytest.mark.slow if i else ()) for i, m in enumerate(MOTIONS)],
)
@pytest.mark.parametrize("drive", DRIVES)
def test_a_healthy_crane_follows_every_motion_within_its_drives(motion, drive):
    log = run(motion=motion, drive=drive)
    model = mujoco.MjModel.from_xml_string(crane.XML)
    position, target = of(log, "position"), of(log, "position_target")
    assert np.abs(position - target).max() < 0.35
    assert (position > model.jnt_range[:, 0]).all()
    assert (position < model.jnt_range[:, 1]).all()
    limit = model.actuator_ctrlrange[:, 1]
    assert (np.abs(of(log, "motor_torque_command", MOTORS)) < 0.6 * limit).all()
    assert np.diff(log.time) == pytest.approx(0.002)


def test_the_same_seed_gives_the_same_log_and_another_one_another():
    first, again, other = run(), run(), run(seed=4)
    for column, values in first.signals.items():
        np.testing.assert_array_equal(values, again.signals[column])
        assert not np.array_equal(values, other.signals[column])


def test_the_log_obeys_the_model_that_made_it():
    """Inverse dynamics of the crane as built leaves friction of the logged torques, and no more."""
    log = run(drive="lagging")
    model, zero = built(11)
    friction = model.dof_frictionloss.copy()
    model.dof_frictionloss[:] = 0
    data, position, speed = mujoco.MjData(model), of(log, "position") - zero, of(log, "velocity")
    given = of(log, "motor_torque", MOTORS) * model.actuator_gear[:, 0]
    acceleration = np.gradient(speed, log.time, axis=0)
    needed = np.zeros_like(position)
    for k in range(len(position)):
        data.qpos[:], data.qvel[:], data.qacc[:] = position[k], speed[k], acceleration[k]
        mujoco.mj_inverse(model, data)
        needed[k] = data.qfrc_inverse
    moves = np.abs(speed) > 0.3
    for joint in range(4):
        along = ((given - needed) * np.sign(speed))[moves[:, joint], joint]
        assert np.median(along) == pytest.approx(friction[joint], abs=0.06)


def test_torques_lag_by_as_much_as_the_drive_says():
    for wrongs, lag in (((), LAG), ((Wrong("lag", 1, 0.012),), LAG + 0.012)):
        log = run(*wrongs, motion="waves", drive="lagging", duration=6.0)
        asked, given = (
            log.signals[f"{kind}/drive_luff"] for kind in ("motor_torque_command", "motor_torque")
        )
        rate = np.gradient(asked, log.time)
        late = -np.sum((given - asked) * rate) / np.sum(rate**2)
        assert late == pytest.approx(lag + 0.001, rel=0.35)  # a tick is held for its length


def test_commands_come_late_and_a_weak_motor_needs_more():
    late = run(Wrong("late", size=0.012))
    asked, given = (
        late.signals[f"{kind}/drive_fold"] for kind in ("motor_torque_command", "motor_torque")
    )
    by_shift = [np.std(asked[20 - k : -20 - k] - given[20:-20]) for k in range(12)]
    assert int(np.argmin(by_shift)) == 6
    right, weak = run(), run(Wrong("weak", 2, 0.7))
    size = [np.std(one.signals["motor_torque/drive_fold"]) for one in (right, weak)]
    assert 0.7 * size[1] == pytest.approx(size[0], rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "place", "size"),
    [("eccentric", 2, 0.03), ("dropout", 1, 0.06), ("crosstalk", 2, 0.4), ("stop", 1, 0.1)]
    + [(what, 1, 0.8) for what in LIVE if what != "stop"],
)
def test_what_the_catalogue_lacks_moves_its_joint(what, place, size):
    right, wrong = run(duration=6.0), run(Wrong(what, place, size), duration=6.0)
    change = np.abs(of(wrong, "motor_torque", MOTORS) - of(right, "motor_torque", MOTORS)).max(0)
    assert all(np.isfinite(values).all() for values in wrong.signals.values())
    assert change[place] > 0.02


def test_what_no_crane_knows_is_refused():
    with pytest.raises(ValueError, match="haunted"):
        run(Wrong("haunted"))
