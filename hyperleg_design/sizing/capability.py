"""The largest contact force that one leg gives in a posture, inside motor envelopes and friction
cones.

The leg pushes quasi-statically: its pads press on the floor, its joints hold

    M tau_motor = g - J^T f,        lower <= tau_motor <= upper        |f_xy| <= mu f_z at each pad

with g the gravity torques of the leg's own links, f the forces of the floor on the pads and limits
at zero speed or at given joint velocities. The pelvis is taken as held, as in a leg press: what the
rest of the robot needs so as not to tip is asked for only with `upright`. Joint friction, which
would help to hold, is left out. A second-order cone problem.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InfeasibleError, InputError
from hyperleg_design.robot.models import GRAVITY, RigidBodyModel, rigid_body_model
from hyperleg_design.robot.transmission import (
    joint_from_motor,
    joint_names,
    motor_names,
    motor_velocity,
)
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.robot.trees.tree_limb import skew
from hyperleg_design.sizing.contacts import contact_kinematics, sole_pads
from hyperleg_design.sizing.derating import DeratedTorques, derated_torques
from hyperleg_design.sizing.envelope import motor_envelope, torque_limits
from hyperleg_design.sizing.postures import POSTURES, posture

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign

DIRECTIONS: Mapping[str, np.ndarray] = {
    "vertical": np.array([0.0, 0.0, 1.0]),
    "forward": np.array([1.0, 0.0, 0.0]),
}
"""Unit vectors of the floor's force on the foot, by name; the forward force drives the robot
ahead."""
BINDING = 1e-4
"""Distance to a limit, over peak torque or friction limit, at which it counts as reached."""
ON_FLOOR = 1e-3
"""Height above the lowest pad up to which a pad counts as on the floor [m]."""
LARGEST = 100.0
"""Body weights beyond which no robot pushes: there the leg carries the force by its bones alone
[-]."""


@dataclass(frozen=True, eq=False)
class ContactForce:
    """The largest force in one direction, and what stops it there."""

    design: str
    variant: str
    direction: str
    force: np.ndarray
    """Force of the floor on the foot, summed over pads [N], `(3,)`."""
    pad_force: np.ndarray
    """Force on each pad [N], `(pads, 3)`; zero on pads off the floor."""
    center_of_pressure: np.ndarray
    """Centre of pressure on the floor, measured from the ankle forward and to the left [m],
    `(2,)`."""
    motor_torque: np.ndarray
    """Motor torques of the pushing leg [Nm], `(motors,)`."""
    joint_torque: np.ndarray
    """Joint torques of the pushing leg [Nm], `(joints,)`."""
    binding: tuple[str, ...]
    """Motors at a limit of their envelope."""
    derated: tuple[str, ...]
    """Joints at their derated torque, where derating is asked for."""
    slipping: tuple[str, ...]
    """Pads at the limit of friction."""
    body_weights: float
    """The force in its direction over the robot's weight [-]."""


def largest_force(
    design: RobotDesign,
    q: np.ndarray | str,
    direction: str = "vertical",
    *,
    side: str = "left",
    joint_velocity: np.ndarray | None = None,
    upright: bool = False,
    vertical: float | None = None,
    derated: bool = False,
    model: RigidBodyModel | None = None,
) -> ContactForce:
    """Compute the largest contact force of one leg in a posture.

    Args:
        design: a robot.
        q: configuration of the floating robot in Pinocchio's coordinates, `(nq,)`, or a name of
            `POSTURES`.
        direction: `vertical` or `forward`.
        side: the leg that pushes, on those of its pads that are lowest.
        joint_velocity: of that leg [rad/s], `(joints,)`, which narrows the envelopes; at rest by
            default.
        upright: whether the force must pass through the robot's centre of mass, so as not to tip
            it.
        vertical: vertical force to hold at the same time [N], for the forward direction; free by
            default.
        derated: whether joints give no more than the `derate` of the design counts on.
        model: the design's rigid-body model, to save making it.

    Returns:
        The force, its centre of pressure, the motor torques, and the motors at their limits.

    Raises:
        InputError: no such direction, side or posture, or arrays of the wrong shape.
        InfeasibleError: no contact force holds the leg, or the bones carry any force: a straight
        leg has no largest one.
    """
    _check_question(design, direction, side, vertical)
    model = model or rigid_body_model(design)
    push = _push(design, model, q, direction, side, joint_velocity, derated)
    pad_force, torque = _extreme(push, upright, vertical)
    return _contact_force(push, pad_force, torque)


