"""Contact forces and motor torques of least Joule heat for a given motion.

In double support the ground's forces are not given by the motion: the feet may push against each
other, and motors that share joints may share the work. At each sample this chooses pad forces f and
motor torques tau that

    minimise    sum Cp tau^2
    subject to  J^T f + [0; M tau] = generalised force of the motion        (six rows of the base, then the joints)
                |f_xy| <= mu f_z                                            (friction cone at each pad that bears load)
                lower <= tau <= upper                                       (motor envelopes at their speeds)

all samples in one sparse second-order cone problem. Where that has no solution the envelopes give
way first, then the base's balance, both at a price far above any heat, and what gave way is
reported.
"""  # noqa: E501

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError

EXCESS_PRICE = 1e1
"""Price of torque beyond an envelope: for one whole peak torque, this many times the heat of all
motors at peak torque."""
GAP_PRICE = 1e3
"""Price of a force that is missing at the base: for one body weight, this many times the heat of
all motors at peak torque."""
RIDGE = 1e-6
"""Weight of the squared pad forces over body weight, which makes the split among the pads of a
rigid foot unique."""
NEGLIGIBLE = 1e-5
"""Excess over peak torque, or gap over weight, that counts as the solver's rounding."""


@dataclass(frozen=True, eq=False)
class Allocation:
    """Forces and torques along a motion."""

    contact_force: np.ndarray
    """Force on each pad in the axes of the world [N], `(n, pads, 3)`; zero on pads that bear no
    load."""
    motor_torque: np.ndarray
    """Motor torques [Nm], `(n, legs, motors)`."""
    excess: np.ndarray
    """Torque beyond the envelope [Nm], `(n, legs, motors)`, not negative."""
    gap: np.ndarray
    """Force [N] and moment [Nm] that no contact can give the base, `(n, 6)`."""
    heat: np.ndarray
    """Joule heat of all motors [W], `(n,)`."""
    residual: float
    """Largest miss of the equations of motion, gaps counted in [N or Nm]."""


def least_heat(
    required: np.ndarray,
    contact_jacobian: np.ndarray,
    bears: np.ndarray,
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    power_constant: np.ndarray,
    *,
    friction: float,
    weight: float,
    allow_excess: bool = True,
) -> Allocation:
    """Allocate contact forces and motor torques of least Joule heat to a motion.

    Args:
        required: generalised forces of the motion, joint friction included, `(n, 6 + legs *
            joints)` [N, Nm].
        contact_jacobian: velocity of each pad's contact point over `v`, world axes, `(n, pads, 3, 6
            + legs * joints)`.
        bears: whether a pad may bear load, `(n, pads)`.
        matrix: M of one leg, `(joints, motors)` [-].
        lower: least motor torques at their speeds [Nm], `(n, legs, motors)`.
        upper: largest motor torques [Nm], `(n, legs, motors)`.
        power_constant: Cp [W/Nm^2], `(motors,)`.
        friction: of the pads on the floor [-].
        weight: of the robot [N], which sets the scale.
        allow_excess: report what lies beyond envelopes and contacts; else it is an error.

    Returns:
        Forces, motor torques, and what lies beyond envelopes and contacts.

    Raises:
        InputError: shapes that do not fit, a friction or weight that is not positive.
        InfeasibleError: `allow_excess` is off and some sample cannot be done; says when and what is
        missing.
    """
    _check(required, contact_jacobian, bears, matrix, lower, upper, friction, weight)
    count, (legs, motors) = len(required), lower.shape[-2:]
    scaled = _scaled(
        required, contact_jacobian, bears, matrix, lower, upper, power_constant, weight
    )
    forces, torques, excess, gap = _solution(scaled, friction)
    peak = scaled.peak
    beyond = excess.reshape(count, legs, motors) * peak
    if not allow_excess and (np.any(gap) or np.any(beyond)):
        worst = int(np.argmax(np.abs(gap).max(1) * 1e6 + (beyond / peak).max((1, 2))))
        raise InfeasibleError(
            f"sample {worst} of {count} is beyond the robot: motors miss "
            f"{beyond[worst].max():.3g} Nm, the base {np.abs(gap[worst]).max() * weight:.3g} N or "
            "Nm"
        )
    _polish(scaled, forces, torques, gap)
    forces, gap = forces * weight, gap * weight
    motor_torque = torques.reshape(count, legs, motors) * peak
    return Allocation(
        contact_force=forces,
        motor_torque=motor_torque,
        excess=beyond,
        gap=gap,
        heat=np.sum(power_constant * motor_torque**2, (1, 2)),
        residual=_residual(required, contact_jacobian, forces, motor_torque, gap, matrix),
    )


