"""What the joints of a robot on a rig may do: how far, how fast, how hard; and whether a planned
motion stays inside.

A motion is judged by inverse dynamics on the nominal model: the joint torques that it needs, rotors
and nominal friction included, turned into motor torques, against the motors' four-quadrant
envelope, and against what they hold for ever. What a robot's file does not say is bounded by the
assumed constants below. Self-collision is not checked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hyperleg_design.errors import InfeasibleError
from hyperleg_design.gap.effects.strength import joint_inertia, joint_strength, motor_strengths
from hyperleg_design.gap.model import friction, rigid
from hyperleg_design.gap.model.machine import machine_of
from hyperleg_design.gap.model.subject import Subject
from hyperleg_design.sizing.envelope import MotorEnvelope, torque_limits
from hyperleg_design.sizing.thermal import rms_torque

END_SHARE, END_LEAST = 0.08, 0.03
"""Room kept free at each end of a joint's range: share of the range, and least angle [rad];
assumed."""
FREE_RANGE = 1.0
"""Excursion to either side of joints without limits [rad]; assumed."""
LARGEST = 0.8
"""Excursion to either side that no motion needs to exceed [rad]."""
NEARER = 0.7 ** np.arange(8)
"""Shares of `LARGEST` tried until the motors hold the posture between."""
SPEED_SHARE, FASTEST = 0.6, 6.0
"""Largest joint speed over the motors' no-load speed [-]; and largest joint speed of any robot
[rad/s], also where the file states no speed; assumed."""
TORQUE_SHARE = 0.8
"""Share of the envelope that a planned motion may use [-]: the rest is left to the controller and
to what the model lacks; assumed."""
ACCELERATION_SHARE, HARDEST = 0.4, 250.0
"""Share of a joint's strength that accelerating its own inertia may take [-]; and largest
acceleration [rad/s^2]; assumed."""
UNKNOWN_RATED = 0.4
"""Continuous torque over peak torque of motors whose data sheet nobody gave; assumed."""
LONG = 3.0
"""Length from which a motion's heat counts [s]: the thermal average of `sizing.thermal`."""


@dataclass(frozen=True, eq=False)
class Room:
    """What the `n` joints of a robot on a rig may do."""

    centre: np.ndarray
    """Posture at which all motions start and end [rad]."""
    low: np.ndarray
    high: np.ndarray
    """Range that may be used [rad]."""
    speed: np.ndarray
    """Largest speed of each joint [rad/s]."""
    acceleration: np.ndarray
    """Largest acceleration of each joint [rad/s^2]."""

    @property
    def reach(self) -> np.ndarray:
        """Largest excursion to both sides of the centre `(n,)` [rad]."""
        return np.minimum(np.minimum(self.centre - self.low, self.high - self.centre), LARGEST)


@dataclass(frozen=True)
class Use:
    """How far a motion uses what is there; 1 is the limit of each."""

    range: float
    """Of the free range of the joints."""
    speed: float
    """Of the allowed speed."""
    envelope: float
    """Of the motors' peak torque, at the worst tick; infinite past the voltage line."""
    continuous: float
    """RMS over what the motors hold for ever, worst motor."""
    worst: str
    """Joint or motor that comes nearest to a limit."""

    def fits(self, long: bool) -> bool:
        """Decide whether a motion stays inside all limits.

        Args:
            long: whether the motion is long, so that the continuous limit counts, too.

        Returns:
            True if it does.
        """
        return (
            self.range <= 1 + 1e-9
            and self.speed <= 1
            and self.envelope <= TORQUE_SHARE
            and (self.continuous <= 1 or not long)
        )


def room_of(subject: Subject) -> Room:
    """Compute the room of a robot's joints around a posture with freedom to both sides.

    That posture comes as near to the default one as leaves each joint `LARGEST` to both sides, or
    less where gravity takes more than `TORQUE_SHARE` of what the motors hold for ever.

    Args:
        subject: the robot.

    Returns:
        The room.

    Raises:
        InfeasibleError: a joint that has no range to move in, or whose friction alone is more than
            its motors may give.
    """
    low, high = subject.position_low.copy(), subject.position_high.copy()
    default = np.clip(subject.default, low, high)
    low = np.where(
        np.isfinite(low),
        low,
        np.minimum(default, np.where(np.isfinite(high), high, np.inf)) - FREE_RANGE,
    )
    high = np.where(np.isfinite(high), high, default + FREE_RANGE)
    margin = np.maximum(END_SHARE * (high - low), END_LEAST)
    low, high = low + margin, high - margin
    if np.any(high <= low):
        joint = subject.joints[int(np.argmin(high - low))]
        raise InfeasibleError(
            f"{subject.name}: joint {joint} has no range to move in; give its limits in the "
            f"robot's file, or name the joints that are to move (--joints)"
        )
    strength = joint_strength(subject)
    stuck = np.flatnonzero(~subject.passive & (subject.coulomb > TORQUE_SHARE * strength))
    if len(stuck):
        named = ", ".join(
            f"{subject.joints[j]} ({subject.coulomb[j]:.3g} of {strength[j]:.3g} Nm)" for j in stuck
        )
        raise InfeasibleError(
            f"{subject.name}: friction takes more than {100 * TORQUE_SHARE:g} % of the torque of "
            f"{named}, so no motion fits; correct friction or effort, or make these joints fixed"
        )
    for size in LARGEST * NEARER:
        half = np.minimum((high - low) / 2, size)
        centre = np.clip(default, low + half, high - half)
        if holding_share(subject, centre) <= TORQUE_SHARE:
            break
    inertia = np.maximum(joint_inertia(subject) + np.diag(subject.armature), 1e-9)
    hard = np.minimum(ACCELERATION_SHARE * strength / inertia, HARDEST)
    stiffness = subject.gains[:, 0]
    # A soft controller cannot ask for more than its stiffness times the room that its target has.
    soft = np.where(
        np.isfinite(stiffness) & (stiffness > 0),
        ACCELERATION_SHARE * stiffness * half / inertia,
        np.inf,
    )
    return Room(centre, low, high, _speeds(subject), np.minimum(hard, soft))


