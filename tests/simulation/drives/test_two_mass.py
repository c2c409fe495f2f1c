"""Two masses on a belt against their differential equation, and what is conserved."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation.drives.chain import Chain
from hyperleg_design.simulation.drives.machine import Machine
from hyperleg_design.simulation.drives.two_mass import Belt, joined

INERTIA, ROTOR, RATIO, STEP = 0.05, 2e-4, 8.0, 0.005


def machine(rotor=ROTOR, ratio=RATIO):
    free = np.array([np.inf])
    return Machine(
        joints=("j",),
        motors=("m",),
        joint_from_motor=np.array([[ratio]]),
        motor_from_joint=np.array([[1 / ratio]]),
        stiffness=np.zeros(1),
        damping=np.zeros(1),
        rotor_inertia=np.array([rotor]),
        no_load_speed=free,
        stall_torque=free,
        peak_torque=free,
        power_constant=np.zeros(1),
        rated_torque=free,
    )


def run(belt, torque, steps, step=STEP, speed=0.0):
    """Joint angle, joint speed and rotor speed at each step, the joint stepped as MuJoCo does."""
    chain = Chain(machine(), (belt,), 1, step)
    own = INERTIA + RATIO**2 * float(chain.machine.rigid_inertia[0])
    q, v = np.zeros((1, 1)), np.full((1, 1), speed)
    seen = []
    for k in range(steps):
        driven = chain.drive(q, v, torque=np.array([[torque(k * step)]]))
        seen.append((q[0, 0], v[0, 0], driven.motor_velocity[0, 0]))
        damping = 0.0 if driven.motor_damping is None else RATIO**2 * driven.motor_damping[0, 0]
        v = (own * v + step * RATIO * driven.transmitted) / (own + step * damping)
        q = q + step * v
    return np.array(seen).T


def stiffness_of(frequency):
    """On the motor's side, such that both masses ring against each other at a frequency [Hz]."""
    return (2 * np.pi * frequency) ** 2 / (RATIO**2 / INERTIA + 1 / ROTOR)


def equation(stiffness, damping, play, torque, steps, step=STEP, stiffening=0.0):
    """Joint angle by scipy."""
    from scipy.integrate import solve_ivp

    def rate(time, state):
        stretch = state[0] - RATIO * state[2]
        beyond = stretch - np.clip(stretch, -play / 2, play / 2)
        pull = stiffness * (1 + (stiffening * beyond) ** 2) * beyond + (
            abs(stretch) > play / 2
        ) * damping * (state[1] - RATIO * state[3])
        return [state[1], (torque(time) - pull) / ROTOR, state[3], RATIO * pull / INERTIA]

    found = solve_ivp(
        rate,
        (0, steps * step),
        np.zeros(4),
        t_eval=np.arange(steps) * step,
        max_step=2e-4,
        rtol=1e-8,
        atol=1e-10,
    )
    return found.y


@pytest.mark.parametrize(("frequency", "play"), [(8.0, 0.0), (25.0, 0.0), (20.0, 0.05)])
def test_the_joint_moves_as_the_differential_equation_says(frequency, play):
    stiffness, step = stiffness_of(frequency), 0.00125
    damping = 0.02 * np.sqrt(stiffness * ROTOR)

    def torque(time):
        return 0.1 * np.sin(2 * np.pi * 3.0 * time)

    steps = round(1.0 / step)
    found = run(Belt("m", 1 / stiffness, play, damping), torque, steps, step)
    expected = equation(stiffness, damping, play, torque, steps, step)
    assert np.abs(found[0] - expected[2]).max() < 0.03 * np.ptp(expected[2])


def test_a_belt_that_stiffens_moves_the_joint_as_its_equation_says():
    stiffness, step, bend = stiffness_of(6.0), 0.00125, 60.0
    damping = 0.02 * np.sqrt(stiffness * ROTOR)

    def torque(time):
        return 1.0 * np.sin(2 * np.pi * 8.0 * time)

    steps = round(0.5 / step)
    found = run(Belt("m", 1 / stiffness, damping=damping, stiffening=bend), torque, steps, step)
    expected = equation(stiffness, damping, 0.0, torque, steps, step, bend)
    straight = equation(stiffness, damping, 0.0, torque, steps, step)
    assert np.abs(found[0] - expected[2]).max() < 0.03 * np.ptp(expected[2])
    assert np.abs(straight[2] - expected[2]).max() > 0.1 * np.ptp(expected[2])