def _check(
    required: np.ndarray,
    jacobian: np.ndarray,
    bears: np.ndarray,
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    friction: float,
    weight: float,
) -> None:
    """Refuse shapes that do not fit, and a friction or weight that is not positive."""
    count, size = required.shape
    joints = (size - 6) // lower.shape[-2]
    if (
        jacobian.shape != (count, bears.shape[1], 3, size)
        or matrix.shape != (joints, lower.shape[-1])
        or upper.shape != lower.shape
    ):
        raise InputError(
            "allocation",
            "shapes",
            [array.shape for array in (required, jacobian, bears, matrix, lower, upper)],
            "expects (n, 6 + legs joints), (n, pads, 3, ...), (n, pads), (joints, motors), limits",
        )
    if not (friction > 0 and weight > 0):
        raise InputError("allocation", "friction, weight", (friction, weight), "must be positive")


@dataclass(frozen=True, eq=False)
class _Scaled:
    """The problem in motor torques over peak torque and pad forces over body weight, so that all
    unknowns are of order one; rows of the equations are scaled alike.
    """

    bears: np.ndarray
    """Whether a pad may bear load, `(n, pads)`."""
    blocks: list[np.ndarray]
    """What the forces on the bearing pads give each row, one `(rows, 3 bearing pads)` a sample."""
    drives: np.ndarray
    """What the motors give each row, `(rows, legs * motors)`."""
    target: np.ndarray
    """What the motion requires of each row, `(n, rows)`."""
    lower: np.ndarray
    """Least motor torques, `(n * legs * motors,)`."""
    upper: np.ndarray
    """Largest motor torques, `(n * legs * motors,)`."""
    share: np.ndarray
    """Heat of a motor at its peak torque over that of all motors, over all samples, `(n * legs *
    motors,)`."""
    peak: np.ndarray
    """Peak torques [Nm], `(motors,)`."""


def _scaled(
    required: np.ndarray,
    jacobian: np.ndarray,
    bears: np.ndarray,
    matrix: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    power_constant: np.ndarray,
    weight: float,
) -> _Scaled:
    count, size = required.shape
    legs, motors = lower.shape[-2:]
    joints = (size - 6) // legs
    peak = np.maximum(np.max(np.maximum(np.abs(lower), np.abs(upper)), (0, 1)), 1e-9)
    row_scale = np.concatenate(
        [np.full(6, weight), np.full(size - 6, np.max(np.abs(matrix) @ peak))]
    )
    drives = np.zeros((size, legs * motors))
    for leg in range(legs):
        rows = slice(6 + leg * joints, 6 + (leg + 1) * joints)
        drives[rows, leg * motors : (leg + 1) * motors] = matrix * peak
    share = np.tile(power_constant * peak**2, legs)
    return _Scaled(
        bears=bears,
        blocks=[
            np.swapaxes(jacobian[n, bears[n]].reshape(-1, size), 0, 1) * weight / row_scale[:, None]
            for n in range(count)
        ],
        drives=drives / row_scale[:, None],
        target=required / row_scale,
        lower=(lower / peak).ravel(),
        upper=(upper / peak).ravel(),
        share=np.tile(share / share.sum(), count),
        peak=peak,
    )


