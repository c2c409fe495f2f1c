import numpy as np
from pendulum import Wrong

from hyperleg_design.gap.effects import placing
from hyperleg_design.gap.signals.conditioning import limited_torque


def test_changes_of_measured_motors_show_in_the_drive_and_others_in_motion(pendulum):
    change = np.ones((2, 1600))
    seen, unseen = pendulum(Wrong()), pendulum(Wrong(), sees=())
    assert set(placing.before_measurement(seen, {0: change})) == {"drive"}
    assert np.all(placing.before_measurement(seen, {0: change})["drive"] == 1)
    assert set(placing.before_measurement(unseen, {0: change})) == {"motion"}
    assert np.all(placing.before_measurement(unseen, {0: change})["motion"] == -1)


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
