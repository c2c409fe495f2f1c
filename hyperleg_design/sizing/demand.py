"""What a motion demands of every motor: torque, speed, heat, and what is left to the envelope.

The motion's inverse dynamics (Pinocchio, rotor inertia included) plus joint friction must come from
the contact forces and from the motors; `allocation` splits them at least Joule heat. Both legs have
the same motors.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.laws import friction
from hyperleg_design.robot.laws.friction import FRICTION_SPEED
from hyperleg_design.robot.models import GRAVITY
from hyperleg_design.robot.motors import motor_arrays
from hyperleg_design.robot.transmission import (
    joint_from_motor,
    joint_names,
    motor_names,
    motor_velocity,
)
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.sizing.allocation import Allocation, least_heat
from hyperleg_design.sizing.contacts import contact_kinematics
from hyperleg_design.sizing.energy import EnergyLedger, EnergySums, cost_of_transport, energy_ledger
from hyperleg_design.sizing.envelope import MotorEnvelope, motor_envelope, torque_limits
from hyperleg_design.sizing.motions.motion import Motion
from hyperleg_design.sizing.motions.reference import reference_motion
from hyperleg_design.sizing.thermal import thermal_use

if TYPE_CHECKING:
    from hyperleg_design.robot.design import Design


@dataclass(frozen=True, eq=False)
class Demand:
    """Demand of one motion on one robot; legs are left, right."""

    design: Design = field(repr=False)
    motion: Motion = field(repr=False)
    joint_torque: np.ndarray
    """Given by the motors to the joints [Nm], `(n, 2, joints)`."""
    motor_torque: np.ndarray
    """Motor torques over time [Nm], `(n, 2, motors)`."""
    motor_velocity: np.ndarray
    """Motor speeds over time [rad/s], `(n, 2, motors)`."""
    lower: np.ndarray
    """Least torque at that speed [Nm], `(n, 2, motors)`."""
    upper: np.ndarray
    """Largest torque at that speed [Nm], `(n, 2, motors)`."""
    allocation: Allocation
    ledger: EnergyLedger
    """Powers [W] of all motors, left leg's first, `(n, 2 * motors)`."""

    @property
    def margin(self) -> np.ndarray:
        """Torque to the nearer limit [Nm], `(n, 2, motors)`; negative beyond the envelope."""
        return np.minimum(self.upper - self.motor_torque, self.motor_torque - self.lower)

    @property
    def beyond(self) -> np.ndarray:
        """Whether some motor is beyond its envelope, or the contacts cannot balance the base,
        `(n,)`.
        """
        return np.any(self.allocation.excess > 0, (1, 2)) | np.any(self.allocation.gap != 0, 1)

    @property
    def beyond_share(self) -> float:
        """Part of the time that is beyond the robot [-]."""
        return float(np.mean(self.beyond))

    @property
    def power(self) -> EnergySums:
        """Mean powers of all motors together [W]."""
        return self.ledger.mean_power().total()

    def cost_of_transport(self, side: str = "motor") -> float:
        """Compute the cost of transport, energy / (m g distance).

        Args:
            side: `motor` for the energy at the motors (the paper's), or `battery`.

        Returns:
            The cost [-].

        Raises:
            InputError: a motion that goes nowhere, or a side that is none.
        """
        if side not in ("motor", "battery"):
            raise InputError("cost of transport", "side", side, "expects motor or battery")
        energy = self.ledger.energy().total()
        mass = self.motion.model.tree.mass
        return float(
            cost_of_transport(
                energy.motor_side if side == "motor" else energy.battery, mass, self.motion.distance
            )
        )

    def table(self) -> list[dict[str, Any]]:
        """Tabulate the demand on the motors.

        Returns:
            One row for each motor of a limb; the worse leg counts.
        """
        arrays, names = motor_arrays(self.design), motor_names(self.design)
        powers = self.ledger.mean_power()
        torque = np.swapaxes(self.motor_torque, 0, 1)
        use = thermal_use(
            torque,
            arrays.rated_torque[: len(names)],
            self.motion.time_step,
            periodic=self.motion.periodic,
        )
        rows = []
        for m, name in enumerate(names):
            least, speed = (
                float(self.margin[..., m].min()),
                float(np.abs(self.motor_velocity[..., m]).max()),
            )
            rows.append(
                {
                    "motor": name,
                    "peak_torque": float(np.abs(self.motor_torque[..., m]).max()),
                    "rms_torque": float(use.rms_torque[:, m].max()),
                    "rms_over_rated": float(use.continuous_use[:, m].max()),
                    "peak_speed": speed,
                    "speed_over_no_load": speed / float(arrays.no_load_speed[m]),
                    "margin": least,
                    "margin_over_peak": least / float(arrays.peak_torque[m]),
                    "joule": float(powers.joule.reshape(2, -1)[:, m].sum()),
                    "mechanical": float(powers.mechanical.reshape(2, -1)[:, m].sum()),
                }
            )
        return rows

    def summary(self) -> dict[str, Any]:
        """Summarise the demand in plain numbers for a page or JSON.

        Returns:
            Mean powers [W], the cost of transport where the motion travels, the share beyond the
            envelopes, the worst margin, and the table.
        """
        power = self.power
        values = {
            "design": self.design.name,
            "variant": self.design.variant,
            "motion": self.motion.name,
            "duration": self.motion.duration,
            "distance": self.motion.distance,
            "joule": float(power.joule),
            "mechanical": float(power.mechanical),
            "mechanical_absolute": float(power.mechanical_absolute),
            "motor_side": float(power.motor_side),
            "battery": float(power.battery),
            "beyond_share": self.beyond_share,
            "margin_over_peak": min(row["margin_over_peak"] for row in self.table()),
            "assumptions": dict(self.motion.assumptions),
            "motors": self.table(),
        }
        if self.motion.distance > 0:
            values["cost_of_transport"] = self.cost_of_transport("motor")
            values["cost_of_transport_battery"] = self.cost_of_transport("battery")
        return values


