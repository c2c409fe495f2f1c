from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.endogenous import Factor, Shrinking, factor
from hyperleg_design.gap.pipeline.diagnose import diagnose


def test_the_slopes_are_the_derivatives():
    one = Factor(0, np.array([0.3, -0.2, 0.1]), 50.0)
    for phi in (-1.5, 0.0, 2.0):
        step = 1e-4
        first, second = one.slopes(phi)
        assert first == pytest.approx(
            (one.log(phi + step) - one.log(phi - step)) / (2 * step), rel=1e-4, abs=1e-6
        )
        curve = (one.log(phi + step) - 2 * one.log(phi) + one.log(phi - step)) / step**2
        assert second == pytest.approx(-curve, rel=1e-2)


def test_effects_that_scale_torques_pay_and_others_do_not(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    one = factor(samples, "torque_constant", "m_front", np.array([0.08]))
    assert one is not None
    assert one.log(0.0) == 0
    assert one.log(-2.0) < 0 < one.log(2.0)
    assert factor(samples, "viscous_friction", "hip", np.array([1.0])) is None
    friction = factor(samples, "load_dependent_friction", "hip", np.array([0.1]))
    assert friction is not None


def test_a_torque_that_is_nothing_over_the_floor_gains_nothing_by_being_scaled_up(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    own = factor(samples, "torque_constant", "m_front", np.array([0.08]))
    assert own.shows == 1
    faint = replace(samples, floor=1e3 * samples.floor)
    hidden = factor(faint, "torque_constant", "m_front", np.array([0.08]))
    assert hidden.log(2.0) == 0
    assert hidden.log(-2.0) == pytest.approx(own.log(-2.0))


def test_noise_that_shrinks_gains_nothing():
    one = Shrinking(0, np.array([0.3, 0.5]), np.array([1.0, 0.6]), np.array([20.0, 10.0]), 0)
    assert one.log(0.0) == 0
    for phi in (-1.0, 0.0, 1.0):
        step = 1e-4
        first, second = one.slopes(phi)
        assert first == pytest.approx(
            (one.log(phi + step) - one.log(phi - step)) / (2 * step), rel=1e-4
        )
        curve = (one.log(phi + step) - 2 * one.log(phi) + one.log(phi - step)) / step**2
        assert second == pytest.approx(max(-curve, 0.0), rel=1e-2, abs=1e-4)
    pure = replace(one, slope=np.full(1, 0.3), part=np.ones(1), number=np.full(1, 20.0))
    assert pure.log(2.0) == pytest.approx(
        20 * np.log(1 - 0.6)
    )  # what the noise's own density gains by it


def test_belts_pay_where_encoders_at_the_joints_bring_noise_into_their_load(robot_files):
    samples = diagnosed.evidence(robot_files["servos"], diagnosed.stamped_badly(0)).samples
    usual = np.array([0.004, 0.05, 1.0, 1.0, 30.0])
    at_joints, at_rotors = (
        factor(
            samples,
            "transmission_elasticity",
            "knee",
            usual,
            np.array([0.004, 0.05, side, 0.0, 0.0]),
        )
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
