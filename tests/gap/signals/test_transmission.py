import numpy as np
import pytest
from diagnosed import run

from hyperleg_design.gap.pipeline.diagnose import diagnose
from hyperleg_design.gap.playback.measure import measure
from hyperleg_design.gap.signals.conditioning import condition
from hyperleg_design.gap.signals.loading import load_subject
from hyperleg_design.gap.signals.transmission import transmission_residual, turned

MOTORS = ("m_front", "m_back")


def with_rotors(robot, log, noise=0.01, **scales):
    """A log with speeds of its motors, some of them `scales` times those that its joints give
    them.
    """
    subject = load_subject(robot, [log])
    spin = condition(log, subject).velocity @ subject.joint_from_motor
    spin = np.stack(
        [np.interp(log.time, condition(log, subject).time, column) for column in spin.T], -1
    )
    rng = np.random.default_rng(4)
    found = {
        f"motor_velocity/{m}": scales.get(m, 1.0) * spin[:, i] + rng.normal(0, noise, len(spin))
        for i, m in enumerate(MOTORS)
    }
    return log.changed(signals={**log.signals, **found})


@pytest.fixture(scope="module")
def subject(robot_files):
    return load_subject(robot_files["coupled"], [run("healthy", 0)])


def test_rotors_that_turn_with_their_joints_leave_nothing(subject):
    velocity = np.random.default_rng(0).normal(size=(50, 2))
    spin = velocity @ subject.joint_from_motor
    residual, refused = transmission_residual(subject, spin, velocity, 0.005)
    np.testing.assert_allclose(residual, 0, atol=1e-12)
    assert refused == ()
    spin[:10, 1] = np.nan
    assert np.isnan(transmission_residual(subject, spin, velocity, 0.005)[0]).sum() == 10


def test_a_rotor_that_swings_on_its_belt_ends_where_its_joints_do_and_is_used(subject):
    time = np.arange(0, 5, 0.005)
    swing = 40 * np.cos(2 * np.pi * 31 * time)
    velocity = np.stack([np.sin(time), np.cos(2 * time)], -1)
    velocity[:, 1] -= 0.05 * swing  # its joint is shaken the other way
    spin = velocity @ subject.joint_from_motor
    spin[:, 1] += swing
    expected = (velocity @ subject.joint_from_motor)[:, 1]
    assert expected @ spin[:, 1] / (expected @ expected) < 0.5  # no gear
    residual, refused = transmission_residual(subject, spin, velocity, 0.005)
    assert refused == ()
    np.testing.assert_allclose(residual[:, 1], swing, atol=1e-12)


@pytest.mark.parametrize("scale", [9.0, -1.0, 0.1])
def test_speeds_of_another_gear_unit_or_sign_are_not_used_and_said(robot_files, scale):
    log = with_rotors(robot_files["coupled"], run("healthy", 0), m_back=scale)
    signals = condition(log, load_subject(robot_files["coupled"], [log]))
    assert np.isnan(signals.residual["transmission"][:, 1]).all()
    assert np.isfinite(signals.residual["transmission"][:, 0]).any()
    assert any("motor_velocity of m_back" in note for note in signals.notes)


def test_logs_without_them_have_no_such_balance(robot_files):
    log = run("healthy", 0)
    signals = condition(log, load_subject(robot_files["coupled"], [log]))
    assert "transmission" not in signals.residual
    assert turned(signals, 0, np.ones((1, len(signals.time)))) == {}


def test_a_healthy_robot_has_no_gap_in_it(robot_files):
    logs = [with_rotors(robot_files["coupled"], run("healthy", s, session="today")) for s in (0, 1)]
    found = diagnose(robot_files["coupled"], logs, threads=1)
    assert found.verdict == "none"
    table = measure(
        [condition(log, load_subject(robot_files["coupled"], [log])) for log in logs], predict=False
    )
    mine = [r for r in table.rows if r.signal == "transmission" and r.regime == "all"]
    assert {(r.location, r.unit, r.kind) for r in mine} == {(m, "rad/s", "motor") for m in MOTORS}
    assert all(r.gap < 2 * r.floor for r in mine)


def geared(robot, log, scale, motor="m_back"):
    """A log of the same motion behind a gear of `scale` times the ratio: rotor and joints pull the
    motor by its own ratio.
    """
    subject = load_subject(robot, [log])
    place, signals = subject.motors.index(motor), condition(log, subject)
    turned = signals.acceleration @ subject.joint_from_motor[:, place]
    rotor = subject.rotor_inertia[place] * np.interp(log.time, signals.time, turned)
    torque = (log.column(f"motor_torque/{motor}") - rotor) / scale + scale * rotor
    return log.changed(signals={**log.signals, f"motor_torque/{motor}": torque})


@pytest.mark.parametrize("speeds", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_ratio_is_told_from_a_torque_constant(robot_files, speeds):
    """A motor that pulls 1.1 times as hard and turns 1.1 times as fast: its rotor's share of the
    torque tells it from a stronger motor, and the speeds of its rotor, where they are logged.
    """
    robot = robot_files["coupled"]
    logs = [geared(robot, run("healthy", s, session="today"), 1.1) for s in (0, 1)]
    if speeds:
        logs = [with_rotors(robot, log, m_back=1.1) for log in logs]
    found = diagnose(robot, logs, threads=1)
    assert [(c.effect, c.location) for c in found.causes] == [("transmission_ratio", "m_back")]
    scale = found.causes[0].parameters["scale"]
    assert scale.low < 1.1 < scale.high
