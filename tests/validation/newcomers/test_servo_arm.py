"""The arm of hobby servos: its drives do what a firmware and a motor on a supply do."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from hyperleg_design.validation.newcomers import servo_arm
from hyperleg_design.validation.newcomers.plant import Wrong
from hyperleg_design.validation.newcomers.servo_arm import (
    COUNT,
    JOINTS,
    MOTIONS,
    Run,
    built,
    simulate,
)


def run(*wrongs, motion="waves", seed=3, duration=4.0):
    return simulate(wrongs, Run(motion, seed, 11, "log", duration))


def of(log, kind):
    return np.stack([log.signals[f"{kind}/{name}"] for name in JOINTS], 1)


@pytest.mark.parametrize("motion", list(MOTIONS))
def test_a_healthy_arm_follows_every_motion_within_its_range(motion):
    log = run(motion=motion, duration=8.0)
    model = mujoco.MjModel.from_xml_string(servo_arm.XML)
    position, target = of(log, "position"), of(log, "position_target")
    assert (position > model.jnt_range[:, 0]).all()
    assert (position < model.jnt_range[:, 1]).all()
    assert np.median(np.abs(position - target)) < 0.15
    assert np.diff(log.time) == pytest.approx(0.02, abs=0.004)
    np.testing.assert_allclose(position / COUNT, np.round(position / COUNT), atol=1e-6)


def test_the_same_seed_gives_the_same_log_and_another_one_another():
    first, again, other = run(), run(), run(seed=4)
    for column, values in first.signals.items():
        np.testing.assert_array_equal(values, again.signals[column])
        assert not np.array_equal(values, other.signals[column])


def test_at_rest_the_motor_holds_the_load_up_to_its_friction():
    """After a step has settled, gravity differs from the duty's torque by friction at rest."""
    log = run(motion="steps", duration=12.0)
    model, servos = built(11)
    data, position = mujoco.MjData(model), of(log, "position") - servos.zero
    error = of(log, "position_target") - of(log, "position")
    stall = servos.gain * servos.constant * servos.voltage / servo_arm.RESISTANCE
    still = np.abs(of(log, "velocity")).max(1) < 1e-4
    assert still.sum() > 50
    for k in np.flatnonzero(still)[::5]:
        data.qpos[:], data.qvel[:] = position[k], 0.0
        mujoco.mj_forward(model, data)
        motor = stall * error[k]
        held = servos.dry + servo_arm.STICTION + servos.under_load * np.abs(motor)
        assert (np.abs(motor - data.qfrc_bias) < 1.1 * held + 0.02).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("what", "place", "size"),
    [
        ("rough", 2, 3.0), ("thick", 0, 0.2), ("load", 4, 0.2), ("weak", 1, 0.7), ("gain", 1, 0.5),
        ("zero", 3, 0.08), ("rotor", 0, 0.02), ("late", 0, 0.06), ("empty", 0, 0.8),
        ("spring", 1, 0.4), ("drag", 0, 0.3),
    ],
)  # fmt: skip
def test_what_is_wrong_moves_its_joint(what, place, size):
    right, wrong = run(), run(Wrong(what, place, size))
    change = np.abs(of(wrong, "position") - of(right, "position")).max(0)
    assert change[1 if what == "load" else place] > 4 * COUNT  # the lift carries a load
    np.testing.assert_array_equal(of(wrong, "position_target")[0], of(right, "position_target")[0])


def test_half_the_gain_sags_twice_as_far():
    sag = [
        np.mean((of(log, "position_target") - of(log, "position"))[:, 1])
        for log in (run(), run(Wrong("gain", 1, 0.5)))
    ]
    assert sag[1] / sag[0] == pytest.approx(2.0, rel=0.15)


def test_what_no_such_arm_knows_is_refused():
    with pytest.raises(ValueError, match="haunted"):
        run(Wrong("haunted"))
