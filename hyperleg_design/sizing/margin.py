"""How far an operating point is from the limits of the motors that joints share.

Two measures, both exact, of the motor torques that give the joint torque as easily as possible:

- `load`, the smallest factor k by which the motors' limits can be scaled and still give it: 1 on
  the boundary, 0.5 when half of the motors' torque would do. A motor past its no-load speed must
  brake; the least braking is not scaled, and where too little braking is asked of it the load is
  infinite.
- `slack`, the torque by which every motor's limits can be tightened from both sides and still give
  it [Nm]; negative outside, where it says by how much they are too narrow.

With as many motors as joints both are read off the motor torques M^-1 torque; with more motors, off
the facets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.sizing.envelope import MotorEnvelope
from hyperleg_design.sizing.zonotope import check_set, facets, speed_dependent


@dataclass(frozen=True, eq=False)
class Margin:
    """Margins of operating points, `(...)` each."""

    load: np.ndarray
    """Share of the motors' limits in use [-]; at most 1 inside, `inf` where no scaling helps."""
    slack: np.ndarray
    """Torque that every motor has to spare, both ways [Nm]; negative outside."""
    motor: np.ndarray
    """Index of the motor that sets `load`; where several set it together, the one that does most of
    the work."""

    @property
    def inside(self) -> np.ndarray:
        """Whether the motors can give the torque, to rounding."""
        return self.load <= 1 + 1e-9

    @property
    def worst(self) -> int:
        """Flat index of the highest load."""
        return int(np.argmax(self.load))


def margin(matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray, torque: np.ndarray) -> Margin:
    """Distance of joint torques from the limits of the motors.

    Args:
        matrix: `(..., joints, motors)` [-].
        lower: `(..., motors)` [Nm].
        upper: `(..., motors)` [Nm].
        torque: `(..., joints)` [Nm].

    Returns:
        Margins, `(...)`.

    Raises:
        InputError: shapes that do not fit, or M does not reach every joint.
    """
    check_set(matrix, lower, upper)
    lower, upper, torque = (
        np.asarray(lower, float),
        np.asarray(upper, float),
        np.asarray(torque, float),
    )
    if torque.shape[-1:] != matrix.shape[-2:-1] or not np.isfinite(torque).all():
        raise InputError(
            "margin",
            "torque",
            torque.shape,
            f"expects finite numbers, shape (..., {matrix.shape[-2]})",
        )
    normal, weight = facets(matrix)
    demand = np.einsum("...fj,...j->...f", normal, torque)
    bound = np.maximum(weight * lower[..., None, :], weight * upper[..., None, :])
    real = np.any(weight != 0, -1)
    reach = np.maximum(np.abs(lower), np.abs(upper))
    # a limit with zero on its far side is negative here: the least braking, which does not scale
    scaled, fixed = np.maximum(bound, 0).sum(-1), np.minimum(bound, 0).sum(-1)
    wanted = demand - fixed
    negligible = 1e-12 * np.maximum(reach.max(-1), 1e-12)[..., None]
    ratio = np.where(
        scaled > negligible,
        wanted / np.where(scaled > negligible, scaled, 1.0),
        np.where(wanted > 1e3 * negligible, np.inf, 0.0),
    )
    ratio = np.where(real, ratio, -np.inf)
    forced = np.where(
        lower * upper > 0,
        np.minimum(np.abs(lower), np.abs(upper)) / np.where(reach > 0, reach, 1.0),
        0.0,
    ).max(-1)
    critical = np.argmax(ratio, -1)
    slack = np.where(real, bound.sum(-1) - demand, np.inf).min(-1)
    work = np.broadcast_to(
        np.abs(bound) + negligible[..., None] * np.abs(weight), (*ratio.shape, weight.shape[-1])
    )
    return Margin(
        load=np.maximum(ratio.max(-1), forced),
        slack=np.minimum(slack, (upper - lower).min(-1) / 2),
        motor=np.argmax(np.take_along_axis(work, critical[..., None, None], -2)[..., 0, :], -1),
    )


def trajectory_margin(
    matrix: np.ndarray, envelope: MotorEnvelope, torque: np.ndarray, velocity: np.ndarray
) -> Margin:
    """Margins along a motion, with each motor's limits at its speed of the moment.

    Args:
        matrix: `(joints, motors)`, or `(t, joints, motors)` where it changes with posture [-].
        envelope: of the motors, `(motors,)`.
        torque: `(t, joints)` [Nm].
        velocity: `(t, joints)` [rad/s].

    Returns:
        Margins, `(t,)`.

    Raises:
        InputError: shapes that do not fit, non-finite numbers.
    """
    torque, velocity = np.asarray(torque, float), np.asarray(velocity, float)
    if (
        velocity.shape != torque.shape
        or velocity.shape[-1:] != matrix.shape[-2:-1]
        or not np.isfinite(velocity).all()
    ):
        raise InputError(
            "margin",
            "velocity",
            velocity.shape,
            f"expects finite numbers, the shape of torque, (..., {matrix.shape[-2]})",
        )
    lower, upper = speed_dependent(envelope, matrix, velocity)
    return margin(matrix, lower, upper, torque)


__all__ = ["Margin", "margin", "trajectory_margin"]
