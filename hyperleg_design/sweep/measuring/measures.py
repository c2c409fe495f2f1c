"""Sizing measures of a batch of designs; adding one is one function here.

Each function takes a `Batch` and returns `(n,)`, or `(n, parts)` where it has a column a part.
Nothing loops over designs. A part that a variant lacks (the torque of a toe that is gone) is nan.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from hyperleg_design.robot import masses, transmission
from hyperleg_design.robot.checks import consistency
from hyperleg_design.robot.kinematics import dimensions
from hyperleg_design.robot.laws.friction import joint_friction
from hyperleg_design.robot.models import leg_reflected_inertia
from hyperleg_design.robot.names import JOINTS, SEGMENTS
from hyperleg_design.robot.parameters.described import RobotDesign
from hyperleg_design.robot.trees import limb_masses, tree_limb
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing import zonotope
from hyperleg_design.sizing.envelope import MotorEnvelope
from hyperleg_design.sweep.measuring.batch import Batch
from hyperleg_design.sweep.measuring.measure import BOTH, HYPERLEG, MEASURES, TREE, Measure, measure
from hyperleg_design.sweep.measuring.reference_loads import StaticLoad

PUSH_OFF_DIRECTION = {"knee": -1.0, "ankle_pitch": 1.0}
"""Joint speeds of `push_off_power` over each other: knee extension and plantar flexion alike, the
toe held (assumed)."""


def columns(names: Iterable[str], design: RobotDesign | None = None) -> tuple[str, ...]:
    """List the table columns of some measures.

    Args:
        names: of the measures.
        design: a robot; HyperLeg by default.

    Returns:
        Names of the columns.
    """
    return tuple(c for name in names for c in MEASURES[name].columns_of(design))


def measures_of(design: RobotDesign) -> tuple[str, ...]:
    """List the measures that a design has.

    Args:
        design: a robot or batch.

    Returns:
        Names of the measures.
    """
    family = TREE if isinstance(design, TreeDesign) else HYPERLEG
    return tuple(name for name, entry in MEASURES.items() if family in entry.families)


def measure_of(column: str) -> Measure:
    """Look up the measure that a column belongs to.

    Args:
        column: name of the column.

    Returns:
        The measure.

    Raises:
        KeyError: no such column.
    """
    if column in MEASURES:
        return MEASURES[column]
    parts = column.split(".")
    for end in range(len(parts) - 1, 0, -1):
        entry = MEASURES.get(".".join(parts[:end]))
        if entry is not None and entry.parts:
            return entry
    raise KeyError(column)


def label(column: str) -> str:
    """Write a column's name with unit, for figures and tables.

    Args:
        column: name of the column.

    Returns:
        The text.
    """
    measure = measure_of(column)
    name = column.replace("_", " ").replace(".", ", ")
    return f"{name} [{measure.unit.replace('^2', '²')}]" if measure.unit else name


def evaluate(design: RobotDesign, names: Iterable[str] | None = None) -> dict[str, np.ndarray]:
    """Measures of a design or batch of one variant.

    Args:
        design: a robot or batch.
        names: of `MEASURES`; all that the design has by default.

    Returns:
        By column, `(n,)` each (`(1,)` for one robot).

    Raises:
        InputError: an inertia that no body has (see `inertials`).
    """
    batch = Batch(design)
    columns: dict[str, np.ndarray] = {}
    for name in measures_of(design) if names is None else names:
        entry = MEASURES[name]
        values = np.asarray(entry.compute(batch), float)
        if not entry.parts:
            columns[name] = np.array(np.broadcast_to(values, (batch.size,)))
            continue
        # joints or motors that this variant lacks come last in their order
        own = entry.columns_of(design)
        padded = np.full((batch.size, len(own)), np.nan)
        padded[:, : values.shape[-1]] = values
        columns |= {column: padded[:, i].copy() for i, column in enumerate(own)}
    return columns


@measure("kg", "low", families=BOTH)
def total_mass(batch: Batch) -> np.ndarray:
    """Mass of the whole robot."""
    return np.asarray(dimensions.total_mass(batch.design))


@measure("kg", "low", families=BOTH)
def leg_mass(batch: Batch) -> np.ndarray:
    """Mass of a single leg."""
    return np.asarray(dimensions.limb_mass(batch.design))


@measure("m", "high")
def leg_length(batch: Batch) -> np.ndarray:
    """Length of the straight leg, from the hip-pitch axis to the sole."""
    return consistency.leg_length(batch.design)


@measure("m", "low")
def height(batch: Batch) -> np.ndarray:
    """Height of the robot from the sole to the top of the pelvis, legs straight."""
    return consistency.leg_length(batch.design) + batch.design.pelvis.height


@measure("kg", "low", SEGMENTS, usual=False)
def segment_mass(batch: Batch) -> np.ndarray:
    """Mass of the pelvis, and of each segment of one leg."""
    return _stacked([getattr(batch.masses, segment) for segment in SEGMENTS], batch.size)


@measure("kg", "low", families=(TREE,), usual=False)
def limb_mass(batch: Batch) -> np.ndarray:
    """Mass of a single limb."""
    return np.asarray(dimensions.limb_mass(batch.design))


@measure("m", "low", families=(TREE,), usual=False)
def standing_height(batch: Batch) -> np.ndarray:
    """Height of the base over the floor in the default posture."""
    return np.asarray(dimensions.standing_height(batch.design))


def _links(design: Any) -> tuple[str, ...]:
    return tuple(limb_masses.limb_masses(design).links)


@measure("kg", "low", ("LINK",), families=(TREE,), usual=False, parts_of=_links)
def link_mass(batch: Batch) -> np.ndarray:
    """Mass of each link of one limb."""
    links = limb_masses.limb_masses(batch.design).links.values()
    return _stacked([body.mass for body in links], batch.size)


@measure("kg m^2", "low", ("JOINT",), families=(TREE,), usual=False)
def link_inertia(batch: Batch) -> np.ndarray:
    """Inertia about each joint of what is behind it in the default posture, without rotors."""
    default = tree_limb.default_position(batch.design)
    joints = transmission.joint_names(batch.design)
    behind = [limb_masses.behind(batch.design, joint, default)[2] for joint in joints]
    return _stacked(behind, batch.size)


def _stacked(values: list[Any], size: int) -> np.ndarray:
    """One column a value, `(n, columns)`."""
    return np.stack([np.broadcast_to(np.asarray(v, float), (size,)) for v in values], -1)


@measure("", "low")
def distal_share(batch: Batch) -> np.ndarray:
    """Share of the leg's mass that is below the knee."""
    return batch.leg.distal_share


