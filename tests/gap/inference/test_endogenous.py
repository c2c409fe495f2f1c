from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.endogenous import Factor, factor


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
