"""The machine that a robot is to its drives, all limbs in one."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.robot import transmission
from hyperleg_design.robot.laws import gear
from hyperleg_design.robot.motors import gather
from hyperleg_design.simulation.drives.actuation import ActuationModel, actuation_model
from hyperleg_design.simulation.layout import layout_of

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign


def machine_of(design: RobotDesign) -> Machine:
    """Describe the joints and motors of one robot for the actuation model.

    Args:
        design: one robot.

    Returns:
        Arrays `(J,)`, `(K,)` and `(J, K)` in the order of `layout_of(design)`.
    """
    layout = layout_of(design)
    return machine_from(
        actuation_model(design),
        layout.joints,
        layout.motors,
        rotor_inertia(design),
        bus_voltage(design),
    )


def machine_from(
    model: ActuationModel,
    joints: tuple[str, ...],
    motors: tuple[str, ...],
    inertia: np.ndarray,
    voltage: float = float("nan"),
) -> Machine:
    """Describe joints and motors from the actuation model of the legs.

    Args:
        model: constants of one leg `(k,)`, or of all L limbs in n simulations `(n, L, k)`.
        joints: names, limb after limb.
        motors: names, limb after limb.
        inertia: of the rotors of one leg [kg m^2], `(..., motors)`.
        voltage: of the battery [V].

    Returns:
        The machine; arrays `(J,)`, `(K,)`, `(J, K)`, or with n in front.
    """
    limbs = len(joints) // model.joint_from_motor.shape[-2]

    def both(values: np.ndarray) -> np.ndarray:
        values = np.asarray(values, float)
        if values.ndim == 1:
            return np.tile(values, limbs)
        return np.broadcast_to(values, (len(values), limbs, values.shape[-1])).reshape(
            len(values), -1
        )

    def blocks(matrix: np.ndarray) -> np.ndarray:
        matrix = np.asarray(matrix, float)
        if matrix.ndim > 2:
            return legs_matrix(matrix, limbs)
        return legs_matrix(matrix[None, None], limbs)[0]

    envelope = model.envelope
    inertia = np.asarray(inertia, float)
    return Machine(
        joints=joints,
        motors=motors,
        joint_from_motor=blocks(model.joint_from_motor),
        motor_from_joint=blocks(model.motor_from_joint),
        stiffness=both(model.stiffness),
        damping=both(model.damping),
        rotor_inertia=np.concatenate([inertia] * limbs, -1),
        no_load_speed=both(envelope.no_load_speed),
        stall_torque=both(envelope.stall_torque),
        peak_torque=both(envelope.peak_torque),
        power_constant=both(envelope.power_constant),
        rated_torque=both(model.rated_torque),
        voltage=voltage,
    )


def legs_matrix(matrix: np.ndarray, limbs: int = 2) -> np.ndarray:
    """Combine the matrices of all limbs into one block-diagonal matrix.

    Args:
        matrix: `(n, limbs, rows, columns)`, or `(n, 1, rows, columns)` where the limbs share one.
        limbs: number of limbs.

    Returns:
        `(n, limbs rows, limbs columns)`.
    """
    rows, columns = matrix.shape[-2:]
    whole = np.zeros((len(matrix), limbs * rows, limbs * columns))
    for limb in range(limbs):
        place = slice(limb * rows, (limb + 1) * rows), slice(limb * columns, (limb + 1) * columns)
        whole[:, place[0], place[1]] = matrix[:, min(limb, matrix.shape[1] - 1)]
    return whole


def bus_voltage(design: RobotDesign) -> float:
    """Compute the bus voltage: nominal voltage of the motors times the design's ratio.

    Args:
        design: a robot or batch.

    Returns:
        The voltage [V]; NaN where motors, or designs of a batch, differ in it.
    """
    voltages = {
        float(v)
        for actuator in design.every_actuator
        for v in np.ravel(gather(actuator.motor, lambda m: m.nominal_voltage))
    }
    ratios = {float(v) for v in np.ravel(design.electrical_section.voltage_ratio)}
    return voltages.pop() * ratios.pop() if len(voltages) == len(ratios) == 1 else float("nan")


def rotor_inertia(design: RobotDesign) -> np.ndarray:
    """Compute the rotor inertia of the motors of one leg.

    Args:
        design: a robot or batch.

    Returns:
        The inertia [kg m^2], `(motors,)` or `(n, motors)`.
    """
    return gear.rotor_inertia(design)[..., : len(transmission.motor_names(design))]


@dataclass(frozen=True, eq=False)
class Machine:
    """Controller, motors and transmission of a robot of J joints and K motors; each array may lead
    with the simulations.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    joint_from_motor: np.ndarray
    """M of the transmission as it is, `(J, K)` [-]: joint torque M tau, motor velocity M^T
    q_dot."""
    motor_from_joint: np.ndarray
    """Matrix by which the controller turns joint torques into motor torques, `(K, J)` [-]."""
    stiffness: np.ndarray
    """Position gains of the controller [Nm/rad], `(J,)`."""
    damping: np.ndarray
    """Velocity gains of the controller [Nms/rad], `(J,)`."""
    rotor_inertia: np.ndarray
    """Rotor inertia on the motor's side of M [kg m^2], `(K,)`; the simulator keeps it where its
    model has it."""
    no_load_speed: np.ndarray
    """No-load speed [rad/s], `(K,)`; infinite where unlimited."""
    stall_torque: np.ndarray
    """Where the voltage line meets zero speed [Nm], `(K,)`; inf where unlimited."""
    peak_torque: np.ndarray
    """Peak torque [Nm], `(K,)`; infinite where unlimited."""
    power_constant: np.ndarray
    """Joule heat over squared torque [W/Nm^2], `(K,)`; 0 where unknown."""
    rated_torque: np.ndarray
    """Continuous torque [Nm], `(K,)`; inf where unknown."""
    voltage: float = float("nan")
    """Nominal, of the battery [V]; NaN where unknown."""
    free: np.ndarray | None = None
    """Rotors that an alteration moves by itself, `(K,)` of bool; set by `Belt`."""

    @property
    def rigid_inertia(self) -> np.ndarray:
        """Rotor inertia that belongs into the simulator's model [kg m^2], `(K,)`."""
        return np.asarray(
            self.rotor_inertia
            if self.free is None
            else np.where(self.free, 0.0, self.rotor_inertia)
        )

    def joint(self, name: str) -> int:
        """Find a joint in all arrays over joints.

        Args:
            name: of the joint.

        Returns:
            Its index.
        """
        return self.joints.index(name)

    def motor(self, name: str) -> int:
        """Find a motor in all arrays over motors.

        Args:
            name: of the motor.

        Returns:
            Its index.
        """
        return self.motors.index(name)

    def changed(self, field: str, place: int, change: Callable[[np.ndarray], Any]) -> Machine:
        """Copy the machine with another constant of one joint or motor.

        Args:
            field: name of a `(J,)` or `(K,)` field.
            place: of the joint or motor.
            change: from the constant, `()` or `(n,)`, to the new one, `()` or `(n,)`.

        Returns:
            The copy.
        """
        old = np.asarray(getattr(self, field), float)
        new = np.asarray(change(old[..., place]), float)
        values = np.array(
            np.broadcast_to(old, (*np.broadcast_shapes(old.shape[:-1], new.shape), old.shape[-1]))
        )
        values[..., place] = new
        changes: dict[str, Any] = {field: values}
        return dataclasses.replace(self, **changes)
