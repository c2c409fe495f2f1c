"""Drives of a robot that an MJCF or URDF file describes: what its actuators state."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from hyperleg_design.gap.model.file_joints import single_joints
from hyperleg_design.gap.model.tendons import Tendon, fixed_tendons

ANGLE_TRANSMISSIONS = ("mjTRN_JOINT", "mjTRN_JOINTINPARENT", "mjTRN_TENDON")
"""Kinds of transmission whose torque per unit of force does not change with posture, as long as the
tendon is fixed."""


@dataclass(frozen=True, eq=False)
class Drives:
    """Drives that a file states; joints and motors are one to one unless motors are coupled."""

    names: tuple[str, ...]
    """Of the motors `(m,)`: of the joints where they are one to one."""
    aliases: tuple[str, ...]
    """Names of the actuators in the file, the motors' own where it has none `(m,)`."""
    matrix: np.ndarray
    """Joint torque of motor torque `(n, m)`."""
    gear: np.ndarray
    """Of the actuators over their joints where they are one to one, whose motors count at the
    joint; else 1 `(m,)`."""
    gains: np.ndarray
    """Stiffness and damping of the joint controllers, NaN where the file states none `(n, 2)`
    [Nm/rad, Nms/rad]."""
    limit: np.ndarray
    """Largest motor torque, infinite where unstated `(m,)` [Nm]."""
    rotor_inertia: np.ndarray
    """At the motor `(m,)` [kg m^2]."""
    armature: np.ndarray
    """Further inertia about each joint that is no rotor of a coupled motor `(n,)` [kg m^2]."""
    couplings: tuple[Tendon, ...]
    """Tendons whose armature couples joints and belongs to no motor's rotor."""
    passive: np.ndarray
    """Joints without a drive, in a file that drives others `(n,)`."""
    notes: tuple[str, ...]


def read_drives(model: Any, free_joints: Collection[str]) -> Drives:
    """Read the drives of a compiled file.

    Args:
        model: the compiled model.
        free_joints: names of the joints that stay free.

    Returns:
        Drives over these joints, in the model's order.
    """
    single = [j for j in single_joints(model) if _name(model, j) in free_joints]
    dofs = np.array([model.jnt_dofadr[j] for j in single])
    moment = _moment(model)
    usable, notes = _usable(model, moment[:, dofs])
    actuators = _Actuators(
        model,
        joints=tuple(_name(model, j) for j in single),
        indices=usable,
        names=tuple(model.actuator(i).name or f"actuator_{i}" for i in usable),
        matrix=moment[usable][:, dofs].T,
        limit=np.array([_force_limit(model, i) for i in usable]),
        armature=model.dof_armature[dofs],
        tendons=fixed_tendons(model, single),
        notes=notes,
    )
    most = np.abs(model.jnt_actfrcrange[single]).max(1)
    effort = np.where(model.jnt_actfrclimited[single] != 0, most, np.inf)
    if np.all(np.count_nonzero(actuators.matrix, 0) <= 1):
        return _one_a_joint(actuators, effort)
    return _coupled(actuators, effort)


@dataclass(frozen=True, eq=False)
class _Actuators:
    """The actuators of a file that drive its n free joints, `a` of them."""

    model: Any
    joints: tuple[str, ...]
    indices: np.ndarray
    """In the model `(a,)`."""
    names: tuple[str, ...]
    matrix: np.ndarray
    """Joint torque over actuator force `(n, a)`."""
    limit: np.ndarray
    """Largest force of each `(a,)`."""
    armature: np.ndarray
    """Of the joints `(n,)` [kg m^2]."""
    tendons: Sequence[Tendon]
    notes: tuple[str, ...]


