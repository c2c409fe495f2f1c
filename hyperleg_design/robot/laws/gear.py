"""What a reduction other than the reference build's changes besides torque and speed: the inertia
of the gears at the rotors, the mass of the stages behind the gears, and the loss under load.

Every law gives *changes against the reference build*, so a design at its reference reductions keeps
its declared numbers to the last bit. Law `catalogue`, with T the peak torque at a gear's or a
stage's output and r a total reduction, |M| of `transmission.joint_from_motor`:

    gear inertia at the rotor    J = c T^(5/3)             similar gears: T ~ length^3, J ~ length^5
    mass of a stage              m = k T                   similar stages: m ~ length^3
    loss under load              1 - eta = loss log2(r)    equal stages in series, small losses

A design that writes its tree out has a reference build, too: the motor and gear under `reference`,
those of its file by default, with the reductions behind the gears that it has now. Its stages behind
the gears are part of the links' masses, whatever the gears.

A rotor's declared inertia holds that of its gear. It never falls below the share that similar gears
leave if all of it were the gear's, (T / T_reference)^(5/3), so it stays positive.

The mass of the gear at a motor is `masses.gear_mass_per_torque`, which follows the same m = k T.
The loss acts at each motor's rated torque and enters the friction of the joint (`friction`), so all
rooms pay for it in the same place. The catalogue behind the three coefficients is cited in the design
file. Another law is one function, registered with `gear_law`.
"""  # noqa: E501

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from hyperleg_design.memoized import memoized
from hyperleg_design.robot import motors, transmission
from hyperleg_design.robot.laws.laws import Laws
from hyperleg_design.robot.names import ACTUATOR_OF_MOTOR, JOINTS
from hyperleg_design.robot.trees.tree_design import TreeDesign

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign
    from hyperleg_design.robot.parameters.hyperleg import HyperLeg

STAGE_PLACES = {
    "knee": ("thigh", 1.0),
    "ankle_pitch": ("shank", 1.0),
    "ankle_roll": ("shank", 1.0),
    "toe": ("shank", 1.0),
}
"""Segment that carries the stage of each joint below the hip, and where along it from the upper
joint [-]: at the knee's axis, and at the ankle's, where the toe's idler sits, too. The hip has no
stage behind its gears."""
_REFERENCE_OF_ACTUATOR = {"hip_yaw": "hip", "hip_roll": "hip", "hip_pitch": "hip"}


@dataclass(frozen=True, eq=False)
class GearChange:
    """Changes against the reference build, of one leg of a design or batch."""

    rotor_inertia: Any = 0.0
    """Additional inertia at the rotor of each motor [kg m^2], `(..., 7)`."""
    load_torque: Any = 0.0
    """Coulomb torque at each joint that stands for the loss under load [Nm], `(..., 7)`."""
    stage_mass: Mapping[str, Any] = field(default_factory=dict)
    """Additional mass of the stage of each joint of `STAGE_PLACES` [kg], `(...)`."""


Law = Callable[["HyperLeg | TreeDesign"], GearChange]
_LAWS: Laws[Law] = Laws("gears")
gear_law = _LAWS.register
"""Registers a law of gears under the name that `gears.law` uses."""


def gear_change(design: HyperLeg | TreeDesign) -> GearChange:
    """Compute the changes against the reference build by the design's law.

    Args:
        design: a robot or batch.

    Returns:
        Changes of inertia, mass and loss.

    Raises:
        InputError: no such law.
    """
    names = [*actuator_parts(design, "motor"), *reference_parts(design, "motor")]
    return _changed(design, _LAWS.of(design), tuple(motors.motors_by_name(names).values()))


@memoized
def _changed(
    design: HyperLeg | TreeDesign, law: Law, _motors: tuple[motors.Motor, ...]
) -> GearChange:
    """What a law gives for a design, once for as long as its names mean the same motors."""
    return law(design)


@gear_law("declared")
def declared(design: HyperLeg | TreeDesign) -> GearChange:
    """Change nothing, whatever the reductions.

    Args:
        design: a robot or batch.

    Returns:
        No change.
    """
    return GearChange()


