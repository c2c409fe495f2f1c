from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from hyperleg_design.simulation.state import read_motion, to_world, to_yaw_frame


def coordinates(count: int, joints: int = 4) -> tuple[np.ndarray, np.ndarray, Rotation]:
    rng = np.random.default_rng(0)
    turned = Rotation.random(count, random_state=1)
    position = np.column_stack(
        [
            rng.normal(size=(count, 3)),
            np.roll(turned.as_quat(), 1, axis=1),
            rng.normal(size=(count, joints)),
        ]
    )
    return position, rng.normal(size=(count, 6 + joints)), turned


def test_rotations_are_scipys() -> None:
    position, velocity, turned = coordinates(50)
    motion = read_motion(position, velocity)
    np.testing.assert_allclose(motion.rotation, turned.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(motion.gravity, turned.inv().apply([0, 0, -1]), atol=1e-12)
    np.testing.assert_allclose(
        motion.local_velocity, turned.inv().apply(velocity[:, :3]), atol=1e-12
    )
    np.testing.assert_allclose(motion.yaw_rate, turned.apply(velocity[:, 3:6])[:, 2], atol=1e-12)


def test_yaw_frame_there_and_back() -> None:
    motion = read_motion(*coordinates(50)[:2])
    vectors = np.random.default_rng(2).normal(size=(50, 2))
    np.testing.assert_allclose(
        to_world(motion.heading, to_yaw_frame(motion.heading, vectors)), vectors, atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.norm(motion.heading, axis=1), 1.0, atol=1e-12)


def test_rows_are_overwritten_where_asked() -> None:
    one, other = (
        read_motion(*coordinates(6)[:2]),
        read_motion(*(values + 1.0 for values in coordinates(6)[:2])),
    )
    before = one.joint_position.copy()
    one.put(np.array([1, 4]), read_motion(*(values[[1, 4]] + 1.0 for values in coordinates(6)[:2])))
    np.testing.assert_array_equal(one.joint_position[[1, 4]], other.joint_position[[1, 4]])
    np.testing.assert_array_equal(one.joint_position[[0, 2, 3, 5]], before[[0, 2, 3, 5]])
