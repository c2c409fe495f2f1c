"""Torques by constant matrices against the equations that they stand for."""

from __future__ import annotations

import numpy as np

from hyperleg_design.gap.model.recursion import inertial_wrench


def test_wrench_of_a_body_is_that_of_newton_and_euler():
    rng = np.random.default_rng(4)
    mass, centre, root = 1.7, rng.standard_normal(3), rng.standard_normal((3, 3))
    inertia = root @ root.T
    xx, xy, yy, xz, yz, zz = inertia[(0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2)]
    parameters = np.array([mass, *(mass * centre), xx, xy, yy, xz, yz, zz])
    spin, angular, linear = rng.standard_normal((3, 3))
    x, y, z = spin
    products = np.array([x * x, y * y, z * z, x * y, x * z, y * z])
    found = inertial_wrench(parameters) @ np.concatenate([spin, angular, linear, products])
    at_centre = linear + np.cross(angular, centre) + np.cross(spin, np.cross(spin, centre))
    moment = inertia @ angular + np.cross(spin, inertia @ spin) + mass * np.cross(centre, linear)
    np.testing.assert_allclose(found, np.concatenate([mass * at_centre, moment]))