@gear_law("catalogue")
def catalogue(design: HyperLeg | TreeDesign) -> GearChange:
    """Scale similar gears and stages to other torques, and put equal stages in series; see the
    module.

    Args:
        design: a robot or batch.

    Returns:
        Changes of rotor inertia, mass of stages, and loss.
    """
    gears = design.gears
    matrix, reference = absolute_reductions(design)
    peak, reference_peak = peak_torques(design)
    own, stated = actuator_parts(design, "gear"), reference_parts(design, "gear")
    at_gear = (_of_motors(own) * peak, _of_motors(stated) * reference_peak)
    growth = (at_gear[0] / at_gear[1]) ** (5 / 3)
    inertia = np.maximum(
        np.expand_dims(gears.inertia_per_torque, -1) * at_gear[1] ** (5 / 3) * (growth - 1.0),
        motors.motor_arrays(design).rotor_inertia * (np.minimum(growth, 1.0) - 1.0),
    )
    at_joint = transmission.joint_torque(matrix, peak) - transmission.joint_torque(
        reference, reference_peak
    )
    stage = {
        name: gears.stage_mass_per_torque * at_joint[..., JOINTS.index(name)]
        for name in ({} if isinstance(design, TreeDesign) else STAGE_PLACES)
    }
    # A motor that a design decouples from a joint has no loss there, before or after.
    coupled = (matrix > 0) & (reference > 0)
    doublings = np.log2(np.where(coupled, matrix, 1.0) / np.where(coupled, reference, 1.0))
    rated = _of_motors(
        [motors.gather(name, lambda m: m.rated_torque) for name in actuator_parts(design, "motor")]
    ) * installed(design)
    load = np.expand_dims(gears.loss_per_doubling, -1) * transmission.joint_torque(
        matrix * doublings, rated
    )
    return GearChange(inertia, load, stage)


def rotor_inertia(design: RobotDesign) -> np.ndarray:
    """Compute the inertia that turns with each motor: the rotor and the change of its gear.

    Args:
        design: a robot or batch.

    Returns:
        The inertia [kg m^2], `(..., motors)`; for HyperLeg, of all seven motors.
    """
    rotors = motors.motor_arrays(design).rotor_inertia
    change = gear_change(cast("HyperLeg | TreeDesign", design))
    return np.asarray(rotors + change.rotor_inertia, float)


def absolute_reductions(design: HyperLeg | TreeDesign) -> tuple[np.ndarray, np.ndarray]:
    """Compute |M| of the design and of its reference build, in the posture of the design.

    Args:
        design: a robot or batch.

    Returns:
        The two matrices [-], each `(..., joints, motors)`; for HyperLeg `(..., 7, 7)`.
    """
    if isinstance(design, TreeDesign):
        matrix = np.abs(transmission.joint_from_motor(design))
        gears = [_of_motors(part(design, "gear")) for part in (reference_parts, actuator_parts)]
        return matrix, matrix * (gears[0] / gears[1])[..., None, :]
    return (
        np.abs(transmission.full_joint_from_motor(design)),
        np.abs(transmission.reference_joint_from_motor(design)),
    )


def peak_torques(design: HyperLeg | TreeDesign) -> tuple[np.ndarray, np.ndarray]:
    """Compute the peak torques of the motors of a limb.

    Args:
        design: a robot or batch.

    Returns:
        Those of the design and those of its reference build [Nm], each `(..., motors)`. The motor
        of HyperLeg's toe counts where it is not installed, too.
    """

    def peak(names: list[Any]) -> np.ndarray:
        kind = design.electrical_section.constants
        return _of_motors([motors.gather(n, lambda m: m.peak_torque(kind)) for n in names])

    return (
        peak(actuator_parts(design, "motor")),
        peak(reference_parts(design, "motor")),
    )


def installed(design: HyperLeg | TreeDesign) -> np.ndarray:
    """State which motors of a limb are there.

    Args:
        design: a robot or batch.

    Returns:
        1 for each motor that is there, 0 for a toe motor that is not, `(motors,)`.
    """
    there = np.ones(len(design.every_actuator))
    there[len(transmission.motor_names(design)) :] = 0.0
    return there


def actuator_parts(design: HyperLeg | TreeDesign, part: str) -> list[Any]:
    """Collect one field of the actuators of a limb.

    Args:
        design: a robot or batch.
        part: `motor` or `gear`.

    Returns:
        The value for each motor.
    """
    return [getattr(actuator, part) for actuator in design.every_actuator]


def reference_parts(design: HyperLeg | TreeDesign, part: str) -> list[Any]:
    """Collect one field of the reference build's actuators of a limb.

    Args:
        design: a robot or batch.
        part: `motor` or `gear`.

    Returns:
        The value for each motor.
    """
    if isinstance(design, TreeDesign):
        return [getattr(design.reference_sections[n], part) for n in design.actuator_sections]
    return [reference_part(design, actuator, part) for actuator in ACTUATOR_OF_MOTOR]


def reference_part(design: HyperLeg, actuator: str, part: str) -> Any:
    """Look up one field of the reference build for an actuator of the design.

    Args:
        design: a robot or batch.
        actuator: name of the actuator in the design.
        part: `motor` or `gear`.

    Returns:
        The value.
    """
    return getattr(design.reference, f"{_REFERENCE_OF_ACTUATOR.get(actuator, actuator)}_{part}")


def _of_motors(values: list[Any]) -> np.ndarray:
    return np.stack(np.broadcast_arrays(*values), -1).astype(float)
