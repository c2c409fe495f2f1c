"""Drives of a robot that an MJCF or URDF file describes: what its actuators state."""

from __future__ import annotations

from collections.abc import Collection
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
    import mujoco

    single = [j for j in single_joints(model) if _name(model, j) in free_joints]
    joints = tuple(_name(model, j) for j in single)
    dofs = np.array([model.jnt_dofadr[j] for j in single])
    count = len(joints)
    notes: list[str] = []
    moment = _moment(model)
    tendons = fixed_tendons(model, single)
    usable_indices = []
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
        elif np.any(moment[index, dofs]):
            usable_indices.append(index)
    usable = np.array(usable_indices, int)
    matrix = moment[usable][:, dofs].T
    names = [model.actuator(i).name or f"actuator_{i}" for i in usable]
    limit = np.array([_force_limit(model, i) for i in usable])
    stiffness, damping = np.array([_feedback(model, i) for i in usable]).reshape(-1, 2).T
    armature = model.dof_armature[dofs]
    most = np.abs(model.jnt_actfrcrange[single]).max(1)
    effort = np.where(model.jnt_actfrclimited[single] != 0, most, np.inf)
    gains = np.full((count, 2), np.nan)
    if np.all(np.count_nonzero(matrix, 0) <= 1):
        own = matrix != 0
        driven = own.any(1) if usable_indices else np.ones(count, bool)
        servo = (own & (stiffness > 0)).any(1)
        for column, values in enumerate((stiffness, damping)):
            gains[servo, column] = (matrix[servo] ** 2 * values).sum(1)
        reached = np.where(own, np.abs(matrix), 0.0)
        total = (
            np.array([sum(r * f for r, f in zip(row, limit, strict=True) if r) for row in reached])
            if usable_indices
            else np.full(count, np.inf)
        )
        rotor = armature + matrix**2 @ model.actuator_armature[usable]
        for tendon in tendons:
            rotor = rotor + (np.diag(tendon.inertia) if tendon.single else 0.0)
        alias = [next((names[a] for a in np.flatnonzero(own[j])), joints[j]) for j in range(count)]
        gear = np.array(
            [float(matrix[j, own[j]][0]) if own[j].sum() == 1 else 1.0 for j in range(count)]
        )
        return Drives(
            joints,
            tuple(alias),
            np.eye(count),
            gear,
            gains,
            np.minimum(total, effort),
            rotor,
            np.zeros(count),
            tuple(t for t in tendons if t.armature and not t.single),
            ~driven,
            tuple(notes),
        )
    rotor = np.array(model.actuator_armature[usable])
    couplings = []
    for tendon in tendons:
        by_tendon = model.actuator_trntype[usable] == mujoco.mjtTrn.mjTRN_TENDON
        pulling = np.flatnonzero(by_tendon & (model.actuator_trnid[usable, 0] == tendon.index))
        if len(pulling) == 1:  # the motor turns gear times as fast as the tendon lengthens
            ratio = float(model.actuator_gear[usable[pulling[0]], 0])
            rotor[pulling[0]] += tendon.armature / ratio**2
        elif tendon.single:
            armature = armature + np.diag(tendon.inertia)
        elif tendon.armature:
            couplings.append(tendon)
    return Drives(
        tuple(names),
        tuple(names),
        matrix,
        np.ones(len(names)),
        gains,
        limit,
        rotor,
        armature,
        tuple(couplings),
        np.zeros(count, bool),
        tuple(notes),
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