def _usable(model: Any, moment: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Actuators whose lever is the same in every posture, of those that drive a joint, and a note
    on each of the others; `moment` is joint torque over force `(nu, n)`.
    """
    import mujoco

    indices, notes = [], []
    for index in range(model.nu):
        kind = mujoco.mjtTrn(model.actuator_trntype[index]).name
        wraps_sites = kind == "mjTRN_TENDON" and not _is_fixed_tendon(
            model, int(model.actuator_trnid[index, 0])
        )
        if kind not in ANGLE_TRANSMISSIONS or wraps_sites:
            notes.append(
                f"actuator {model.actuator(index).name} acts through {kind}, whose lever changes "
                f"with posture: left out"
            )
        elif np.any(moment[index]):
            indices.append(index)
    return np.array(indices, int), tuple(notes)


def _one_a_joint(actuators: _Actuators, effort: np.ndarray) -> Drives:
    """Drives where no actuator moves two joints: each joint is its own motor, up to its `effort`
    `(n,)` [Nm].
    """
    model, matrix, joints = actuators.model, actuators.matrix, actuators.joints
    count, own = len(joints), matrix != 0
    driven, most = np.ones(count, bool), np.full(count, np.inf)
    if len(actuators.indices):
        driven = own.any(1)
        most = np.array(
            [
                sum(
                    abs(lever) * force
                    for lever, force in zip(row, actuators.limit, strict=True)
                    if lever
                )
                for row in matrix
            ]
        )
    gains = np.full((count, 2), np.nan)
    stiffness, damping = np.array([_feedback(model, i) for i in actuators.indices]).reshape(-1, 2).T
    servo = (own & (stiffness > 0)).any(1)
    for column, values in enumerate((stiffness, damping)):
        gains[servo, column] = (matrix[servo] ** 2 * values).sum(1)
    rotor = actuators.armature + matrix**2 @ model.actuator_armature[actuators.indices]
    for tendon in actuators.tendons:
        rotor = rotor + (np.diag(tendon.inertia) if tendon.single else 0.0)
    names = [
        next((actuators.names[a] for a in np.flatnonzero(mine)), joint)
        for joint, mine in zip(joints, own, strict=True)
    ]
    gear = [
        float(row[mine][0]) if mine.sum() == 1 else 1.0
        for row, mine in zip(matrix, own, strict=True)
    ]
    return Drives(
        names=joints,
        aliases=tuple(names),
        matrix=np.eye(count),
        gear=np.array(gear),
        gains=gains,
        limit=np.minimum(most, effort),
        rotor_inertia=rotor,
        armature=np.zeros(count),
        couplings=tuple(t for t in actuators.tendons if t.armature and not t.single),
        passive=~driven,
        notes=actuators.notes,
    )


def _coupled(actuators: _Actuators, effort: np.ndarray) -> Drives:
    """Drives where some actuator moves several joints: each actuator is a motor. The `effort` of a
    joint `(n,)` [Nm] limits one that moves it alone, and it alone.
    """
    import mujoco

    model, indices = actuators.model, actuators.indices
    rotor, armature = np.array(model.actuator_armature[indices]), actuators.armature
    couplings = []
    for tendon in actuators.tendons:
        by_tendon = model.actuator_trntype[indices] == mujoco.mjtTrn.mjTRN_TENDON
        pulling = np.flatnonzero(by_tendon & (model.actuator_trnid[indices, 0] == tendon.index))
        if len(pulling) == 1:  # the motor turns gear times as fast as the tendon lengthens
            ratio = float(model.actuator_gear[indices[pulling[0]], 0])
            rotor[pulling[0]] += tendon.armature / ratio**2
        elif tendon.single:
            armature = armature + np.diag(tendon.inertia)
        elif tendon.armature:
            couplings.append(tendon)
    count, own = len(actuators.joints), actuators.matrix != 0
    alone = own & (own.sum(0) == 1) & (own.sum(1, keepdims=True) == 1)
    levers = np.where(alone, np.abs(actuators.matrix), 1.0)
    most = np.where(alone, effort[:, None] / levers, np.inf).min(0)
    return Drives(
        names=actuators.names,
        aliases=actuators.names,
        matrix=actuators.matrix,
        gear=np.ones(len(actuators.names)),
        gains=np.full((count, 2), np.nan),
        limit=np.minimum(actuators.limit, most),
        rotor_inertia=rotor,
        armature=armature,
        couplings=tuple(couplings),
        passive=np.zeros(count, bool),
        notes=actuators.notes,
    )


def _moment(model: Any) -> np.ndarray:
    """Generalised force of a unit of each actuator's force at the reference posture, `(nu, nv)`."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    dense = np.zeros((len(data.moment_rownnz), model.nv))
    for row, (start, length) in enumerate(zip(data.moment_rowadr, data.moment_rownnz, strict=True)):
        dense[row, data.moment_colind[start : start + length]] = np.ravel(data.actuator_moment)[
            start : start + length
        ]
    return dense[: model.nu]


def _is_fixed_tendon(model: Any, tendon: int) -> bool:
    import mujoco

    return bool(model.wrap_type[model.tendon_adr[tendon]] == mujoco.mjtWrap.mjWRAP_JOINT)


def _force_limit(model: Any, actuator: int) -> float:
    """Largest force of an actuator: its own limit, or that of the control of a plain motor."""
    import mujoco

    limits = [np.inf]
    if model.actuator_forcelimited[actuator]:
        limits.append(float(np.max(np.abs(model.actuator_forcerange[actuator]))))
    plain = model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
    if plain and np.ravel(model.actuator_ctrllimited)[actuator]:
        gain = abs(float(model.actuator_gainprm[actuator, 0]))
        limits.append(float(np.max(np.abs(model.actuator_ctrlrange[actuator]))) * gain)
    return min(limits)


def _feedback(model: Any, actuator: int) -> tuple[float, float]:
    """Stiffness and damping that an actuator's bias puts on its own length, zero for a torque
    motor.
    """
    import mujoco

    if model.actuator_biastype[actuator] != mujoco.mjtBias.mjBIAS_AFFINE:
        return 0.0, 0.0
    return -float(model.actuator_biasprm[actuator, 1]), -float(model.actuator_biasprm[actuator, 2])


def _name(model: Any, joint: int) -> str:
    return model.joint(joint).name or f"joint_{joint}"
