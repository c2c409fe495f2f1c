"""Inertia of point masses."""

from __future__ import annotations

import numpy as np

from hyperleg_design.robot.mass.bodies import shifted


def test_points_of_a_sphere_make_its_inertia():
    """Of a shell, 2/3 m r^2 about each axis."""
    rng = np.random.default_rng(0)
    points = rng.standard_normal((200_000, 3))
    points *= 0.3 / np.linalg.norm(points, axis=1, keepdims=True)
    inertia = shifted(np.full(len(points), 2.0 / len(points)), points).sum(0)
    np.testing.assert_allclose(inertia, np.eye(3) * 2 / 3 * 2.0 * 0.3**2, atol=5e-4)


def test_a_point_turns_about_no_axis_through_itself():
    offset = np.array([0.1, -0.2, 0.4])
    inertia = shifted(3.0, offset)
    np.testing.assert_allclose(inertia @ offset, 0.0, atol=1e-15)
    np.testing.assert_allclose(np.trace(inertia), 2 * 3.0 * offset @ offset)


def test_a_batch_is_its_points():
    rng = np.random.default_rng(1)
    masses, offsets = rng.uniform(0.1, 2.0, 5), rng.standard_normal((5, 3))
    together = shifted(masses, offsets)
    for mass, offset, inertia in zip(masses, offsets, together, strict=True):
        np.testing.assert_array_equal(shifted(mass, offset), inertia)