def _check_question(design: RobotDesign, direction: str, side: str, vertical: float | None) -> None:
    where, sides = "capability", design.copies
    if direction not in DIRECTIONS:
        raise InputError(where, "direction", direction, f"expects one of {', '.join(DIRECTIONS)}")
    if side not in sides:
        raise InputError(where, "side", side, f"expects one of {', '.join(sides)}")
    if vertical is not None and not (
        np.isfinite(vertical) and vertical > 0 and direction == "forward"
    ):
        remedy = "expects a positive force in N, with the forward direction"
        raise InputError(where, "vertical", vertical, remedy)


@dataclass(frozen=True, eq=False)
class _Push:
    """A leg that pushes on the floor, in one posture."""

    design: RobotDesign
    direction: str
    side: str
    model: RigidBodyModel
    q: np.ndarray
    """Configuration, `(nq,)`."""
    link: str
    """Link from whose origin the centre of pressure is measured."""
    touching: np.ndarray
    """Numbers of the pads that touch the floor, `(k,)`."""
    points: np.ndarray
    """Where they touch it [m], `(k, 3)`."""
    jacobian: np.ndarray
    """Velocity of these points over the leg's joint velocities, transposed, `(joints, 3 k)`."""
    gravity: np.ndarray
    """Joint torques that hold the leg's own links [Nm], `(joints,)`."""
    lower: np.ndarray
    """Least motor torques [Nm], `(motors,)`."""
    upper: np.ndarray
    """Largest motor torques [Nm], `(motors,)`."""
    derated: DeratedTorques | None
    """Torques of joints that the design counts on, where derating is asked for."""

    @property
    def weight(self) -> float:
        """Weight of the robot [N]."""
        return GRAVITY * self.model.tree.mass

    @property
    def friction(self) -> float:
        """Friction of the pads on the floor [-]."""
        return float(self.design.contact_section.friction)


def _push(
    design: RobotDesign,
    model: RigidBodyModel,
    q: np.ndarray | str,
    direction: str,
    side: str,
    joint_velocity: np.ndarray | None,
    derated: bool,
) -> _Push:
    q = np.asarray(posture(design, q, model) if isinstance(q, str) else q, float)
    joints = len(joint_names(design))
    speed = np.zeros(joints) if joint_velocity is None else np.asarray(joint_velocity, float)
    for name, values, length in (("q", q, model.model.nq), ("joint_velocity", speed, joints)):
        if values.shape != (length,) or not np.all(np.isfinite(values)):
            remedy = f"expects finite numbers, shape ({length},)"
            raise InputError("capability", name, values.shape, remedy)
    first = model.base_dof + design.copies.index(side) * joints
    columns = slice(first, first + joints)
    points, jacobian = contact_kinematics(model, q)
    pads = sole_pads(model.tree)
    own = np.array([pad.side == side for pad in pads], bool)
    if not np.any(own):
        raise InfeasibleError(f"{design.name}: {side or 'the robot'} has no pads to push with")
    touching = np.flatnonzero(own & (points[:, 2] < points[own, 2].min() + ON_FLOOR))
    still = np.zeros(model.model.nv)
    speeds = motor_velocity(joint_from_motor(design), speed)
    lower, upper = torque_limits(motor_envelope(design), speeds)
    return _Push(
        design=design,
        direction=direction,
        side=side,
        model=model,
        q=q,
        link=pads[touching[0]].link if isinstance(design, TreeDesign) else f"{side}_foot",
        touching=touching,
        points=points[touching],
        jacobian=np.swapaxes(jacobian[touching][:, :, columns].reshape(-1, joints), 0, 1),
        gravity=model.inverse_dynamics(q, still, still)[columns],
        lower=lower,
        upper=upper,
        derated=derated_torques(design, lower, upper) if derated else None,
    )


