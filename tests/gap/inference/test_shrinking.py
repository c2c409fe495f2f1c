from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.endogenous import factors_of
from hyperleg_design.gap.inference.shrinking import LOAD, TORQUE, Shrinking, taken
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.pipeline.diagnose import diagnose

BELT = "transmission_elasticity"
USUAL = np.array([0.004, 0.05, 1.0, 1.0, 30.0])


def shrinking_by(slope, square, part, number):
    return Shrinking(0, *(np.array(one) for one in (slope, square, part, number)), 0)


def test_noise_that_shrinks_gains_nothing():
    one = shrinking_by([0.3, 0.5], [0.09, 0.4], [1.0, 0.6], [20.0, 10.0])
    assert one.log(0.0) == 0
    for phi in (0.5, 1.0):
        step = 1e-4
        first, second = one.slopes(phi)
        assert first == pytest.approx(
            (one.log(phi + step) - one.log(phi - step)) / (2 * step), rel=1e-4
        )
        curve = (one.log(phi + step) - 2 * one.log(phi) + one.log(phi - step)) / step**2
        assert second == pytest.approx(max(-curve, 0.0), rel=1e-2, abs=1e-4)
    pure = shrinking_by([0.3], [0.09], [1.0], [20.0])
    assert pure.log(2.0) == pytest.approx(
        20 * np.log(1 - 0.6)
    )  # what the noise's own density gains by it


@pytest.mark.parametrize("phi", [-1.0, 3.0])
def test_noise_that_a_trace_adds_gains_nothing_either(phi):
    one = shrinking_by([0.3, 0.0], [1.09, 0.4], [1.0, 0.6], [20.0, 10.0])
    assert one.log(phi) == 0
    assert one.slopes(phi) == (0, 0)


def test_belts_pay_where_encoders_at_the_joints_bring_noise_into_their_load(robot_files):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    (one,) = factors_of(samples, BELT, "knee", USUAL, np.array([0.004, 0.05, 0.0, 0.0, 0.0]))
    assert isinstance(one, Shrinking)
    assert one.log(0.5) < 0


def test_noise_of_a_load_comes_back_through_the_rotor_where_encoders_are_at_the_joints(
    robot_files,
):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    (log,) = samples.filtered_logs
    subject = log.signals.subject
    motor, joint = subject.motors.index("knee"), subject.joints.index("knee")
    values = np.array([0.002, 0.0, 0.0, 0.0, 0.0])
    share, square = taken(samples, EFFECTS[BELT], "knee", values, (motor, joint), (LOAD,))
    row = next(
        i for i, r in enumerate(log.rows) if (r.residual_name, r.column) == ("motion", joint)
    )
    inertia = rotor(subject, motor)
    for band in log.bands[row][-2:]:  # x = J compliance omega^2 of white noise
        (group,) = set(samples.group[samples.where[0][row]][log.labels(row)[0] == band.index])
        turned = (2 * np.pi) ** 2 * (band.high**3 - band.low**3) / (3 * (band.high - band.low))
        assert share[0, group] == pytest.approx(inertia * values[0] * turned, rel=0.3)
        assert square[0, group] >= share[0, group] ** 2


def test_a_clock_that_jitters_is_no_belt(robot_files):
    assert (
        diagnose(robot_files["servos"], [diagnosed.stamped_badly(seed) for seed in (0, 1)]).verdict
        == "none"
    )


@pytest.mark.parametrize(("behind", "stiffening"), [(0.0, 20.0), (1.0, 0.0)])
def test_belts_pay_for_the_noise_of_torques_that_stretches_them(robot_files, behind, stiffening):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    values = np.array([0.01, 0.05, 1.0, behind, stiffening])
    (one,) = factors_of(samples, BELT, "knee", USUAL, values)
    assert isinstance(one, Shrinking)
    assert one.log(values[0] / USUAL[0]) < 0
    # the same from other noise, and from what is left of it
    (log,) = samples.filtered_logs
    signals, motor = log.signals, log.signals.subject.motors.index("knee")
    joint = samples.rows[one.row].column
    shared, square = taken(samples, EFFECTS[BELT], "knee", values, (motor, joint), (TORQUE,))
    noise = 0.02 * np.random.default_rng(5).normal(size=len(signals.time))
    believed = signals.believed.copy()
    believed[:, motor] += noise
    calm, moved = (
        EFFECTS[BELT].trace(each, "knee", values[None])["motion"][0]
        for each in (signals, replace(signals, believed=believed))
    )
    added = noise * signals.subject.joint_from_motor[joint, motor]
    place = [row.column for row in log.rows if row.residual_name == "motion"].index(joint)
    before, after = log.sample(place, np.stack([added, added - (moved - calm)[:, joint]]))
    own = samples.group[samples.row == one.row]
    for band in np.unique(own):
        left = np.sum(after[own == band] ** 2) / np.sum(before[own == band] ** 2)
        kept = 1 - 2 * shared[0, band] + square[0, band]
        assert kept == pytest.approx(left, abs=0.2)
