from types import SimpleNamespace

import numpy as np
import pytest

from hyperleg_design.gap.model.newton_euler import Motion, child_motion, cross, to_parent

T = 6


def rotation(rng):
    axes, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return axes * np.sign(np.linalg.det(axes))


@pytest.fixture(params=[True, False], ids=["hinge", "slide"])
def tree(request):
    rng = np.random.default_rng(1)
    return SimpleNamespace(
        offset=rng.normal(size=(1, 3)),
        rotation=rotation(rng)[None],
        hinge=np.array([request.param]),
    )


def test_cross_products_are_numpys():
    x, y = np.random.default_rng(0).normal(size=(2, 3, T))
    np.testing.assert_allclose(cross(x, y), np.cross(x, y, axis=0), atol=1e-15)
    np.testing.assert_allclose(cross(x[:, :1], y), np.cross(x[:, :1], y, axis=0), atol=1e-15)


def test_a_wrench_does_the_same_work_in_the_frame_above(tree):
    """A twist of both links together, the joint at rest."""
    rng = np.random.default_rng(2)
    q, force, moment = rng.normal(size=T), rng.normal(size=(3, T)), rng.normal(size=(3, T))
    spin, linear = rng.normal(size=(2, 3, T))
    sin, cos = np.sin(q), np.cos(q)
    # accelerations from rest transform as velocities do
    above = Motion(np.zeros((3, T)), spin, linear)
    zero = np.zeros(T)
    below = child_motion(tree, 0, above, q, zero, zero, sin, cos)
    upper_force, upper_moment = to_parent(tree, 0, force, moment, q, sin, cos)
    np.testing.assert_allclose(
        np.sum(upper_force * linear + upper_moment * spin, 0),
        np.sum(force * below.linear + moment * below.angular, 0),
        atol=1e-12,
    )


def test_a_joint_alone_accelerates_along_its_axis(tree):
    rest = Motion(*np.zeros((3, 3, T)))
    a, zero = np.linspace(-1, 1, T), np.zeros(T)
    moved = child_motion(tree, 0, rest, zero, zero, a, zero, np.ones(T))
    turned, pushed = (
        (moved.angular, moved.linear) if tree.hinge[0] else (moved.linear, moved.angular)
    )
    np.testing.assert_array_equal(turned, [zero, zero, a])
    np.testing.assert_array_equal(pushed, 0.0)


def test_what_slides_outward_on_a_spinning_link_feels_coriolis_and_centripetal_terms():
    flat = SimpleNamespace(
        offset=np.zeros((1, 3)), rotation=np.eye(3)[None], hinge=np.array([False])
    )
    w, v, q = 2.0, 0.5, 0.3
    above = Motion(np.array([[w], [0.0], [0.0]]) * np.ones(T), *np.zeros((2, 3, T)))
    ones, zero = np.ones(T), np.zeros(T)
    moved = child_motion(flat, 0, above, q * ones, v * ones, zero, zero, ones)
    np.testing.assert_allclose(moved.linear[1], -2 * w * v)
    np.testing.assert_allclose(moved.linear[2], -(w**2) * q)