def _extreme(push: _Push, upright: bool, vertical: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Forces on the touching pads [N], `(k, 3)`, and motor torques [Nm], `(motors,)`, of the
    largest force; arguments as in `largest_force`.
    """
    import cvxpy as cp

    design, weight, count = push.design, push.weight, len(push.touching)
    matrix, peak = joint_from_motor(design), motor_envelope(design).peak_torque
    force = cp.Variable((count, 3))  # over weight
    torque = cp.Variable(len(motor_names(design)))  # over peak
    stacked = cp.reshape(force, (3 * count,), order="C")
    scale = np.max(np.abs(matrix) @ peak)
    constraints = [
        (matrix * peak / scale) @ torque
        == (push.gravity - (push.jacobian * weight) @ stacked) / scale,
        torque >= push.lower / peak,
        torque <= push.upper / peak,
        cp.SOC(push.friction * force[:, 2], force[:, :2].T, axis=0),
    ]
    if (joints := push.derated) is not None and joints.names:
        given = (matrix[joints.rows] * peak / scale) @ torque
        constraints += [given >= joints.lower / scale, given <= joints.upper / scale]
    if upright:
        arms = push.points - push.model.center_of_mass(push.q)
        turning = np.hstack([skew(arm) for arm in arms])
        constraints.append(turning @ stacked == 0)
    if vertical is not None:
        constraints.append(cp.sum(force[:, 2]) == vertical / weight)
    limb = f"{push.side} " if push.side else ""
    total = cp.sum(force, axis=0) @ DIRECTIONS[push.direction]
    problem = cp.Problem(cp.Maximize(total), [*constraints, cp.sum(force[:, 2]) <= LARGEST])
    try:
        problem.solve(solver=cp.CLARABEL)
    except cp.error.SolverError:
        raise InfeasibleError(
            f"{design.name}: the solver finds no largest {push.direction} force in this posture"
        ) from None
    if problem.status not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
        raise InfeasibleError(
            f"{design.name}: no contact force of the {limb}foot lets its motors hold this "
            f"posture ({problem.status})"
        )
    pad_force = force.value * weight
    if pad_force[:, 2].sum() > 0.999 * LARGEST * weight:
        raise InfeasibleError(
            f"{design.name}: the {limb}leg is straight in this posture: its bones carry any "
            "force; bend the knee"
        )
    return pad_force, torque.value * peak


def _contact_force(push: _Push, touching_force: np.ndarray, torque: np.ndarray) -> ContactForce:
    design, weight = push.design, push.weight
    pads, envelope = sole_pads(push.model.tree), motor_envelope(design)
    pad_force = np.zeros((len(pads), 3))
    pad_force[push.touching] = touching_force
    total = touching_force.sum(0)
    pressed = (push.points * touching_force[:, 2:]).sum(0) / max(total[2], 1e-12)
    center = pressed - push.model.frame_position(push.q, push.link)
    near = np.minimum(push.upper - torque, torque - push.lower) / envelope.peak_torque
    sideways = np.linalg.norm(touching_force[:, :2], axis=1)
    slack = push.friction * touching_force[:, 2] - sideways
    joint_torque = joint_from_motor(design) @ torque
    loaded = touching_force[:, 2] > 1e-3 * weight
    return ContactForce(
        design=design.name,
        variant=design.variant,
        direction=push.direction,
        force=total,
        pad_force=pad_force,
        center_of_pressure=center[:2],
        motor_torque=torque,
        joint_torque=joint_torque,
        binding=tuple(
            name
            for name, distance in zip(motor_names(design), near, strict=True)
            if distance < BINDING
        ),
        derated=push.derated.reached(joint_torque, BINDING) if push.derated else (),
        slipping=tuple(
            pads[p].name
            for p, rest, bears in zip(push.touching, slack, loaded, strict=True)
            if bears and rest < BINDING * weight
        ),
        body_weights=float(total @ DIRECTIONS[push.direction]) / weight,
    )


def capability_table(
    designs: Mapping[str, Design], postures: tuple[str, ...] = POSTURES, *, upright: bool = False
) -> list[dict[str, Any]]:
    """Tabulate the largest forces of one leg, with a row for each design, posture and direction.

    Args:
        designs: robots by name.
        postures: names of postures.
        upright: as in `largest_force`.

    Returns:
        Rows of `design`, `posture`, `direction`, `force` [N] (in that direction), `body_weights`
        [-], `center_of_pressure` [m] ahead of the ankle, `binding` motors; `force` is None with a
        `reason` where there is no largest force.
    """
    rows: list[dict[str, Any]] = []
    for key, design in designs.items():
        model = rigid_body_model(design)
        for name in postures:
            for direction in DIRECTIONS:
                row: dict[str, Any] = {"design": key, "posture": name, "direction": direction}
                try:
                    largest = largest_force(design, name, direction, model=model, upright=upright)
                except InfeasibleError as error:
                    rows.append({**row, "force": None, "reason": str(error)})
                    continue
                row |= {
                    "force": float(largest.force @ DIRECTIONS[direction]),
                    "body_weights": largest.body_weights,
                    "center_of_pressure": float(largest.center_of_pressure[0]),
                    "binding": largest.binding,
                }
                rows.append(row)
    return rows
