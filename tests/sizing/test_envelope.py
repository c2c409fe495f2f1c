import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hyperleg_design.robot.design import load_design
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.sizing.envelope import (
    clip_torque,
    motor_envelope,
    torque_limits,
)

SPEEDS = st.lists(st.floats(-2000, 2000), min_size=7, max_size=7).map(np.array)


@pytest.fixture(scope="module")
def envelope():
    return motor_envelope(load_design("hyperleg"))


def isaac_dc_motor(torque, speed, stall, free, peak):
    """One motor, one point, as Isaac Lab's DCMotor clips it."""
    speed = max(-free * (1 + peak / stall), min(free * (1 + peak / stall), speed))
    top = min(stall * (1 - speed / free), peak)
    bottom = max(stall * (-1 - speed / free), -peak)
    return max(bottom, min(top, torque))


def test_paper_motors_stand_where_the_paper_puts_them(envelope):
    np.testing.assert_allclose(envelope.no_load_speed, [300, 300, 300, 327.2, 366, 366, 366])
    np.testing.assert_allclose(envelope.peak_torque, [5.04, 5.04, 5.04, 2.68, 1.63, 1.63, 1.63])
    np.testing.assert_allclose(
        envelope.stall_torque, [84.7, 84.7, 84.7, 9.78, 2.94, 2.94, 2.94], rtol=2e-3
    )
    assert (envelope.efficiency_out, envelope.efficiency_regen) == (0.9, 0.8)


def test_limits_at_the_marked_speeds(envelope):
    lower, upper = torque_limits(envelope, 0.0)
    np.testing.assert_array_equal(upper, envelope.peak_torque)
    np.testing.assert_array_equal(lower, -envelope.peak_torque)
    np.testing.assert_allclose(
        torque_limits(envelope, envelope.corner_speed)[1], envelope.peak_torque
    )
    np.testing.assert_allclose(torque_limits(envelope, envelope.no_load_speed)[1], 0, atol=1e-12)
    np.testing.assert_allclose(torque_limits(envelope, -envelope.no_load_speed)[0], 0, atol=1e-12)
    lower, upper = torque_limits(envelope, 1.001 * envelope.top_speed)
    np.testing.assert_array_equal(upper, lower)
    assert np.all(torque_limits(envelope, 0.999 * envelope.top_speed)[1] > -envelope.peak_torque)


@settings(max_examples=60, deadline=None)
@given(speed=SPEEDS)
def test_interval_is_never_inside_out_and_holds_zero_up_to_no_load_speed(envelope, speed):
    lower, upper = torque_limits(envelope, speed)
    assert np.all(-envelope.peak_torque <= lower)
    assert np.all(lower <= upper)
    assert np.all(upper <= envelope.peak_torque)
    np.testing.assert_array_equal(
        (lower <= 0) & (upper >= 0), np.abs(speed) <= envelope.no_load_speed
    )
    mirrored = torque_limits(envelope, -speed)
    np.testing.assert_array_equal((lower, upper), (-mirrored[1], -mirrored[0]))


@settings(max_examples=60, deadline=None)
@given(speed=SPEEDS, torque=st.lists(st.floats(-20, 20), min_size=7, max_size=7).map(np.array))
def test_clip_is_the_dc_motor_clip_of_the_simulator(envelope, speed, torque):
    expected = [
        isaac_dc_motor(*values)
        for values in zip(
            torque,
            speed,
            envelope.stall_torque,
            envelope.no_load_speed,
            envelope.peak_torque,
            strict=True,
        )
    ]
    clipped = clip_torque(envelope, torque, speed)
    np.testing.assert_allclose(clipped, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(clip_torque(envelope, clipped, speed), clipped)


def test_bus_voltage_moves_the_line_and_not_the_peak(envelope):
    raised = motor_envelope(load_design("hyperleg", overrides={"electrical.voltage_ratio": 1.5}))
    np.testing.assert_allclose(raised.no_load_speed, 1.5 * envelope.no_load_speed)
    np.testing.assert_allclose(raised.stall_torque, 1.5 * envelope.stall_torque)
    np.testing.assert_array_equal(raised.peak_torque, envelope.peak_torque)
    # the resistance of the winding is the slope of the line, whatever the voltage
    np.testing.assert_allclose(
        raised.stall_torque / raised.no_load_speed, 1 / envelope.power_constant
    )


def test_batch_equals_each_design():
    batch = load_design("hyperleg").with_values(
        {
            "electrical.voltage_ratio": np.array([0.8, 1.0, 1.3]),
            "actuators.knee.motor": np.array(["RI70", "RI60", "U10"]),
        }
    )
    speed = np.linspace(-400, 400, 7)
    together = torque_limits(motor_envelope(batch), speed)
    assert together[0].shape == (3, 7)
    for i in range(3):
        np.testing.assert_array_equal(
            np.array(together)[:, i], torque_limits(motor_envelope(batch.take(i)), speed)
        )


def test_only_installed_motors_count():
    assert motor_envelope(load_design("hyperleg", variant="toe_locked")).peak_torque.shape == (7,)
    removed = motor_envelope(load_design("hyperleg", variant="toe_removed"))
    assert removed.peak_torque.shape == removed.select(slice(None)).stall_torque.shape == (6,)
    assert removed.select([3]).peak_torque.tolist() == [2.68]


def test_at_standstill_a_motor_gives_the_smaller_of_peak_and_stall_torque():
    low = load_design("hyperleg", overrides={"electrical.voltage_ratio": 0.5})
    envelope = motor_envelope(low)
    lower, upper = torque_limits(envelope, 0.0)
    np.testing.assert_array_equal(envelope.standstill_torque, upper)
    np.testing.assert_array_equal(motor_arrays(low).standstill_torque, upper)
    np.testing.assert_array_equal(-lower, upper)
    np.testing.assert_allclose(upper[3:5], [2.68, 0.5 * 2.938], rtol=1e-3)  # peak, stall
    ankle = envelope.select([4])
    assert torque_limits(ankle, -0.3 * ankle.no_load_speed)[1] == ankle.peak_torque  # it brakes
