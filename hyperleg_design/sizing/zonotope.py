"""The torques that joints can have together: a box of motor torques seen through cooperative
actuation.

Motors with limits `lower <= t <= upper` reach the joint torques `{M t}`, a zonotope. Its support
function, volume and facets have closed forms. With as many motors as joints the facets are the
motor limits themselves, each row of M^-1 a normal; with more motors every facet is spanned by
joints - 1 of M's columns. Shapes: `matrix` `(..., joints, motors)`, `lower` and `upper` `(...,
motors)`; leading dimensions broadcast.

To leave a joint out of account (its torque free), leave its row out of the matrix: that projects
the zonotope.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.transmission import motor_velocity
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope, torque_limits

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design

_PARALLEL = 1e-10
"""Volume spanned by unit columns under which they count as dependent [-]."""

_INSIDE = 1e-9
"""Overshoot that still counts as inside, over the largest motor torque limit [-]."""


def check_set(matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
    """Check that a matrix and limits describe a zonotope.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.

    Raises:
        InputError: shapes that do not fit, non-finite numbers, or a lower limit above its upper
        one.
    """
    joints, motors = np.shape(matrix)[-2:] if np.ndim(matrix) >= 2 else (0, 0)
    shapes = f"{np.shape(matrix)}, {np.shape(lower)}, {np.shape(upper)}"
    if not joints or {np.shape(lower)[-1:], np.shape(upper)[-1:]} != {(motors,)}:
        raise InputError(
            "zonotope",
            "matrix, lower, upper",
            shapes,
            "expects shapes (..., joints, motors), (..., motors), (..., motors)",
        )
    if not (np.isfinite(matrix).all() and np.isfinite(lower).all() and np.isfinite(upper).all()):
        raise InputError("zonotope", "matrix, lower, upper", None, "expects finite numbers")
    if np.any(np.asarray(lower) > np.asarray(upper)):
        raise InputError(
            "zonotope",
            "lower",
            float(np.max(np.asarray(lower) - np.asarray(upper))),
            "must not exceed upper [Nm]",
        )


def support(
    matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray, direction: np.ndarray
) -> np.ndarray:
    """Largest `direction . joint torque` over the set, exactly: sum over motors of max(g lower, g
    upper), g = M^T direction.

    Args:
        matrix: `(..., joints, motors)` [-].
        lower: `(..., motors)` [Nm].
        upper: `(..., motors)` [Nm].
        direction: `(..., joints)`; a unit vector asks for one joint's largest torque.

    Returns:
        `(...)` [Nm] for a dimensionless direction.
    """
    weight = np.einsum("...jm,...j->...m", matrix, direction)
    return np.maximum(weight * lower, weight * upper).sum(-1)


def box(matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the least and largest torque of each joint, whatever the others do.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.

    Returns:
        Least and largest torques [Nm], `(..., joints)` each.
    """
    low, high = matrix * np.asarray(lower)[..., None, :], matrix * np.asarray(upper)[..., None, :]
    return np.minimum(low, high).sum(-1), np.maximum(low, high).sum(-1)


