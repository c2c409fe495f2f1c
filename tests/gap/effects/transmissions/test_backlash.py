import dataclasses

import numpy as np
from pendulum import Wrong, misfit, waves

from hyperleg_design.gap.effects import effect

BACKLASH = effect("backlash")
SOFT = (15.0, 0.5)


def test_trace_is_what_a_dead_zone_leaves_with_encoders_on_either_side(pendulum):
    joint = pendulum(Wrong(play=0.005), gains=SOFT)
    assert misfit(joint, BACKLASH.trace(joint, "swing", np.array([[0.005, 0.0, 1.0, 0.0]]))) < 0.45
    motor = pendulum(Wrong(play=0.02, motor_side=True), gains=SOFT)
    assert misfit(motor, BACKLASH.trace(motor, "swing", np.array([[0.02, 1.0, 1.0, 0.0]]))) < 0.4


def test_angle_is_that_of_the_joint(leg):
    subject = leg(duration=1.0).subject
    ratio = np.abs(subject.joint_from_motor[:, 1]).max()
    assert ratio > 1
    assert (
        BACKLASH.alteration("m_back", np.array([0.01, 0.0, 1.0, 0.0]), subject).play == 0.01 * ratio
    )


def test_simulation_with_it_leaves_its_trace(pendulum):
    from altered import altered

    subject = pendulum(Wrong(), gains=SOFT).subject
    added = BACKLASH.alteration("swing", np.array([0.02, 0.0, 1.0, 0.0]), subject)
    signals = altered(subject, (added,), lambda time: [waves(time)])
    assert (
        misfit(signals, BACKLASH.trace(signals, "swing", np.array([[0.02, 0.0, 1.0, 0.0]]))) < 0.65
    )


def test_rotors_show_it_beside_their_joints(pendulum):
    signals = pendulum(Wrong(play=0.02), gains=SOFT, sees=("motor_torque", "motor_velocity"))
    assert (
        misfit(
            signals,
            BACKLASH.trace(signals, "swing", np.array([[0.02, 0.0, 1.0, 0.0]])),
            "transmission",
        )
        < 0.6
    )


def test_a_trace_does_not_depend_on_what_it_is_computed_beside(pendulum):
    signals = pendulum(Wrong(play=0.02), gains=SOFT)
    rubbing = dataclasses.replace(signals.subject, coulomb=np.array([0.4]))
    signals = dataclasses.replace(signals, subject=rubbing)
    motor = signals.subject.motors[0]
    starts = BACKLASH.starts(signals, motor)
    together = BACKLASH.trace(signals, motor, starts)
    for row, start in enumerate(starts):
        for name, alone in BACKLASH.trace(signals, motor, start[None]).items():
            np.testing.assert_allclose(together[name][row], alone[0], atol=1e-12, err_msg=name)