@measure("kg m^2", "low")
def swing_inertia(batch: Batch) -> np.ndarray:
    """Inertia of one straight leg about the hip-pitch axis, without rotors."""
    return batch.leg.swing_inertia


@measure("", "low")
def gyration_over_length(batch: Batch) -> np.ndarray:
    """Radius of gyration of the swinging leg about the hip over its length; 0.577 for a uniform
    rod.
    """
    return batch.leg.gyration_over_length


@measure("kg", "low", families=BOTH)
def actuator_mass(batch: Batch) -> np.ndarray:
    """Motors and gears of one leg."""
    return sum(
        (
            np.asarray(masses.built_mass(batch.design, actuator))
            for actuator in batch.design.actuator_sections.values()
        ),
        start=np.zeros(()),
    )


@measure("Nm", "high", JOINTS, families=BOTH)
def max_joint_torque(batch: Batch) -> np.ndarray:
    """Largest torque of each joint whatever the others do, standing, derated, as Table I of the
    paper.
    """
    return transmission.max_joint_torque(batch.design, "standing")


@measure("Nm", "high", JOINTS, families=BOTH)
def torque_alone(batch: Batch) -> np.ndarray:
    """Largest torque of each joint while the others have none, walking, at standstill, not
    derated.
    """
    matrix, limit = batch.walking, batch.envelope.standstill_torque
    return np.stack([zonotope.alone(matrix, -limit, limit, j) for j in range(matrix.shape[-2])], -1)


@measure("Nm", "low", JOINTS, families=BOTH)
def coulomb_friction(batch: Batch) -> np.ndarray:
    """Coulomb friction of each joint by the design's law of friction."""
    moving = len(transmission.joint_names(batch.design))
    return joint_friction(batch.design)[0][..., :moving]


@measure("rad/s", "high", JOINTS, families=BOTH)
def single_joint_speed(batch: Batch) -> np.ndarray:
    """No-load speed of each joint while the others stand still, walking."""
    return transmission.single_joint_speed(batch.design, "walking")


@measure("Nm", "high", families=BOTH)
def zonotope_size(batch: Batch) -> np.ndarray:
    """Edge of the cube whose volume is that of the torques which the joints below the hip can have
    together, walking.
    """
    matrix, limit = batch.below_hip()
    return zonotope.volume(matrix, -limit, limit) ** (1.0 / matrix.shape[-2])


@measure("", "high", families=BOTH)
def zonotope_to_box_volume(batch: Batch) -> np.ndarray:
    """Share of the box of single-joint maxima that the joints below the hip can reach together,
    walking.
    """
    matrix, limit = batch.below_hip()
    return zonotope.zonotope_to_box_volume(matrix, -limit, limit)


@measure("kg m^2", "low", JOINTS, families=BOTH)
def reflected_inertia(batch: Batch) -> np.ndarray:
    """Rotor inertia at each joint, the diagonal of M diag(J) M^T, walking."""
    return np.diagonal(leg_reflected_inertia(batch.design, "walking"), axis1=-2, axis2=-1)


@measure("kg m^2", "low", families=BOTH)
def reflected_inertia_norm(batch: Batch) -> np.ndarray:
    """Rotor inertia of the joints below the hip in its worst direction, the spectral norm of M
    diag(J) M^T, walking.
    """
    whole = leg_reflected_inertia(batch.design, "walking")
    return np.linalg.eigvalsh(whole[..., batch.start :, batch.start :])[..., -1]


