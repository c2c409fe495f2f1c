import dataclasses

import numpy as np
from pendulum import Wrong, misfit, run

from hyperleg_design.gap.effects.transmissions import belt
from hyperleg_design.gap.effects.transmissions import slack as dead_zone
from hyperleg_design.gap.model.machine import rotor
from hyperleg_design.gap.signals.conditioning import condition


def test_stretch_is_compliance_times_load_and_play_is_bounded(pendulum):
    signals = pendulum(Wrong())
    compliance = np.array([0.0, 0.01, 0.02])
    found = belt.stretch(signals, belt.load(signals, 0), 0, compliance, np.zeros(3))
    np.testing.assert_allclose(found, compliance[:, None] * belt.load(signals, 0))
    slack = dead_zone.slack(signals, 0, np.array([0.0, 0.02]), np.zeros(2), np.ones(2))
    assert np.abs(slack[0]).max() == 0
    assert np.abs(slack[1]).max() == 0.01
    assert np.mean(np.abs(slack[1]) > 0.0099) > 0.5


def test_a_joint_left_behind_in_its_play_is_slowed_by_its_own_friction(pendulum):
    slow = (15.0, 0.5)
    subject = dataclasses.replace(pendulum(Wrong(), gains=slow).subject, coulomb=np.array([0.5]))
    rubbing = condition(run(Wrong(coulomb=0.5, play=0.04, motor_side=True), gains=slow), subject)
    gliding = pendulum(Wrong(play=0.04, motor_side=True), gains=slow)
    width, on, off = np.full(1, 0.04), np.ones(1), np.zeros(1)

    def left(signals, behind):
        return misfit(
            signals,
            belt.trace(
                signals, 0, dead_zone.slack(signals, 0, width, on, on, behind), on, behind=behind
            ),
        )

    assert left(rubbing, on) < 0.8 * left(rubbing, off)
    assert left(gliding, off) < 0.5
    np.testing.assert_allclose(
        dead_zone.slack(gliding, 0, width, on, on, on),
        dead_zone.slack(gliding, 0, width, on, on, off),
        atol=1e-12,
    )  # it has none


def test_a_rotor_that_does_not_coast_lies_where_the_load_pushes_it(pendulum):
    signals = pendulum(Wrong())
    pushed, half = (
        dead_zone.slack(signals, 0, np.full(1, 0.02), np.zeros(1), np.full(1, c))[0]
        for c in (0.0, 0.5)
    )
    load = belt.load(signals, 0)
    heavy = np.abs(load) > 1.5 * np.sqrt(np.mean(load**2))
    assert heavy.any()
    np.testing.assert_allclose(pushed[heavy], 0.01 * np.sign(load[heavy]), atol=0.002)
    coasts = dead_zone.slack(signals, 0, np.full(1, 0.02), np.zeros(1), np.ones(1))[0]
    np.testing.assert_allclose(half, (pushed + coasts) / 2, atol=1e-12)


def test_a_rotor_that_rubs_crosses_its_play_when_its_friction_lets_it(pendulum):
    signals = pendulum(Wrong())
    subject = dataclasses.replace(signals.subject, coulomb=np.array([0.4]), viscous=np.zeros(1))
    rubbing = dataclasses.replace(signals, subject=subject)
    half, step = 0.01, signals.step
    inertia = rotor(subject, 0)
    torque = np.nan_to_num(dead_zone._rotor_alone(rubbing, 0)) * inertia
    rotor_speed = rubbing.velocity[:, 0] * subject.joint_from_motor[0, 0]
    place, speed, places = half if torque[0] > 0 else -half, 0.0, []
    for tick in range(len(rotor_speed)):  # the rotor's own equation of motion, with dry friction
        speed += step * torque[tick] / inertia
        own = rotor_speed[tick] + speed
        own = np.sign(own) * max(abs(own) - step * 0.4 / inertia, 0.0)
        speed = own - rotor_speed[tick]
        place += step * speed
        if abs(place) > half:
            place = np.sign(place) * half
            if place * speed > 0:
                speed *= -dead_zone.RESTITUTION
        places.append(place)
    width, on = np.full(1, 2 * half), np.ones(1)
    found = dead_zone.slack(rubbing, 0, width, 0 * on, on, 0 * on)[0]
    np.testing.assert_allclose(found, places, atol=1e-9)
    assert np.abs(found - dead_zone.slack(rubbing, 0, width, 0 * on, on, on)[0]).max() > half
