from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import EFFECTS
from hyperleg_design.gap.inference.endogenous import factor
from hyperleg_design.gap.inference.shrinking import Shrinking
from hyperleg_design.gap.pipeline.diagnose import diagnose

BELT = "transmission_elasticity"
USUAL = np.array([0.004, 0.05, 1.0, 1.0, 30.0])


def shrinking_by(slope, square, part, number):
    return Shrinking(0, *(np.array(one) for one in (slope, square, part, number)), 0)


def test_noise_that_shrinks_gains_nothing():
    one = shrinking_by([0.3, 0.5], [0.09, 0.4], [1.0, 0.6], [20.0, 10.0])
    assert one.log(0.0) == 0
    for phi in (-1.0, 0.0, 1.0):
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


def test_belts_pay_where_encoders_at_the_joints_bring_noise_into_their_load(robot_files):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    at_joints, at_rotors = (
        factor(samples, BELT, "knee", USUAL, np.array([0.004, 0.05, side, 0.0, 0.0]))
        for side in (0.0, 1.0)
    )
    assert isinstance(at_joints, Shrinking)
    assert at_joints.log(0.5) < 0
    assert at_rotors is None


def test_a_clock_that_jitters_is_no_belt(robot_files):
    assert (
        diagnose(robot_files["servos"], [diagnosed.stamped_badly(seed) for seed in (0, 1)]).verdict
        == "none"
    )


@pytest.mark.parametrize(("behind", "stiffening"), [(0.0, 20.0), (1.0, 0.0)])
def test_belts_pay_for_the_noise_of_torques_that_stretches_them(robot_files, behind, stiffening):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    values = np.array([0.01, 0.05, 1.0, behind, stiffening])
    one = factor(samples, BELT, "knee", USUAL, values)
    assert isinstance(one, Shrinking)
    size = values[0] / USUAL[0]
    assert one.log(size) < 0
    # the same from other noise, and from what is left of it
    (log,) = samples.filtered_logs
    signals, motor = log.signals, log.signals.subject.motors.index("knee")
    noise = 0.02 * np.random.default_rng(5).normal(size=len(signals.time))
    believed = signals.believed.copy()
    believed[:, motor] += noise
    calm, moved = (
        EFFECTS[BELT].trace(each, "knee", values[None])["motion"][0]
        for each in (signals, replace(signals, believed=believed))
    )
    joint = samples.rows[one.row].column
    added = noise * signals.subject.joint_from_motor[joint, motor]
    place = [row.column for row in log.rows if row.residual_name == "motion"].index(joint)
    before, after = log.sample(place, np.stack([added, added - (moved - calm)[:, joint]]))
    own = samples.group[samples.row == one.row]
    kept = 1 - 2 * one.slope * size + one.square * size**2
    for band in np.unique(own):
        mine = own == band
        left = np.sum(after[mine] ** 2) / np.sum(before[mine] ** 2)
        assert kept[mine] == pytest.approx(left, abs=0.2)
