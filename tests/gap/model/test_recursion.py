"""Torques by constant matrices against the equations that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.model.mechanism import BASE, Mechanism
from hyperleg_design.gap.model.recursion import (
    ANGULAR,
    LINEAR,
    frame_motions,
    inertial_wrench,
    on_parent,
)

T = 6


def rotation(rng):
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return axes * np.sign(np.linalg.det(axes))


def one_joint(hinge, rotation, offset):
    none = np.zeros((0, 3))
    return Mechanism(
        floating=True,
        joints=("joint",),
        parent=np.array([BASE]),
        rotation=rotation[None],
        offset=offset[None],
        hinge=np.array([hinge]),
        reference=np.zeros(1),
        inertial=np.zeros((1, 10)),
        base_inertial=np.zeros(10),
        links=(),
        link_joint=np.zeros(0, int),
        link_rotation=np.zeros((0, 3, 3)),
        link_offset=none,
        link_inertial=np.zeros((0, 10)),
    )


@pytest.fixture(params=[True, False], ids=["hinge", "slide"])
def tree(request):
    rng = np.random.default_rng(1)
    return one_joint(request.param, rotation(rng), rng.normal(size=3))


def moved(tree, q, v, a, root):
    return frame_motions(tree, *(x[None] for x in (q, v, a, np.sin(q), np.cos(q))), root, [0])[0]


def test_a_wrench_does_the_same_work_in_the_frame_above(tree):
    """A twist of both links together, the joint at rest."""
    rng = np.random.default_rng(2)
    q, wrench, root = rng.normal(size=T), rng.normal(size=(6, T)), rng.normal(size=(9, T))
    root[:3] = 0.0  # accelerations from rest transform as velocities do
    below = moved(tree, q, np.zeros(T), np.zeros(T), root)
    upper = on_parent(tree, 0, wrench.copy(), q, np.sin(q), np.cos(q))
    np.testing.assert_allclose(
        np.sum(upper * root[[6, 7, 8, 3, 4, 5]], 0),
        np.sum(wrench[:3] * below[LINEAR] + wrench[3:] * below[ANGULAR], 0),
        atol=1e-12,
    )


def test_a_joint_alone_accelerates_along_its_axis(tree):
    a, zero = np.linspace(-1, 1, T), np.zeros(T)
    found = moved(tree, zero, zero, a, np.zeros((9, T)))
    own, other = (ANGULAR, LINEAR) if tree.hinge[0] else (LINEAR, ANGULAR)
    np.testing.assert_array_equal(found[own], [zero, zero, a])
    np.testing.assert_array_equal(found[other], 0.0)


def test_what_slides_outward_on_a_spinning_link_feels_coriolis_and_centripetal_terms():
    flat = one_joint(False, np.eye(3), np.zeros(3))
    w, v, q = 2.0, 0.5, 0.3
    root, ones = np.zeros((9, T)), np.ones(T)
    root[0] = w
    found = moved(flat, q * ones, v * ones, 0 * ones, root)[LINEAR]
    np.testing.assert_allclose(found[1], -2 * w * v)
    np.testing.assert_allclose(found[2], -(w**2) * q)


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
