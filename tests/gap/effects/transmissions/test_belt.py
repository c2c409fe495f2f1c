import dataclasses

import numpy as np
from pendulum import ROTOR, Wrong, misfit, run

from hyperleg_design.gap.effects.transmissions import belt
from hyperleg_design.gap.signals.conditioning import condition


def test_load_is_the_torque_of_the_link_alone(pendulum):
    signals = pendulum(Wrong())
    needed = signals.rigid[:, 0] - ROTOR * signals.acceleration[:, 0]
    away = slice(100, -100)
    assert np.abs(belt.load(signals, 0) - needed)[away].max() < 0.02 * np.abs(needed).max()


def test_a_belt_that_stiffens_stretches_by_the_root_of_its_cubic(pendulum):
    signals = pendulum(Wrong())
    load, compliance, stiffening = (
        belt.load(signals, 0),
        np.array([0.05, 0.05]),
        np.array([0.0, 30.0]),
    )
    straight, found = belt.stretch(signals, load, 0, compliance, np.zeros(2), stiffening)
    np.testing.assert_allclose(found * (1 + (30.0 * found) ** 2), straight, atol=1e-12)
    assert np.abs(found).max() < 0.8 * np.abs(straight).max()


def test_joints_that_rub_behind_a_belt_turn_round_later_than_their_rotors(pendulum):
    subject = dataclasses.replace(pendulum(Wrong()).subject, coulomb=np.array([0.8]))
    signals = condition(run(Wrong(coulomb=0.8, compliance=0.03, motor_side=True)), subject)
    compliance, ratio = np.full(1, 0.03), np.full(1, 0.05)
    own, needed = (
        belt.stretch(signals, through, 0, compliance, ratio)
        for through in (belt.given(signals, 0), belt.load(signals, 0))
    )
    behind = belt.trace(signals, 0, own, np.ones(1), np.ones(1))
    assert misfit(signals, behind) < 0.5 * misfit(
        signals, belt.trace(signals, 0, needed, np.ones(1))
    )
    nothing = belt.trace(signals, 0, 0 * own, np.ones(1), np.ones(1))["motion"]
    assert not nothing.any(), "another law of friction alone is no belt"


def test_friction_before_a_belt_is_in_neither_its_load_nor_what_stretches_it(pendulum):
    subject = dataclasses.replace(
        pendulum(Wrong()).subject, coulomb=np.array([0.8]), viscous=np.array([0.1])
    )
    signals = condition(run(Wrong()), subject)
    rubs = (
        0.8 * np.tanh(signals.velocity[:, 0] / subject.friction_speed[0])
        + 0.1 * signals.velocity[:, 0]
    )
    away = slice(100, -100)
    for with_it, without in (
        (belt.load(signals, 0), belt.frictionless(signals, 0)),
        (belt.given(signals, 0), belt.given(signals, 0, rubs=False)),
    ):
        assert np.std((with_it - without - rubs)[away]) < 0.15 * np.std(
            rubs[away]
        )  # all but what is too fast for belts


def test_side_one_is_another_posture(pendulum):
    signals = pendulum(Wrong())
    moved = np.full((1, len(signals.time)), 0.02)
    found = belt.trace(signals, 0, moved, np.ones(1))["motion"][0, :, 0]
    from pendulum import LENGTH, MASS

    expected = (
        MASS
        * 9.81
        * LENGTH
        * (np.sin(signals.position[:, 0] - 0.02) - np.sin(signals.position[:, 0]))
    )
    np.testing.assert_allclose(found, expected, atol=1e-6)
    assert np.abs(belt.trace(signals, 0, moved, np.zeros(1))["motion"]).max() < 1e-9


def test_a_rotors_own_speed_tells_what_it_gives_its_belt(pendulum):
    wrong, sees = Wrong(compliance=0.01), ("motor_torque", "motor_velocity")
    blind, seeing = pendulum(wrong, gains=(8.0, 0.3)), pendulum(wrong, gains=(8.0, 0.3), sees=sees)
    assert belt.transmitted(blind, 0) is belt.load(blind, 0)
    stretched = np.cumsum(seeing.residual["transmission"][:, 0]) * seeing.step
    away = slice(100, -100)
    through, needed = (
        values[away] - values[away].mean()
        for values in (belt.transmitted(seeing, 0), belt.load(seeing, 0))
    )
    stretched = stretched[away] - stretched[away].mean()
    # compliance is what relates the two, all along
    assert np.std(stretched - 0.01 * through) < 0.1 * np.std(stretched)
    assert np.std(stretched - 0.01 * through) < np.std(stretched - 0.01 * needed)
