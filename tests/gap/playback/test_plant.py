"""Simulations of a nominal robot against its equation of motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hyperleg_design.gap.playback.plant import Plant, motor_tendons
from hyperleg_design.gap.signals.loading import load_subject

STEP = 1e-3
INERTIA, GRAVITY, DAMPING = 0.0006 + 0.5 * 0.1**2 + 0.003, 0.5 * 9.81 * 0.1, 0.02
"""Of the pendulum: about its joint [kg m^2], largest torque of gravity [Nm], viscous [Nms/rad]."""


@pytest.fixture(scope="module")
def pendulum(robot_files):
    return load_subject(robot_files["pendulum"])


def swung(subject, position, torque, ticks, step=STEP, velocity=None):
    """Positions and velocities of windows `(ticks + 1, w)` under torques from time."""
    plant = Plant(subject, (), len(position), step)
    start = np.zeros(len(position)) if velocity is None else np.array(velocity)
    plant.start(np.array(position)[:, None], start[:, None], None, None)
    rows = [tuple(x[:, 0].copy() for x in plant.measured())]
    for tick in range(ticks):
        now = np.broadcast_to(torque(tick * step), (len(position), 1))
        plant.step("torque", now, None, None)
        rows.append(tuple(x[:, 0].copy() for x in plant.measured()))
    return (np.array(x) for x in zip(*rows, strict=True))


def test_a_pendulum_moves_as_its_equation_of_motion_says(pendulum):
    ticks, starts = 800, [-1.0, 0.4, 2.5]

    def torque(time):
        return 0.2 * np.sin(7 * time)

    position, _ = swung(pendulum, starts, torque, ticks)
    for window, start in enumerate(starts):
        found = solve_ivp(
            lambda t, y: (
                y[1],
                (torque(t) - DAMPING * y[1] - GRAVITY * np.sin(y[0])) / INERTIA,
            ),
            (0, ticks * STEP),
            (start, 0.0),
            t_eval=np.arange(ticks + 1) * STEP,
            rtol=1e-9,
            atol=1e-9,
        )
        assert np.abs(position[:, window] - found.y[0]).max() < 0.02


def test_energy_is_kept_without_friction_and_lost_to_it(pendulum):
    def energy(subject):
        position, velocity = swung(subject, [1.2], lambda _: 0.0, 1500)
        return (0.5 * INERTIA * velocity**2 - GRAVITY * np.cos(position))[:, 0], velocity[:, 0]

    free, _ = energy(replace(pendulum, viscous=np.zeros(1)))
    assert np.ptp(free) < 0.02 * GRAVITY
    damped, velocity = energy(pendulum)
    lost = DAMPING * np.sum(velocity**2) * STEP
    assert lost > 0.5 * GRAVITY
    assert damped[0] - damped[-1] == pytest.approx(lost, rel=0.03)


@pytest.mark.parametrize("viscous", [1.0, 100.0, 1e5])
def test_no_friction_is_too_large_for_a_step(pendulum, viscous):
    stiff = replace(pendulum, viscous=np.array([viscous]))
    _, velocity = swung(stiff, [0.0], lambda _: 0.0, 50, step=0.005, velocity=[3.0])
    assert np.isfinite(velocity).all()
    size = np.abs(velocity[:, 0])
    assert size[0] == pytest.approx(3.0)
    assert (size <= 3.0).all()
    assert size[-1] < 0.1


def test_windows_do_not_know_of_each_other(pendulum):
    starts = [-1.0, 0.4, 2.5]
    together, _ = swung(pendulum, starts, lambda _: 0.1, 50)
    for window, start in enumerate(starts):
        alone, _ = swung(pendulum, [start], lambda _: 0.1, 50)
        np.testing.assert_array_equal(alone[:, 0], together[:, window])


def test_a_window_that_diverges_is_lost_alone(pendulum):
    plant = Plant(pendulum, (), 3, 0.005)
    plant.start(np.zeros((3, 1)), np.zeros((3, 1)), None, None)
    for _ in range(20):
        plant.step("torque", np.array([[0.01], [1e9], [0.01]]), None, None)
    position, _ = plant.measured()
    assert plant.alive.tolist() == [0, 2]
    assert np.isnan(position[1]).all()
    assert position[0] == position[2] != 0.0


def test_joints_stop_at_their_ends_unless_they_are_told_not_to(robot_files, tmp_path):
    path = tmp_path / "stopped.xml"
    text = robot_files["pendulum"].read_text()
    path.write_text(text.replace('axis="0 1 0"', 'axis="0 1 0" range="-20 20" limited="true"'))
    subject = load_subject(path)
    ends = []
    for unlimited in (None, np.array([True])):
        plant = Plant(subject, (), 1, STEP, unlimited)
        plant.start(np.zeros((1, 1)), np.zeros((1, 1)), None, None)
        for _ in range(600):
            plant.step("torque", np.full((1, 1), 0.45), None, None)
        ends.append(abs(plant.measured()[0][0, 0]))
    assert ends[0] == pytest.approx(np.radians(20), abs=0.05)
    assert ends[1] > np.radians(40)
    assert subject.model.jnt_limited.all()


def test_rotors_of_coupled_motors_are_tendons(robot_files, pendulum):
    assert motor_tendons(pendulum) == 0
    assert motor_tendons(load_subject(robot_files["coupled"])) == 2
