from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.inference.endogenous import Factor, factor, joined


def test_the_slopes_are_the_derivatives():
    one = Factor(0, np.array([[0.3, -0.2, 0.1], [0.1, 0.2, -0.3]]), 50.0)
    for phi in np.array([[-1.5, 0.5], [0.0, 0.0], [2.0, -1.0]]):
        first, second = one.slopes(phi)
        step = 1e-4 * np.eye(2)
        ahead, behind = (np.array([one.log(phi + way * s) for s in step]) for way in (1, -1))
        assert first == pytest.approx((ahead - behind) / 2e-4, rel=1e-4, abs=1e-6)
        slopes = [(one.slopes(phi + s)[0] - one.slopes(phi - s)[0]) / 2e-4 for s in step]
        np.testing.assert_allclose(second, -np.array(slopes), rtol=1e-4, atol=1e-6)


def test_causes_that_take_parts_of_one_torque_pay_for_their_sum():
    slope = np.ones((1, 20))
    taken = [(0, Factor(0, slope, 50.0, row=3)), (2, Factor(0, slope, 50.0, row=3))]
    elsewhere = (1, Factor(0, slope, 40.0, row=1))
    found = {tuple(places): one for places, one in joined([*taken, elsewhere])}
    assert set(found) == {(0, 2), (1,)}
    together = found[0, 2]
    assert together.log(np.array([-0.4, -0.5])) == pytest.approx(50 * np.log(0.1))
    assert together.log(np.array([-0.4, 0.0])) == pytest.approx(taken[0][1].log(np.array([-0.4])))


def test_a_cause_of_the_logs_under_test_alone_scales_no_torque_of_the_references():
    own, all_logs = Factor(0, np.ones((1, 10)), 25.0), Factor(0, np.ones((1, 30)), 75.0)
    ((places, both),) = joined([(0, own), (1, all_logs)])
    assert places == [0, 1]
    assert both.log(np.array([-0.5, 0.0])) == pytest.approx(own.log(np.array([-0.5])))
    assert both.log(np.array([0.0, -0.5])) == pytest.approx(all_logs.log(np.array([-0.5])))


def test_effects_that_scale_torques_pay_and_others_do_not(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    one = factor(samples, "torque_constant", "m_front", np.array([0.08]))
    assert one is not None
    assert one.slope.shape[1] > 100  # at ticks, also where it is the same at all of them
    assert one.log(np.zeros(1)) == 0
    assert one.log(np.array([-2.0])) < 0 < one.log(np.array([2.0]))
    assert factor(samples, "viscous_friction", "hip", np.array([1.0])) is None
    assert factor(samples, "load_dependent_friction", "hip", np.array([0.1])) is None


def test_a_torque_that_is_nothing_over_the_floor_gains_nothing_by_being_scaled_up(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    own = factor(samples, "torque_constant", "m_front", np.array([0.08]))
    assert own.shows == 1
    faint = replace(samples, floor=1e3 * samples.floor)
    hidden = factor(faint, "torque_constant", "m_front", np.array([0.08]))
    less, more = np.array([-2.0]), np.array([2.0])
    assert hidden.log(more) == 0
    assert hidden.log(less) == pytest.approx(own.log(less))