def test_a_resonance_keeps_its_frequency_and_its_energy_at_200_hertz():
    stiffness = stiffness_of(15.0)
    # an even push for half a period leaves both masses ringing
    q, _v, rotor = run(
        Belt("m", 1 / stiffness, 0.0, 0.0), lambda time: 0.2 if time < 0.03 else 0.0, 600
    )
    stretch_speed = rotor - RATIO * np.gradient(q, STEP)
    window = stretch_speed[40:552]
    spectrum = np.abs(np.fft.rfft((window - window.mean()) * np.hanning(len(window)), 8192))
    assert np.fft.rfftfreq(8192, STEP)[np.argmax(spectrum)] == pytest.approx(15.0, rel=0.04)
    early, late = np.ptp(stretch_speed[40:80]), np.ptp(stretch_speed[540:580])
    assert late == pytest.approx(early, rel=0.1)


def test_momentum_is_that_of_the_torque():
    for play, error in ((0.0, 1e-6), (0.1, 0.02)):  # exact where the belt is linear
        _q, v, rotor = run(
            Belt("m", 2e-2, play, 1e-3), lambda time: 0.3 if time < 0.1 else 0.0, 200
        )
        # of the joint's side over the ratio, so that belt torque cancels
        np.testing.assert_allclose(ROTOR * rotor[60:] + INERTIA / RATIO * v[60:], 0.03, rtol=error)


def test_a_stiff_belt_is_a_rigid_one():
    def torque(time):
        return 0.2 * np.sin(2 * np.pi * time)

    rigid = run(Belt("m"), torque, 300)
    plain_machine_step = INERTIA + RATIO**2 * ROTOR
    v = np.cumsum(STEP * RATIO * torque(np.arange(300) * STEP)) / plain_machine_step
    np.testing.assert_allclose(rigid[1][1:], v[:-1], rtol=1e-9, atol=1e-12)
    stiff = run(Belt("m", 1e-4 / stiffness_of(5.0)), torque, 300)
    assert np.abs(stiff[0] - rigid[0]).max() < 0.02 * np.ptp(rigid[0])


def test_play_lets_the_rotor_move_first():
    q, _, rotor = run(Belt("m", play=0.2), lambda time: 0.01, 120)
    turned = np.cumsum(rotor) * STEP
    moved = np.flatnonzero(np.abs(q) > 1e-6)[0]
    # half the play, then the joint follows, pushed by a rotor that bounces
    assert turned[moved] == pytest.approx(0.1, abs=0.012)


def test_simulations_differ_and_rigid_ones_keep_their_rotor():
    belt = Belt("m", compliance=np.array([0.0, 1e-2, 0.0]), play=np.array([0.0, 0.0, 0.1]))
    chain = Chain(machine(), (belt,), 3, STEP)
    assert chain.machine.free[:, 0].tolist() == [False, True, True]
    assert chain.machine.rigid_inertia[:, 0].tolist() == [ROTOR, 0.0, 0.0]
    driven = chain.drive(np.zeros((3, 1)), np.zeros((3, 1)), torque=np.full((3, 1), 0.5))
    assert driven.transmitted[0, 0] == 0.5
    assert driven.motor_damping[0, 0] == 0.0
    assert abs(driven.transmitted[2, 0]) < 0.5


def test_belts_of_one_motor_become_one():
    found = joined(
        [Belt("a", 1.0, 0.1), Belt("b", 1.0), Belt("a", 2.0, 0.2, 0.5), Belt("a", 0.0, 0.0, 0.5)]
    )
    assert [b.motor for b in found] == ["a", "b"]
    assert found[0].compliance == pytest.approx(3.0)
    assert found[0].play == pytest.approx(0.3)
    assert found[0].damping == pytest.approx(0.25)
    assert found[1].damping is None