def holding_share(subject: Subject, posture: np.ndarray) -> float:
    """Compute how much of the torque that motors give for ever gravity asks of the worst of them.

    Args:
        subject: the robot, its base fixed.
        posture: of its joints [rad], `(n,)`.

    Returns:
        The share [-].
    """
    still = np.zeros((1, len(posture)))
    needed = rigid.inverse_dynamics(subject, posture[None], still, still)
    torque = np.where(subject.passive, 0.0, needed) @ subject.motor_from_joint.T
    return float((np.abs(torque) / rated_torque(subject)).max())


def _speeds(subject: Subject) -> np.ndarray:
    """Joint speeds at which, all joints turning at once the worst way, no motor passes its share of
    the no-load speed `(n,)`.
    """
    speed = np.full(len(subject.joints), FASTEST)
    matrix = np.abs(subject.joint_from_motor)
    for motor in np.flatnonzero(np.isfinite(subject.no_load_speed)):
        total = float(matrix[:, motor] @ speed)
        allowed = SPEED_SHARE * float(subject.no_load_speed[motor])
        if total > allowed:
            speed = np.where(matrix[:, motor] > 0, speed * allowed / total, speed)
    return speed


def rated_torque(subject: Subject) -> np.ndarray:
    """Compute what each motor holds for ever: the torque of its data sheet, else a share of its
    peak torque.

    Args:
        subject: the robot.

    Returns:
        The torques [Nm], `(m,)`.
    """
    rated = machine_of(subject).rated_torque
    return np.where(np.isfinite(rated), rated, UNKNOWN_RATED * motor_strengths(subject))


def followed(subject: Subject, position: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the velocity of a motion and the joint torque that it needs, friction included.

    Args:
        subject: with its base fixed.
        position: of the motion [rad], `(t, n)`.
        step: between ticks [s].

    Returns:
        Velocity [rad/s] and torque [Nm], `(t, n)` each.
    """
    velocity = np.gradient(position, step, axis=0)
    acceleration = np.gradient(velocity, step, axis=0)
    needed = rigid.inverse_dynamics(subject, position, velocity, acceleration)
    return velocity, needed + friction.friction_torque(subject, position, velocity)


def targets_for(subject: Subject, position: np.ndarray, step: float) -> np.ndarray:
    """Compute targets at which the nominal controller gives just the torque that a motion needs.

    They lead the motion by torque over stiffness; where a joint's gains are unknown, they are the
    motion itself.

    Args:
        subject: with its base fixed.
        position: of the motion [rad], `(t, n)`.
        step: between ticks [s].

    Returns:
        The targets [rad], `(t, n)`.
    """
    velocity, torque = followed(subject, position, step)
    stiffness, damping = subject.gains.T
    known = np.isfinite(stiffness) & np.isfinite(damping) & (stiffness > 0) & ~subject.passive
    lead = (torque + np.where(known, damping, 0.0) * velocity) / np.where(known, stiffness, 1.0)
    return position + np.where(known, lead, 0.0)


def use_of(
    subject: Subject,
    room: Room,
    position: np.ndarray,
    step: float,
    torque: np.ndarray | None = None,
) -> Use:
    """Compute how far a motion uses the joints' room and the motors.

    Args:
        subject: the robot, its base fixed.
        room: of its joints.
        position: `(t, n)` [rad].
        step: between ticks [s].
        torque: motor torque, where it is known; by inverse dynamics else `(t, m)` [Nm].

    Returns:
        Shares of range, speed, envelope and continuous torque.
    """
    velocity, needed = followed(subject, position, step)
    if torque is None:
        torque = np.where(subject.passive, 0.0, needed) @ subject.motor_from_joint.T
    motor_velocity = velocity @ subject.joint_from_motor
    peak = motor_strengths(subject)
    line = np.isfinite(subject.no_load_speed) & np.isfinite(subject.stall_torque)
    far = 1e9
    envelope = MotorEnvelope(
        np.where(line, subject.no_load_speed, far),
        np.where(line, subject.stall_torque, far),
        peak,
        np.zeros(len(peak)),
        1.0,
        1.0,
    )
    lower, upper = torque_limits(envelope, motor_velocity)
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(torque >= 0, torque / np.maximum(upper, 0), torque / np.minimum(lower, 0))
        part = np.where(np.abs(torque) < 1e-9, 0.0, part)
    off = np.maximum(
        (room.centre - position) / (room.centre - room.low),
        (position - room.centre) / (room.high - room.centre),
    )
    heat = rms_torque(torque) / rated_torque(subject)
    speeds = np.abs(velocity).max(0) / room.speed
    near = {**dict(zip(subject.joints, np.maximum(off.max(0), speeds), strict=True))}
    for motor, value in zip(
        subject.motors, np.maximum(part.max(0) / TORQUE_SHARE, heat), strict=True
    ):
        near[motor] = max(near.get(motor, 0.0), float(value))
    return Use(
        float(off.max()),
        float(speeds.max()),
        float(part.max()),
        float(heat.max()),
        max(near, key=lambda name: near[name]),
    )