def _solution(
    scaled: _Scaled, friction: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Pad forces `(n, pads, 3)`, motor torques `(n, legs * motors)`, torques beyond the envelopes
    `(n, legs * motors)` and what the base misses `(n, 6)`, all scaled.

    Only where envelopes and contacts do not allow the motion may they give way.
    """
    import cvxpy as cp
    from scipy import sparse

    count, size = scaled.target.shape
    motors, active = scaled.drives.shape[1], int(np.sum(scaled.bears))
    torque = cp.Variable(count * motors)
    cost = cp.sum_squares(cp.multiply(np.sqrt(scaled.share), torque))
    balance = sparse.kron(sparse.eye(count), scaled.drives, format="csr") @ torque
    cones: list[Any] = []
    force = cp.Variable((active, 3)) if active else None
    if force is not None:
        loads = sparse.block_diag(scaled.blocks, format="csr")
        balance = balance + loads @ cp.reshape(force, (3 * active,), order="C")
        cones.append(cp.SOC(friction * force[:, 2], force[:, :2].T, axis=0))
        cost = cost + RIDGE * cp.sum_squares(force)
    target, lower, upper = scaled.target.ravel(), scaled.lower, scaled.upper
    gap, beyond = np.zeros((count, 6)), np.zeros((count, motors))
    limits = [balance == target, torque <= upper, torque >= lower, *cones]
    if not _solved(cp.Problem(cp.Minimize(cost), limits)):
        excess = cp.Variable(count * motors, nonneg=True)
        short, over = cp.Variable(count * 6, nonneg=True), cp.Variable(count * 6, nonneg=True)
        cost = cost + EXCESS_PRICE * cp.sum(excess) + GAP_PRICE * cp.sum(short + over)
        base = sparse.kron(sparse.eye(count), np.eye(size)[:, :6], format="csr")
        limits = [
            balance + base @ (short - over) == target,
            torque <= upper + excess,
            torque >= lower - excess,
            *cones,
        ]
        if not _solved(cp.Problem(cp.Minimize(cost), limits)):
            raise InfeasibleError(
                "the allocation has no solution that the solver finds; the motion's forces are far "
                "beyond the robot"
            )
        gap = (short.value - over.value).reshape(count, 6)
        gap = np.where(np.abs(gap) > NEGLIGIBLE, gap, 0.0)
        beyond = excess.value.reshape(count, motors)
        beyond = np.where(beyond > NEGLIGIBLE, beyond, 0.0)
    forces = np.zeros((*scaled.bears.shape, 3))
    if force is not None:
        forces[scaled.bears] = force.value
    return forces, torque.value.reshape(count, motors), beyond, gap


def _solved(problem: Any) -> bool:
    """Whether the solver finds an optimum; one it calls inaccurate shows in `residual`."""
    import cvxpy as cp

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            problem.solve(solver=cp.CLARABEL)
        except cp.error.SolverError:
            return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)


def _polish(scaled: _Scaled, forces: np.ndarray, torques: np.ndarray, gap: np.ndarray) -> None:
    """Move forces and torques, in place, by the least that closes the equations to rounding; the
    solver leaves 1e-8.
    """
    for n, block in enumerate(scaled.blocks):
        count, bears = block.shape[1], scaled.bears[n]
        both = np.hstack([block, scaled.drives])
        now = np.concatenate([forces[n, bears].ravel(), torques[n]])
        miss = scaled.target[n] - both @ now
        miss[:6] -= gap[n]
        now = now + np.linalg.lstsq(both, miss, rcond=None)[0]
        forces[n, bears], torques[n] = now[:count].reshape(-1, 3), now[count:]


def _residual(
    required: np.ndarray,
    jacobian: np.ndarray,
    forces: np.ndarray,
    motor_torque: np.ndarray,
    gap: np.ndarray,
    matrix: np.ndarray,
) -> float:
    """Largest miss of the equations of motion [N or Nm]."""
    wrench = np.einsum("npiv,npi->nv", jacobian, forces)
    wrench[:, :6] += gap
    wrench[:, 6:] += np.einsum("jm,nlm->nlj", matrix, motor_torque).reshape(len(required), -1)
    return float(np.max(np.abs(wrench - required)))
