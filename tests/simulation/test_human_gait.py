"""The cycle passes through its knots, its rates are its derivative, and the distance is that to the
nearest phase.
"""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.simulation import human_gait
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.human_gait import ANGLE, KNOTS, PERIOD, PHASES, RATE, SHARES
from hyperleg_design.simulation.layout import layout_of
from hyperleg_design.simulation.tasks import load_task


@pytest.fixture(scope="module")
def joints(hyperleg):
    return layout_of(hyperleg).joints


def test_angles_pass_through_the_knots_and_rates_are_their_derivative(joints):
    places, phases = human_gait.cycle(joints)
    names = [joints[i].split("_", 1) for i in places]
    angle, rate = phases[:, : len(places)] * ANGLE, phases[:, len(places) :] * RATE
    share = np.arange(PHASES) / PHASES
    for k, (side, name) in enumerate(names):
        shift = PHASES // 2 / PHASES if side == "right" else 0.0
        for at, degrees in zip(SHARES, KNOTS[name], strict=True):
            found = np.interp(
                (at / 100 + shift) % 1, np.r_[share, 1], np.r_[angle[:, k], angle[0, k]]
            )
            assert np.rad2deg(found) == pytest.approx(degrees, abs=4.0)
    middle = (np.roll(angle, -1, 0) - np.roll(angle, 1, 0)) / (2 * PERIOD / PHASES)
    np.testing.assert_allclose(rate, middle, atol=0.6)


def test_a_human_walk_by_the_textbook(joints):
    places, phases = human_gait.cycle(joints)
    knee = [joints[i] for i in places].index("left_knee")
    flexion = np.rad2deg(phases[:, knee] * ANGLE)
    assert flexion[0] < 20
    assert flexion[int(0.2 * PHASES) : int(0.42 * PHASES)].mean() < 25
    assert 50 < flexion.max() < 70


def test_distance_is_zero_on_the_cycle_and_grows_beside_it(joints):
    places, phases = human_gait.cycle(joints)
    position, velocity = np.zeros((2, PHASES, len(joints)))
    position[:, places] = phases[:, : len(places)] * ANGLE
    velocity[:, places] = phases[:, len(places) :] * RATE
    on = human_gait.distance(joints, position, velocity)
    np.testing.assert_allclose(on, 0.0, atol=1e-6)
    near = human_gait.distance(joints, position + 0.1, velocity)
    standing = human_gait.distance(joints, np.zeros((1, len(joints))), np.zeros((1, len(joints))))
    assert near.max() < standing[0]


def test_mirrored_states_are_as_far_away(joints):
    rng = np.random.default_rng(0)
    position, velocity = rng.normal(size=(2, 20, len(joints)))
    half = len(joints) // 2
    mirrored = [np.roll(values, half, axis=1) for values in (position, velocity)]
    ahead = human_gait.distance(joints, position, velocity)
    np.testing.assert_allclose(human_gait.distance(joints, *mirrored), ahead, rtol=1e-9)


def test_episodes_start_in_mid_stride_at_walking_speed(hyperleg):
    task = load_task("walk")
    start = type(task.start)(stride_share=1.0, joint_position=0.0)
    environment = Environment(hyperleg, task.changed(start=start), simulations=32, threads=1)
    environment.reset()
    motion = [chunk.motion for chunk in environment.chunks]
    position, velocity, speed = (
        np.concatenate([getattr(m, name) for m in motion])
        for name in ("joint_position", "joint_velocity", "walking_velocity")
    )
    away = human_gait.distance(environment.layout.joints, position, velocity)
    np.testing.assert_allclose(
        away, 0.0, atol=0.15
    )  # the default posture of other joints is theirs
    assert np.all((speed[:, 0] > 1.0) & (speed[:, 0] < 1.5))
    np.testing.assert_allclose(speed[:, 1], 0.0, atol=0.05)
    environment.close()


def test_distance_at_a_phase_is_zero_there_and_never_below_the_nearest(joints):
    places, phases = human_gait.cycle(joints)
    position, velocity = np.zeros((2, PHASES, len(joints)))
    position[:, places] = phases[:, : len(places)] * ANGLE
    velocity[:, places] = phases[:, len(places) :] * RATE
    phase = np.arange(PHASES) / PHASES
    on = human_gait.distance_at(joints, position, velocity, phase)
    np.testing.assert_allclose(on, 0.0, atol=1e-6)
    away = human_gait.distance_at(joints, position, velocity, phase + 0.3)
    assert (away > human_gait.distance(joints, position, velocity) + 0.5).all()


def test_standing_and_quick_half_steps_are_far_from_the_cycle(joints):
    """A pull that pays for standing still, or for quick small steps, teaches those."""
    places, phases = human_gait.cycle(joints)
    count = len(places)
    position, velocity = np.zeros((2, PHASES, len(joints)))
    angle = phases[:, :count] * ANGLE
    position[:, places] = angle.mean(0)
    standing = human_gait.distance(joints, position, velocity)
    assert np.exp(-(standing**2)).mean() < 0.25
    phase = np.arange(PHASES) / PHASES
    assert np.exp(-(human_gait.distance_at(joints, position, velocity, phase) ** 2)).mean() < 0.15
    position[:, places] += (angle - angle.mean(0)) / 2
    velocity[:, places] = phases[:, count:] * RATE
    quick = human_gait.distance_at(joints, position, velocity, 2 * phase)
    assert np.exp(-(quick**2)).mean() < 0.3
