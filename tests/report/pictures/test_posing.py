"""Where a recorded robot is, seen along its way."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from hyperleg_design.report.pictures.posing import level, travel


def moving(yaw, way):
    """A base that goes straight along `way` [m] and faces `yaw` [rad]."""
    steps = np.linspace(0, 1, 5)[:, None]
    quaternion = Rotation.from_euler("z", yaw).as_quat()[[3, 0, 1, 2]]
    return SimpleNamespace(
        base_position=np.array([3.0, -2.0, 0.9]) + steps * np.array([*way, 0.0]),
        base_orientation=np.tile(quaternion, (5, 1)),
    )


def test_the_direction_of_travel_is_that_of_the_way_or_the_heading_of_who_stands():
    samples = np.arange(5)
    np.testing.assert_allclose(travel(moving(0.3, (0.0, 2.0)), samples), [0.0, 1.0], atol=1e-12)
    still = moving(0.3, (0.01, 0.0))
    np.testing.assert_allclose(travel(still, samples), [np.cos(0.3), np.sin(0.3)])


def test_seen_from_the_start_a_robot_that_walks_ahead_walks_along_x():
    heading = 2.1
    trial = moving(heading, (4 * np.cos(heading), 4 * np.sin(heading)))
    places, rotations = level(trial, np.arange(5))
    np.testing.assert_allclose(places[:, 0], np.linspace(0, 4, 5), atol=1e-12)
    np.testing.assert_allclose(places[:, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(places[:, 2], 0.9)
    np.testing.assert_allclose(rotations, np.tile(np.eye(3), (5, 1, 1)), atol=1e-12)


def test_a_direction_of_ones_own_turns_places_and_rotations_alike():
    trial = moving(0.0, (1.0, 0.0))
    places, rotations = level(trial, np.array([4]), np.array([0.0, 1.0]))
    np.testing.assert_allclose(places[0], [0.0, -1.0, 0.9], atol=1e-12)
    np.testing.assert_allclose(rotations[0] @ [1, 0, 0], [0.0, -1.0, 0.0], atol=1e-12)
