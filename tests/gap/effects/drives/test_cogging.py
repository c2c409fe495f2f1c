from dataclasses import replace

import numpy as np
from pendulum import Wrong, misfit

from hyperleg_design.gap.effects import effect

COGGING = effect("cogging")


def test_trace_is_what_a_cogging_motor_leaves(pendulum):
    signals = pendulum(Wrong(cosine=0.3, sine=0.2, order=7))
    assert misfit(signals, COGGING.trace(signals, "swing", np.array([[0.3, 0.2, 7.0]]))) < 0.02


def test_starts_find_the_order_and_the_amplitudes(pendulum):
    signals = pendulum(Wrong(cosine=0.3, sine=0.2, order=13))
    np.testing.assert_allclose(COGGING.starts(signals, "swing")[0], [0.3, 0.2, 13.0], atol=0.05)


def test_starts_find_periods_of_a_rotor_behind_a_gear(pendulum):
    signals = pendulum(Wrong(cosine=0.3, sine=0.2, order=54))
    np.testing.assert_allclose(COGGING.starts(signals, "swing")[0], [0.3, 0.2, 54.0], atol=0.1)


def test_a_gear_makes_as_many_more_periods_usual(pendulum):
    subject = pendulum(Wrong()).subject
    geared = replace(subject, gear=np.full(len(subject.motors), -9.0))
    np.testing.assert_allclose(
        COGGING.usual("swing", geared) / COGGING.usual("swing", subject), [1.0, 1.0, 9.0]
    )


def test_simulation_with_it_leaves_its_trace(simulated):
    signals = simulated("cogging", [0.3, 0.2, 7.0])
    assert misfit(signals, COGGING.trace(signals, "swing", np.array([[0.3, 0.2, 7.0]]))) < 0.02


def test_a_coupled_motor_turns_with_both_joints(leg):
    signals = leg(duration=1.5)
    column = signals.subject.joint_from_motor[:, 1]
    wave = 0.1 * np.sin(3 * (signals.position @ column))
    np.testing.assert_allclose(
        COGGING.trace(signals, "m_back", np.array([[0.0, 0.1, 3.0]]))["motion"][0],
        wave[:, None] * column,
        atol=1e-12,
    )


def test_people_read_amplitude_and_phase(pendulum):
    subject = pendulum(Wrong()).subject
    found = COGGING.derived("swing", np.array([0.3, 0.4, 2.0]), subject)
    assert found["amplitude"] == (0.5, "Nm")
    peak = found["phase"][0]
    assert np.isclose(0.3 * np.cos(2 * peak) + 0.4 * np.sin(2 * peak), 0.5)


def test_a_ripple_of_half_a_per_cent_is_usual(pendulum):
    from hyperleg_design.gap.effects.strength import motor_strength

    subject = pendulum(Wrong()).subject
    (usual,) = COGGING.usual_errors(subject, 0.005).values()
    strength = motor_strength(subject, 0)
    np.testing.assert_allclose(usual, [0.005 * strength, 0.005 * strength, 0.0])
    assert not any(spread.any() for spread in COGGING.nuisance_spreads(subject, 0.005).values())
