import numpy as np
import pytest

from hyperleg_design.errors import InputError
from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.sizing.motions.hop import HopPlan, hop, load_pulse
from hyperleg_design.sizing.motions.motion import ground_wrench


@pytest.fixture(scope="module")
def motion():
    return hop(load_design(), samples=42)


def test_force_is_the_pulse_and_nothing_in_flight(motion):
    force, moment = ground_wrench(motion.model, motion.q, motion.v, motion.a)
    weight = GRAVITY * 32.0
    np.testing.assert_allclose(
        force[:, 2], weight * load_pulse(HopPlan(), motion.time)[2], atol=1e-6
    )
    np.testing.assert_allclose(force[:, :2], 0.0, atol=1e-6)
    flying = ~motion.contact.any(1)
    assert flying.sum() == pytest.approx(42 * 0.12 / 0.42, abs=1)
    np.testing.assert_allclose(moment[flying], 0.0, atol=1e-6)


def test_centre_of_mass_falls_freely(motion):
    flying = ~motion.contact.any(1)
    height = np.array([motion.model.center_of_mass(q)[2] for q in motion.q[flying]])
    time = motion.time[flying]
    fall = np.polynomial.Polynomial.fit(time, height, 2).convert().coef
    assert 2 * fall[2] == pytest.approx(-GRAVITY, rel=1e-6)
    forward = np.array([motion.model.center_of_mass(q)[0] for q in motion.q])
    np.testing.assert_allclose(forward, forward[0], atol=1e-9)


def test_no_angular_momentum(motion):
    import pinocchio as pin

    for q, v in zip(motion.q, motion.v, strict=True):
        momentum = pin.computeCentroidalMomentum(motion.model.model, motion.model.data, q, v)
        np.testing.assert_allclose(momentum.angular, 0.0, atol=1e-8)


def test_pulse_lifts_the_body_as_high_as_the_flight_needs():
    plan = HopPlan()
    time = np.linspace(0, plan.stance + plan.flight, 20001)
    height, rate, load = load_pulse(plan, time)
    assert np.trapezoid(load, time) == pytest.approx(time[-1], rel=1e-6)
    assert height[-1] == pytest.approx(height[0], abs=1e-9)
    np.testing.assert_allclose(np.gradient(height, time)[1:-1], rate[1:-1], atol=1e-3)
    np.testing.assert_allclose(np.gradient(rate, time)[5:-5], GRAVITY * (load[5:-5] - 1), atol=1e-1)
    assert height.max() - load_pulse(plan, np.array([plan.stance]))[0, 0] == pytest.approx(
        plan.rise, rel=1e-4
    )


def test_bad_plan():
    with pytest.raises(InputError, match="flight"):
        HopPlan(flight=-0.1)
