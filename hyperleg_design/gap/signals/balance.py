"""The balance of torques: what the motors give less what the motion needs, free of forces of the
ground that nobody measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.gap.model import friction, pads, rigid
from hyperleg_design.gap.model.base import BaseMotion
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.gap.signals import contact
from hyperleg_design.gap.signals.channels import applied
from hyperleg_design.gap.signals.joint_motion import JointMotion
from hyperleg_design.gap.signals.limit_cycle import LimitCycle
from hyperleg_design.gap.signals.smoothing import Smooth
from hyperleg_design.gap.signals.stops import at_stop
from hyperleg_design.gap.signals.torque_sensors import behind_gears, taken_before
from hyperleg_design.gap.signals.unknown_forces import Elimination, eliminated


@dataclass(frozen=True, eq=False)
class Balance:
    """Of `n` joints at `t` ticks."""

    ground: contact.Ground
    needed: np.ndarray
    """Torque that the motion needs by the nominal model, less what the ground and what acts before
    torque sensors give `(t, n)` [Nm]."""
    motion: np.ndarray
    """What motors give less what is needed, in rows that are free of unknown forces; NaN where
    unknown `(t, n)` [Nm]."""
    base: np.ndarray | None
    """The same of a floating base, where forces of the ground are known or eliminated `(t, 6)`."""
    elimination: Elimination | None
    behind: np.ndarray | None
    """Joints whose torque a sensor behind the gear tells alone `(n,)` of bool; None of none."""
    before: np.ndarray | None
    """Motor torque that is taken before these sensors `(t, m)` [Nm]; None of none."""


def balance(
    log: Log,
    subject: Subject,
    ticks: np.ndarray,
    joints: JointMotion,
    base: BaseMotion | None,
    shaken: LimitCycle | None,
    believed: np.ndarray,
    sensed: bool,
    margin: int,
) -> Balance:
    """Balance the torques of a log.

    Args:
        log: of this subject.
        subject: the robot, with what the log declares of it.
        ticks: `(t,)` [s].
        joints: their motion.
        base: of a floating base.
        shaken: limit cycle of the joints, if any.
        believed: torque of the motors `(t, m)` [Nm].
        sensed: whether the log measures torques.
        margin: ticks around a change of what is unknown of the ground, which are left out.

    Returns:
        The balance.
    """
    motion = joints.smooth
    ground, needed, of_base = _needed(log, subject, ticks, motion, base, shaken)
    behind, before = behind_gears(log, subject) if sensed else None, None
    if behind is not None:
        taken = taken_before(subject, behind, motion, shaken)
        needed, before = needed - taken, applied(subject.motor_from_joint, taken)
    of_motion = applied(subject.joint_from_motor, believed) - needed
    unmeasured = joints.lacking | at_stop(subject, motion.value) | ~np.isfinite(of_motion)
    if of_base is not None:
        unmeasured |= ~np.isfinite(of_base).all(1, keepdims=True)
    rotation = None if base is None else base.rotation
    elimination = eliminated(motion.value, rotation, ground, unmeasured, margin)
    known_base = None
    if of_base is not None and (ground.pad_force is not None or elimination is not None):
        known_base = np.where(contact.known_of_base(ground), of_base, np.nan)
    unknown = contact.unknown_rows(ground, margin) | unmeasured
    if elimination is not None:
        of_motion = elimination.applied(of_motion, of_base)
        needed = needed - elimination.pushed(of_base, len(ticks))
        unknown[elimination.ticks] = elimination.lost
    shown = np.where(unknown, np.nan, of_motion)
    return Balance(ground, needed, shown, known_base, elimination, behind, before)


def _needed(
    log: Log,
    subject: Subject,
    ticks: np.ndarray,
    motion: Smooth,
    base: BaseMotion | None,
    shaken: LimitCycle | None,
) -> tuple[contact.Ground, np.ndarray, np.ndarray | None]:
    """What the ground does, the torque that the joints need by the nominal model, less what known
    forces of the ground give `(t, n)` [Nm], and the wrench that a floating base needs beyond these,
    with the other sign `(t, 6)`.
    """
    moved = motion.value, motion.first, motion.second
    own = None if base is None else rigid.base_wrench(subject, *moved, base)
    ground = contact.contacts(
        log, subject, ticks, motion.value, base, None if own is None else own[:, :3]
    )
    needed = rigid.inverse_dynamics(subject, *moved, base) + friction.friction_torque(
        subject, motion.value, motion.first, None if shaken is None else shaken.speed
    )
    if ground.pushing is None:
        return ground, needed, None if own is None else -own
    rotation = None if base is None else base.rotation
    pushed, wrench = pads.contact_torque(subject, motion.value, rotation, ground.pushing)
    return ground, needed - pushed, None if own is None else wrench - own