def _holding_heat(batch: Batch, load: StaticLoad) -> np.ndarray:
    tau = transmission.motor_torque(batch.walking, load.torque, batch.envelope.power_constant)
    return np.sum(batch.envelope.power_constant * tau**2, -1)


@measure("Nm", "high", JOINTS, usual=False, name="joint_limits.max_torque")
def joint_limits_max_torque(batch: Batch) -> np.ndarray:
    """Largest torque of each joint whatever the others do, walking, at standstill, not derated."""
    return transmission.joint_torque(np.abs(batch.walking), batch.envelope.standstill_torque)


@measure("Nm", "high", JOINTS, usual=False, name="joint_limits.torque_alone")
def joint_limits_torque_alone(batch: Batch) -> np.ndarray:
    """Largest torque of each joint while the others have none, walking, at standstill, not
    derated; the same as `torque_alone`.
    """
    return torque_alone(batch)


@measure("rad/s", "high", JOINTS, usual=False, name="joint_limits.speed")
def joint_limits_speed(batch: Batch) -> np.ndarray:
    """No-load speed of each joint while the others stand still, walking; the same as
    `single_joint_speed`.
    """
    return single_joint_speed(batch)


@measure("kg m^2", "low", JOINTS, usual=False, name="joint_limits.reflected_inertia")
def joint_limits_reflected_inertia(batch: Batch) -> np.ndarray:
    """Rotor inertia at each joint, the diagonal of M diag(J) M^T, walking; the same as
    `reflected_inertia`.
    """
    return reflected_inertia(batch)


@measure("W", "low")
def squat_heat(batch: Batch) -> np.ndarray:
    """Joule heat of one leg that holds half the robot in a squat (`reference_loads`), least-heat
    motor torques, walking.
    """
    return _holding_heat(batch, batch.squat)


@measure("W", "low")
def push_off_heat(batch: Batch) -> np.ndarray:
    """Joule heat of one leg that carries the push-off load (`reference_loads`), least-heat motor
    torques, walking.
    """
    return _holding_heat(batch, batch.push_off)


@measure("", "low")
def push_off_use(batch: Batch) -> np.ndarray:
    """Largest motor torque in that push-off over what the motor gives at standstill; above 1 the
    motors cannot hold it that way.
    """
    tau = transmission.motor_torque(
        batch.walking, batch.push_off.torque, batch.envelope.power_constant
    )
    return np.max(np.abs(tau) / batch.envelope.standstill_torque, -1)


@measure("W", "high")
def push_off_power(batch: Batch) -> np.ndarray:
    """Largest power of one leg that extends knee and ankle at equal speed with the toe held,
    walking, inside all envelopes.
    """
    names = transmission.joint_names(batch.design)
    direction = np.array([PUSH_OFF_DIRECTION.get(name, 0.0) for name in names])
    speed = np.abs(transmission.motor_velocity(batch.walking, direction))
    return largest_power(batch.envelope, speed)


def largest_power(envelope: MotorEnvelope, speed: np.ndarray) -> np.ndarray:
    """Compute the largest summed power over the rates s at which the motors turn together at `s
    speed`.

    The rate is bounded by that at which the first motor reaches its top speed, past which its
    driver has no hold of it. Each motor gives s v min(peak, stall (1 - s v / w0)), concave in s:
    the derivative of the sum is piecewise linear and falls, with kinks at the motors' corner
    speeds, so its root is exact in one of the intervals between them.

    Args:
        envelope: limits, `(..., motors)`.
        speed: each motor's speed at s = 1, not negative, `(..., motors)` [rad/s].

    Returns:
        The power [W], `(...)`.
    """
    peak, stall, free = envelope.peak_torque, envelope.stall_torque, envelope.no_load_speed
    turning = speed > 0
    safe = np.where(turning, speed, 1.0)
    corner = np.where(turning, envelope.corner_speed / safe, np.inf)
    kinks = np.concatenate([np.zeros((*corner.shape[:-1], 1)), np.sort(corner, -1)], -1)
    # in the interval that starts at a kink: motors past their corner follow the voltage line, the
    # others give peak torque
    past = (corner[..., None, :] <= kinks[..., :, None]) & turning[..., None, :]
    constant = np.sum(
        speed[..., None, :] * np.where(past, stall[..., None, :], peak[..., None, :]), -1
    )
    slope = np.sum(np.where(past, (2 * stall * speed**2 / free)[..., None, :], 0.0), -1)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.where(slope > 0, constant / slope, np.inf)
    # a motor that stands still has its kink at infinity: that interval is none
    start = np.where(np.isfinite(kinks), kinks, 0.0)
    end = np.concatenate([kinks[..., 1:], np.full((*corner.shape[:-1], 1), np.inf)], -1)
    limit = np.min(np.where(turning, envelope.top_speed / safe, np.inf), -1)[..., None]
    rate = np.minimum(np.maximum(start, np.minimum(root, end)), limit)
    rate = np.where(np.isfinite(rate), rate, 0.0)
    turned = rate[..., :, None] * speed[..., None, :]
    torque = np.minimum(peak[..., None, :], stall[..., None, :] * (1 - turned / free[..., None, :]))
    return np.max(np.sum(turned * torque, -1), -1)