def joint_friction(design: Design, velocity: np.ndarray) -> np.ndarray:
    """Compute the friction that the motors must overcome, `coulomb tanh(v / v_m) + viscous v`.

    Args:
        design: a robot or batch.
        velocity: joint velocities v [rad/s], `(..., joints)`; v_m is `FRICTION_SPEED`.

    Returns:
        The torque [Nm], `(..., joints)`.
    """
    moving = slice(len(joint_names(design)))
    coulomb, viscous = (part[..., moving] for part in friction.joint_friction(design))
    return coulomb * np.tanh(np.asarray(velocity) / FRICTION_SPEED) + viscous * velocity


def required_forces(motion: Motion) -> np.ndarray:
    """Compute the generalised forces that contacts and motors must give, joint friction included.

    Args:
        motion: n states of a robot.

    Returns:
        The forces [N, Nm], `(n, nv)`.
    """
    model = motion.model
    required = np.stack(
        [model.inverse_dynamics(*state) for state in zip(motion.q, motion.v, motion.a, strict=True)]
    )
    required[:, 6:] += joint_friction(model.design, motion.joint_velocity).reshape(
        len(required), -1
    )
    return required


def demand(design: Design, motion: Motion | str, *, allow_excess: bool = True) -> Demand:
    """Demand of a motion on a robot.

    Args:
        design: a robot.
        motion: planned for this design, or the name of a reference motion.
        allow_excess: report what lies beyond the envelopes; else it is an error.

    Returns:
        Torques and speeds of every motor over the motion, their margins, energies and heat.

    Raises:
        InputError: a batch, a motion planned for another design, no such motion, or a design that
            writes its tree out.
        InfeasibleError: the legs cannot do the motion, or `allow_excess` is off and the motors
            cannot.
    """
    if isinstance(design, TreeDesign):
        remedy = "has no planned motions, which need HyperLeg's legs; analyze gives its limits"
        raise InputError(design.name, "family", design.family, remedy)
    if isinstance(motion, str):
        motion = reference_motion(design, motion)
    planned = motion.model.design
    if planned is not design:
        raise InputError(
            design.name,
            "motion",
            motion.name,
            f"was planned for {planned.name}, variant {planned.variant}; plan it for this design",
        )
    matrix, envelope = joint_from_motor(design), motor_envelope(design)
    speed = motor_velocity(matrix, motion.joint_velocity)
    lower, upper = torque_limits(envelope, speed)
    jacobian = np.stack([contact_kinematics(motion.model, q)[1] for q in motion.q])
    weight = GRAVITY * motion.model.tree.mass
    allocation = least_heat(
        required_forces(motion),
        jacobian,
        motion.contact,
        matrix,
        lower,
        upper,
        envelope.power_constant,
        friction=float(design.contact.friction),
        weight=weight,
        allow_excess=allow_excess,
    )
    return Demand(
        design=design,
        motion=motion,
        joint_torque=np.einsum("jm,nlm->nlj", matrix, allocation.motor_torque),
        motor_torque=allocation.motor_torque,
        motor_velocity=speed,
        lower=lower,
        upper=upper,
        allocation=allocation,
        ledger=_ledger(allocation.motor_torque, speed, motion.time_step, envelope),
    )


def _ledger(
    torque: np.ndarray, speed: np.ndarray, time_step: float, envelope: MotorEnvelope
) -> EnergyLedger:
    flat = (len(torque), -1)
    constants = np.tile(envelope.power_constant, torque.shape[1])
    return energy_ledger(
        torque.reshape(flat),
        speed.reshape(flat),
        time_step,
        constants,
        envelope.efficiency_out,
        envelope.efficiency_regen,
    )


def demands(designs: Mapping[str, Design], name: str) -> dict[str, Demand]:
    """Compute the demand of one reference motion on several robots, each with the motion planned
    for it.

    Args:
        designs: robots by name.
        name: of the reference motion.

    Returns:
        Demands by the names given.
    """
    return {key: demand(design, name) for key, design in designs.items()}


__all__ = ["Demand", "demand", "demands", "joint_friction", "required_forces"]
