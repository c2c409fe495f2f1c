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
    import cvxpy as cp
    from scipy import sparse

    count, size = required.shape
    legs, motors = lower.shape[-2:]
    joints = (size - 6) // legs
    pads = bears.shape[1]
    if (
        contact_jacobian.shape != (count, pads, 3, size)
        or matrix.shape != (joints, motors)
        or upper.shape != lower.shape
    ):
        shapes = [
            required.shape,
            contact_jacobian.shape,
            bears.shape,
            matrix.shape,
            lower.shape,
            upper.shape,
        ]
        raise InputError(
            "allocation",
            "shapes",
            shapes,
            "expects (n, 6 + legs joints), (n, pads, 3, ...), (n, pads), (joints, motors), limits",
        )
    if not (friction > 0 and weight > 0):
        raise InputError("allocation", "friction, weight", (friction, weight), "must be positive")

    peak = np.maximum(np.max(np.maximum(np.abs(lower), np.abs(upper)), (0, 1)), 1e-9)
    row_scale = np.concatenate(
        [np.full(6, weight), np.full(size - 6, np.max(np.abs(matrix) @ peak))]
    )
    drives = np.zeros((size, legs * motors))
    for leg in range(legs):
        drives[6 + leg * joints : 6 + (leg + 1) * joints, leg * motors : (leg + 1) * motors] = (
            matrix * peak
        )
    blocks = [
        np.swapaxes(contact_jacobian[n, bears[n]].reshape(-1, size), 0, 1)
        * weight
        / row_scale[:, None]
        for n in range(count)
    ]
    loads = (
        sparse.block_diag(blocks, format="csr")
        if np.any(bears)
        else sparse.csr_matrix((count * size, 0))
    )
    torques = sparse.kron(sparse.eye(count), drives / row_scale[:, None], format="csr")
    base = sparse.kron(sparse.eye(count), np.eye(size)[:, :6], format="csr")
    target = (required / row_scale).ravel()
    share = np.tile(power_constant * peak**2, legs)
    share = np.tile(share / share.sum(), count)
    lowest, highest = (lower / peak).ravel(), (upper / peak).ravel()

    torque = cp.Variable(count * legs * motors)
    cost = cp.sum_squares(cp.multiply(np.sqrt(share), torque))
    balance, cones = torques @ torque, []
    active = int(np.sum(bears))
    force = cp.Variable((active, 3)) if active else None
    if force is not None:
        balance = balance + loads @ cp.reshape(force, (3 * active,), order="C")
        cones.append(cp.SOC(friction * force[:, 2], force[:, :2].T, axis=0))
        cost = cost + RIDGE * cp.sum_squares(force)
    gap, beyond = np.zeros((count, 6)), np.zeros((count, legs, motors))
    if not _solved(
        cp.Problem(
            cp.Minimize(cost), [balance == target, torque <= highest, torque >= lowest, *cones]
        )
    ):
        excess = cp.Variable(count * legs * motors, nonneg=True)
        short, over = cp.Variable(count * 6, nonneg=True), cp.Variable(count * 6, nonneg=True)
        cost = cost + EXCESS_PRICE * cp.sum(excess) + GAP_PRICE * cp.sum(short + over)
        limits = [torque <= highest + excess, torque >= lowest - excess, *cones]
        if not _solved(
            cp.Problem(cp.Minimize(cost), [balance + base @ (short - over) == target, *limits])
        ):
            raise InfeasibleError(
                "the allocation has no solution that the solver finds; the motion's forces are far "
                "beyond the robot"
            )
        gap = (short.value - over.value).reshape(count, 6)
        gap = np.where(np.abs(gap) > NEGLIGIBLE, gap, 0.0)
        beyond = excess.value.reshape(count, legs, motors)
        beyond = np.where(beyond > NEGLIGIBLE, beyond, 0.0) * peak
    if not allow_excess and (np.any(gap) or np.any(beyond)):
        worst = int(np.argmax(np.abs(gap).max(1) * 1e6 + (beyond / peak).max((1, 2))))
        raise InfeasibleError(
            f"sample {worst} of {count} is beyond the robot: motors miss {beyond[worst].max():.3g} "
            f"Nm, "
            f"the base {np.abs(gap[worst]).max() * weight:.3g} N or Nm"
        )
    forces = np.zeros((count, pads, 3))
    given = torque.value.reshape(count, legs * motors)
    if force is not None:
        forces[bears] = force.value
    _polish(forces, given, gap, bears, blocks, drives / row_scale[:, None], required / row_scale)
    forces, gap = forces * weight, gap * weight
    motor_torque = given.reshape(count, legs, motors) * peak
    return Allocation(
        contact_force=forces,
        motor_torque=motor_torque,
        excess=beyond,
        gap=gap,
        heat=np.sum(power_constant * motor_torque**2, (1, 2)),
        residual=_residual(required, contact_jacobian, forces, motor_torque, gap, matrix),
    )


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


def _polish(
    forces: np.ndarray,
    given: np.ndarray,
    gap: np.ndarray,
    bears: np.ndarray,
    blocks: list[np.ndarray],
    drives: np.ndarray,
    target: np.ndarray,
) -> None:
    """Move forces and torques, in place, by the least that closes the equations to rounding; the
    solver leaves 1e-8.
    """
    for n, block in enumerate(blocks):
        count = block.shape[1]
        both = np.hstack([block, drives])
        now = np.concatenate([forces[n, bears[n]].ravel(), given[n]])
        miss = target[n] - both @ now
        miss[:6] -= gap[n]
        now = now + np.linalg.lstsq(both, miss, rcond=None)[0]
        forces[n, bears[n]], given[n] = now[:count].reshape(-1, 3), now[count:]


def _residual(
    required: np.ndarray,
    jacobian: np.ndarray,
    forces: np.ndarray,
    motor_torque: np.ndarray,
    gap: np.ndarray,
    matrix: np.ndarray,
) -> float:
    wrench = np.einsum("npiv,npi->nv", jacobian, forces)
    wrench[:, :6] += gap
    wrench[:, 6:] += np.einsum("jm,nlm->nlj", matrix, motor_torque).reshape(len(required), -1)
    return float(np.max(np.abs(wrench - required)))
