import numpy as np
import pytest
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect, placing
from hyperleg_design.gap.signals.conditioning import limited_torque


def test_changes_of_measured_motors_show_in_the_drive_and_others_in_motion(pendulum):
    change = np.ones((2, 1600))
    seen, unseen = pendulum(Wrong()), pendulum(Wrong(), sees=())
    assert set(placing.before_measurement(seen, {0: change})) == {"drive"}
    assert np.all(placing.before_measurement(seen, {0: change})["drive"] == 1)
    assert set(placing.before_measurement(unseen, {0: change})) == {"motion"}
    assert np.all(placing.before_measurement(unseen, {0: change})["motion"] == -1)


SENSOR = {"sees": ("joint_torque", "motor_torque_command")}


@pytest.mark.parametrize(
    ("identifier", "wrong", "values", "least"),
    [
        ("coulomb_friction", Wrong(coulomb=0.3), [0.3, 0.0], 0.15),
        ("viscous_friction", Wrong(viscous=0.3), [0.3], 0.15),
        ("stribeck_friction", Wrong(breakaway=0.4, stribeck_speed=0.5), [0.4, 0.5], 0.35),
        ("load_dependent_friction", Wrong(share=0.2), [0.2], 0.35),
        ("rotor_inertia", Wrong(rotor=0.03), [0.03], 0.15),
        ("cogging", Wrong(cosine=0.1, order=20.0), [0.1, 0.0, 20.0], 0.15),
        ("torque_constant", Wrong(constant=0.8), [0.8, 0.0], 0.15),
        ("actuator_bandwidth", Wrong(lag=0.02), [0.02], 0.15),
    ],
)
def test_before_a_sensor_behind_the_gear_drives_show_and_links_do_not(
    pendulum, identifier, wrong, values, least
):
    signals = pendulum(wrong, **SENSOR)
    trace = effect(identifier).trace(signals, "swing", np.array([values]))
    assert set(trace) == {"drive"}
    assert set(effect(identifier).trace(signals, "swing", effect(identifier).nulls[None])) == {
        "drive"
    }
    assert misfit(signals, trace, "drive") < least
    torque = np.std(signals.believed[signals.valid])
    assert np.std(signals.residual["motion"][signals.valid]) < 0.05 * torque


def test_after_a_sensor_behind_the_gear_links_show_and_drives_do_not(pendulum):
    signals = pendulum(Wrong(stiffness=2.0), **SENSOR)
    trace = effect("joint_spring").trace(signals, "swing", np.array([[2.0, 0.0]]))
    assert set(trace) == {"motion"}
    assert misfit(signals, trace) < 0.05
    rows = signals.residual["drive"][signals.valid]
    assert np.std(rows) < 0.02 * np.std(signals.believed[signals.valid])


def test_a_sensor_behind_the_gear_that_reads_too_much_shows_in_both(pendulum):
    signals = pendulum(Wrong(), **SENSOR)
    trace = effect("torque_constant").trace(signals, "swing", np.array([[0.8, 1.0]]))
    lost = 0.2 * signals.believed[:, 0]
    for residual_name in ("motion", "drive"):
        np.testing.assert_allclose(trace[residual_name][0, :, 0], lost)


@pytest.mark.parametrize(
    "identifier", ["backlash", "transmission_elasticity", "transmission_ratio"]
)
def test_gears_before_a_sensor_are_not_judged(pendulum, identifier):
    one, signals = effect(identifier), pendulum(Wrong(), **SENSOR)
    values = one.example("swing", signals.subject)
    assert one.trace(signals, "swing", values[None]) == {}


def test_a_coupled_motor_reaches_its_joints_by_its_column(leg):
    signals = leg(duration=1.0)
    torque = np.random.default_rng(0).normal(size=(3, len(signals.time)))
    found = placing.at_motor(signals, 1, torque)["motion"]
    np.testing.assert_allclose(found, torque[..., None] * signals.subject.joint_from_motor[:, 1])


def test_limits_are_those_of_conditioning():
    from types import SimpleNamespace

    from hyperleg_design.gap.signals.loading import load_subject

    subject = load_subject("hyperleg")
    rng = np.random.default_rng(1)
    velocity, torque = rng.normal(0, 8, (500, 14)), rng.normal(0, 4, (500, 14))
    speed = velocity @ subject.joint_from_motor
    signals = SimpleNamespace(subject=subject, motor_speed=speed, supplied=np.ones((1, 14)))
    for jump in (None, rng.normal(0, 2, (500, 14))):
        signals.jump = jump
        whole = limited_torque(subject, torque.copy(), speed, jump=jump)
        assert not np.allclose(whole, torque)
        for motor in range(14):
            np.testing.assert_allclose(
                placing.limited(signals, motor, torque[:, motor]), whole[:, motor], rtol=1e-10
            )
