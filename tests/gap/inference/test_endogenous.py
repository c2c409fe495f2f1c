from dataclasses import replace

import diagnosed
import numpy as np
import pytest

from hyperleg_design.gap.effects import WEIGHED
from hyperleg_design.gap.inference.endogenous import (
    Factor,
    factors_of,
    held_back,
    held_back_in_all,
    joined,
)


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
    (one,) = factors_of(samples, "torque_constant", "m_front", np.array([0.08]))
    assert one.slope.shape[1] > 100  # at ticks, also where it is the same at all of them
    assert one.log(np.zeros(1)) == 0
    assert one.log(np.array([-2.0])) < 0 < one.log(np.array([2.0]))
    assert not factors_of(samples, "viscous_friction", "hip", np.array([1.0]))
    assert not factors_of(samples, "load_dependent_friction", "hip", np.array([0.1]))


def test_a_torque_that_is_nothing_over_the_floor_gains_nothing_by_being_scaled_up(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    (own,) = factors_of(samples, "torque_constant", "m_front", np.array([0.08]))
    assert own.shows == 1
    faint = replace(samples, floor=1e3 * samples.floor)
    (hidden,) = factors_of(faint, "torque_constant", "m_front", np.array([0.08]))
    less, more = np.array([-2.0]), np.array([2.0])
    assert hidden.log(more) == 0
    assert hidden.log(less) == pytest.approx(own.log(less))


def unmeasured(kind="healthy"):
    """The coupled rig without its measured torques."""
    log = diagnosed.run(kind, 0)
    signals = {
        f"motor_torque_command/{column.partition('/')[2]}" if column.startswith("motor_torque/")
        else column: values
        for column, values in log.signals.items()
    }  # fmt: skip
    return log.changed(signals=signals)


def test_a_limit_pays_for_the_torque_that_it_holds_back(robot_files):
    """Beyond a limit none of what a controller asks for arrives; below it all does."""
    samples = diagnosed.evidence(robot_files["coupled"], unmeasured()).samples
    saturation = WEIGHED["torque_saturation"]
    signals = samples.filtered_logs[0].signals
    asked = np.abs(signals.command[:, 0])
    high, low = 1 / (1.1 * asked.max()), 1 / np.quantile(asked, 0.2)
    assert held_back(samples, saturation, "m_front", np.array([high])) == ()
    found = held_back(samples, saturation, "m_front", np.array([low]))
    assert len(found) == 1
    (whole,) = held_back_in_all(samples, saturation, "m_front", np.array([low]))
    assert whole.log(np.zeros(1)) == 0
    # of two motors at this joint one is held back, four fifths of the time
    held = 0.8 * np.log(0.5)
    assert whole.log(np.ones(1)) == pytest.approx(whole.number * held, rel=0.2)
    size = np.array([low / saturation.usual("m_front", signals.subject)[0]])
    assert found[0].log(size) == pytest.approx(whole.log(np.ones(1)))
    assert not factors_of(samples, "torque_saturation", "m_front", np.ones(1))  # at no values


def test_a_weak_battery_and_strong_motors_cancel_out(robot_files):
    """What a battery takes from all torques must not be given back for free."""
    log = unmeasured()
    battery = {"battery_voltage": np.linspace(24.0, 18.0, len(log.time))}
    log = log.changed(signals=dict(log.signals) | battery)
    samples = diagnosed.evidence(robot_files["coupled"], log).samples
    sag, subject = WEIGHED["voltage_sag"], samples.filtered_logs[0].signals.subject
    values = np.array([0.0, 2.0, 10.0])
    weak = factors_of(samples, "voltage_sag", "battery", sag.usual("battery", subject), values)
    usual = WEIGHED["torque_constant"].usual("m_front", subject)
    strong = factors_of(samples, "torque_constant", "m_front", usual)
    phi = (values - sag.nulls) / sag.usual("battery", subject)
    own = [(i, one) for i, one in enumerate(weak) if one.row == strong[0].row]
    sizes = np.array([phi[one.parameter] for _, one in own])
    ((_, alone),) = joined(own)
    assert alone.log(sizes) < -0.15 * alone.number
    ((_, both),) = joined([*own, (len(weak), strong[0])])
    lost = 1 - np.exp(alone.log(sizes) / alone.number)
    assert both.log(np.append(sizes, lost / usual[0])) == pytest.approx(0, abs=0.1 * both.number)


def test_measured_torques_are_held_back_by_nothing(robot_files):
    samples = diagnosed.evidence(robot_files["coupled"], diagnosed.run("healthy", 0)).samples
    assert held_back(samples, WEIGHED["torque_saturation"], "m_front", np.array([2.0])) == ()