def volume(matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Compute the volume of the set.

    It is the sum of |det| times the torque ranges over all choices of as many motors as joints.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.

    Returns:
        The volume [Nm^joints], `(...)`; zero where motors are fewer than joints.
    """
    check_set(matrix, lower, upper)
    joints, motors = matrix.shape[-2:]
    width = np.asarray(upper) - np.asarray(lower)
    total = np.zeros(np.broadcast_shapes(matrix.shape[:-2], width.shape[:-1]))
    for chosen in combinations(range(motors), joints):
        total = total + np.abs(np.linalg.det(matrix[..., chosen])) * width[..., chosen].prod(-1)
    return total


def zonotope_to_box_volume(matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Compute the volume of the set over that of the box that its joint maxima span.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.

    Returns:
        The ratio [-], `(...)`; 1 where no motor is shared.
    """
    low, high = box(matrix, lower, upper)
    return volume(matrix, lower, upper) / (high - low).prod(-1)


def facets(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the outward normals of the set's facets, which do not depend on the limits.

    Args:
        matrix: M [-], `(..., joints, motors)`.

    Returns:
        `normal` `(..., facets, joints)` and `weight` = M^T normal `(..., facets, motors)`, scaled
        so that the weights' magnitudes sum to 1: the facet is then `normal . torque <= sum
        max(weight lower, weight upper)`, in motor Nm. Rows of zeros are no facets (columns that
        happen to be parallel).

    Raises:
        InputError: M does not reach every joint.
    """
    joints, motors = matrix.shape[-2:]
    unreachable = InputError(
        "zonotope",
        "matrix",
        None,
        f"has no rank {joints}: some joint is driven by no motor of its own",
    )
    if motors < joints:
        raise unreachable
    length = np.linalg.norm(matrix, axis=-2)
    column = matrix / np.where(length > 0, length, 1.0)[..., None, :]
    if motors == joints:
        if np.any(np.abs(np.linalg.det(column)) <= _PARALLEL):
            raise unreachable
        inverse = np.linalg.inv(matrix)
        unit = np.broadcast_to(np.eye(motors), inverse.shape)
        return np.concatenate([inverse, -inverse], -2), np.concatenate([unit, -unit], -2)
    normals, weights = [], []
    for chosen in combinations(range(motors), joints - 1):
        # the generalised cross product of joints - 1 columns: signed minors
        spanning = column[..., chosen]
        minors = [
            (-1) ** row * np.linalg.det(np.delete(spanning, row, -2)) for row in range(joints)
        ]
        normal = np.stack(minors, -1)
        weight = np.einsum("...jm,...j->...m", matrix, normal)
        weight[..., chosen] = 0.0
        total = np.abs(weight).sum(-1, keepdims=True)
        real = (np.linalg.norm(normal, axis=-1, keepdims=True) > _PARALLEL) & (total > _PARALLEL)
        scale = np.where(real, 1.0 / np.where(real, total, 1.0), 0.0)
        normals.append(normal * scale)
        weights.append(weight * scale)
    normal, weight = np.stack(normals, -2), np.stack(weights, -2)
    if not np.all(np.linalg.matrix_rank(column) == joints):
        raise unreachable
    return np.concatenate([normal, -normal], -2), np.concatenate([weight, -weight], -2)


def halfspaces(
    matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Describe the set by inequalities, `normal . torque <= offset`.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.

    Returns:
        Normals as in `facets`, `(..., facets, joints)`, and offsets [motor Nm], `(..., facets)`.
    """
    check_set(matrix, lower, upper)
    normal, weight = facets(matrix)
    offset = np.maximum(
        weight * np.asarray(lower)[..., None, :], weight * np.asarray(upper)[..., None, :]
    ).sum(-1)
    return normal, offset


def contains(
    matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray, torque: np.ndarray
) -> np.ndarray:
    """Decide whether the joints can have torques together.

    Args:
        matrix: M [-], `(..., joints, motors)`.
        lower: least motor torques [Nm], `(..., motors)`.
        upper: largest motor torques [Nm], `(..., motors)`.
        torque: joint torques [Nm], `(..., joints)`.

    Returns:
        True where they can, `(...)`.
    """
    normal, offset = halfspaces(matrix, lower, upper)
    over = np.einsum("...fj,...j->...f", normal, torque) - offset
    return np.all(over <= _INSIDE * np.maximum(np.abs(lower), np.abs(upper)).max(-1)[..., None], -1)


def chord(
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    start: np.ndarray,
    direction: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Where the line `start + s direction` enters and leaves the set.

    Args:
        matrix: `(..., joints, motors)` [-].
        lower: `(..., motors)` [Nm].
        upper: `(..., motors)` [Nm].
        start: a joint torque, `(..., joints)` [Nm]; need not lie in the set.
        direction: `(..., joints)`, not zero.

    Returns:
        `(low, high)` values of s, `(...)` each; nan where the line misses the set.
    """
    normal, offset = halfspaces(matrix, lower, upper)
    room = offset - np.einsum("...fj,...j->...f", normal, start)
    rate = np.einsum("...fj,...j->...f", normal, direction)
    limit = np.maximum(np.abs(lower), np.abs(upper)).max(-1)[..., None]
    along = (
        np.abs(rate)
        > 1e-12
        * np.abs(normal).max((-1, -2))[..., None]
        * np.linalg.norm(direction, axis=-1)[..., None]
    )
    reached = room / np.where(along, rate, 1.0)
    high = np.where(along & (rate > 0), reached, np.inf).min(-1)
    low = np.where(along & (rate < 0), reached, -np.inf).max(-1)
    misses = np.any(~along & (room < -_INSIDE * limit), -1) | (
        low > high + 1e-9 * (np.abs(low) + np.abs(high))
    )
    return np.where(misses, np.nan, low), np.where(misses, np.nan, high)


def alone(
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    joint: int,
    held: Sequence[int] | None = None,
) -> np.ndarray:
    """Compute the largest torque of one joint while others have none.

    Args:
        matrix: `(..., joints, motors)` [-].
        lower: `(..., motors)` [Nm].
        upper: `(..., motors)` [Nm].
        joint: row of the joint.
        held: rows of the joints at zero torque, all others by default; those not named may have any
            torque.

    Returns:
        The torque [Nm], `(...)`; NaN where the others cannot have none (past no-load speed).
    """
    rows = [joint, *(r for r in (range(matrix.shape[-2]) if held is None else held) if r != joint)]
    return chord(matrix[..., rows, :], lower, upper, np.zeros(len(rows)), np.eye(len(rows))[0])[1]


def speed_dependent(
    of: Design | MotorEnvelope, matrix: np.ndarray, joint_velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Motor torque limits while the joints move [Nm].

    Args:
        of: a design or batch, or its `motor_envelope`.
        matrix: `(..., joints, motors)` [-].
        joint_velocity: `(..., joints)` [rad/s].

    Returns:
        `(lower, upper)`, `(..., motors)` each, at the motors' speeds M^T joint_velocity.
    """
    envelope = of if isinstance(of, MotorEnvelope) else motor_envelope(of)
    return torque_limits(envelope, motor_velocity(matrix, joint_velocity))


__all__ = [
    "alone",
    "box",
    "check_set",
    "chord",
    "contains",
    "facets",
    "halfspaces",
    "speed_dependent",
    "support",
    "volume",
    "zonotope_to_box_volume",
]
