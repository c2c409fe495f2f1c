"""Actuation inside a MuJoCo batch: reads the state, writes motor torques and joint friction before
each simulation step.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, cast

import numpy as np

from hyperleg_design.errors import InputError
from hyperleg_design.robot.linkage import LinkageModel
from hyperleg_design.robot.trees.limb_actuation import RodLinkage
from hyperleg_design.robot.trees.tree_design import TreeDesign
from hyperleg_design.simulation.alteration import Alteration
from hyperleg_design.simulation.drives import actuation
from hyperleg_design.simulation.drives.chain import Chain, Driven
from hyperleg_design.simulation.drives.machine import (
    bus_voltage,
    legs_matrix,
    machine_from,
    rotor_inertia,
)
from hyperleg_design.simulation.layout import Layout
from hyperleg_design.simulation.settings import Physics, Randomisation
from hyperleg_design.simulation.stepping.streams import Random

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mujoco.batch import Batch

    from hyperleg_design.robot.design import Design
    from hyperleg_design.robot.parameters.described import RobotDesign


class Drive:
    """Actuation of all robots of one batch.

    With `physics.posture_dependent` the tendons' coefficients follow the linkage model before each
    step, so motor torque, motor velocity and rotor inertia are those of the posture; the rotors'
    velocity term `M J dM^T/dt q_dot` is left out.
    """

    def __init__(
        self,
        design: RobotDesign,
        layout: Layout,
        physics: Physics,
        batch: Batch,
        randomisation: Randomisation | None,
        rng: Random,
        alterations: Sequence[Alteration] = (),
    ) -> None:
        self.model = actuation.actuation_model(design)
        self.physics = physics
        self.count = batch.nsim
        self._shape = (self.count, len(layout.limbs), layout.leg_joints)
        if randomisation is not None:
            self.model = _varied(self.model, self._shape, randomisation, rng)
        self.qpos, self.qvel = batch.bind("qpos"), batch.bind("qvel")
        self._ctrl, self._applied = batch.bind("ctrl"), batch.bind("qfrc_applied")
        self._linkage = _linkage(design) if physics.posture_dependent else None
        if self._linkage is not None:
            self._coefficients = batch.expand("wrap_prm")
            self._places = _wrap_places(batch, layout)
        self.coulomb, self.viscous = self.model.coulomb, self.model.viscous
        self._width: np.ndarray = np.array(physics.friction_velocity)
        if physics.friction_space == "motor":
            self.coulomb, self.viscous = actuation.motor_friction(design)
            self._width = actuation.motor_friction_width(
                self.model.joint_from_motor, physics.friction_velocity
            )
        self._spread()
        self._damping = None
        if physics.friction == "implicit":
            self._damping = (
                batch.expand("dof_damping")[:, 6:]
                if physics.friction_space == "joint"
                else batch.expand("tendon_damping")
            )
        self.chain: Chain | None = None
        """Of the alterations; None without."""
        if alterations:
            self._alter(design, layout, batch, alterations)

    def _alter(
        self, design: RobotDesign, layout: Layout, batch: Batch, alterations: Sequence[Alteration]
    ) -> None:
        inertia = rotor_inertia(design)
        machine = machine_from(
            self.model, layout.joints, layout.motors, inertia, bus_voltage(design)
        )
        chain = self.chain = Chain(machine, alterations, self.count, float(self.physics.time_step))
        altered, nominal = chain.machine, chain.nominal
        if not np.array_equal(altered.rigid_inertia, nominal.rotor_inertia):
            batch.expand("tendon_armature")[:] += altered.rigid_inertia - nominal.rotor_inertia
            batch.set_const()
        if altered.joint_from_motor is not nominal.joint_from_motor:
            if self._linkage is not None:
                raise InputError(
                    "physics",
                    "posture_dependent",
                    True,
                    "must be false with an alteration of the transmission",
                )
            leg, joint, motor = _wrap_places(batch, layout)
            matrix, rows, columns = (
                altered.joint_from_motor,
                leg * layout.leg_joints + joint,
                leg * layout.leg_motors + motor,
            )
            batch.expand("wrap_prm")[:] = matrix[..., rows, columns]
        self._joint_damping, self._motor_damping = (
            batch.expand("dof_damping")[:, 6:],
            batch.expand("tendon_damping"),
        )
        self._own_damping = [
            np.array(values) for values in (self._joint_damping, self._motor_damping)
        ]
        self.driven: Driven | None = None
        """What the chain gave in the last step."""

    def reset(self, ids: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> None:
        """Start some simulations anew.

        Args:
            ids: indices of the simulations.
            position: of the joints [rad], `(len(ids), J)`.
            velocity: of the joints [rad/s], `(len(ids), J)`.
        """
        if self.chain is not None:
            self.chain.reset(ids, position, velocity)

    def _spread(self) -> None:
        """Broadcast constants to every simulation and leg, so that NumPy runs through them in one
        go.
        """

        def full(values: np.ndarray) -> np.ndarray:
            return np.ascontiguousarray(
                np.broadcast_to(values, (self.count, self._shape[1], values.shape[-1]))
            )

        limits = self.model.envelope
        names = ("no_load_speed", "stall_torque", "peak_torque", "power_constant")
        envelope = dataclasses.replace(limits, **{n: full(getattr(limits, n)) for n in names})
        gains = {n: full(getattr(self.model, n)) for n in ("rated_torque", "stiffness", "damping")}
        self.model = dataclasses.replace(self.model, envelope=envelope, **gains)
        self.coulomb, self.viscous = full(self.coulomb), full(self.viscous)
        self._width = (
            full(np.broadcast_to(self._width, self.coulomb.shape[-1:]))
            if self._width.ndim < 3
            else full(self._width)
        )

    def flat(self, values: np.ndarray) -> np.ndarray:
        """Put the constants of all L limbs into one row.

        Args:
            values: `(n, L, k)`.

        Returns:
            `(n, L k)`.
        """
        return values.reshape(self.count, -1)

    def apply(self, target: np.ndarray, torque: np.ndarray, speed: np.ndarray) -> None:
        """Set controls and friction from the present state.

        Args:
            target: joint angles to reach [rad], `(n, L, joints)`.
            torque: filled with the motor torques [Nm], `(n, K)`.
            speed: filled with the motor velocities [rad/s], `(n, K)`.
        """
        position, velocity = (
            self.qpos[:, 7:].copy().reshape(self._shape),
            self.qvel[:, 6:].copy().reshape(self._shape),
        )
        if self.chain is not None:
            self._apply_chain(self.chain, target, position, velocity, torque, speed)
            return
        matrix, to_motor = self.model.joint_from_motor, None
        if self._linkage is not None:
            matrix = self._linkage.joint_from_motor(position)
            to_motor = actuation.motor_from_joint(matrix, self.model.envelope.power_constant)
            leg, joint, motor = self._places
            self._coefficients[:] = matrix[:, leg, joint, motor]
        motor_speed = actuation.motor_speed(matrix, velocity)
        wanted = actuation.controller_torque(self.model, target, position, velocity)
        given = actuation.driven_torque(self.model, wanted, motor_speed, to_motor)
        torque[:], speed[:] = given.reshape(self.count, -1), motor_speed.reshape(self.count, -1)
        self._ctrl[:] = torque
        self._resist(velocity, motor_speed)

    def _apply_chain(
        self,
        chain: Chain,
        target: np.ndarray,
        position: np.ndarray,
        velocity: np.ndarray,
        torque: np.ndarray,
        speed: np.ndarray,
    ) -> None:
        matrix, whole, to_motor = self.model.joint_from_motor, None, None
        if self._linkage is not None:
            matrix = self._linkage.joint_from_motor(position)
            whole, to_motor = (
                legs_matrix(matrix, self._shape[1]),
                legs_matrix(
                    actuation.motor_from_joint(matrix, self.model.envelope.power_constant),
                    self._shape[1],
                ),
            )
            leg, joint, motor = self._places
            self._coefficients[:] = matrix[:, leg, joint, motor]
        driven = self.driven = chain.drive(
            self.flat(position),
            self.flat(velocity),
            target=self.flat(target),
            joint_from_motor=whole,
            motor_from_joint=to_motor,
        )
        torque[:], speed[:] = driven.torque, driven.motor_velocity
        self._ctrl[:], self._applied[:, 6:] = driven.transmitted, 0.0
        self._joint_damping[:], self._motor_damping[:] = 0.0, 0.0
        self._resist(velocity, actuation.motor_speed(matrix, velocity))
        self._joint_damping += self._own_damping[0]
        self._motor_damping += self._own_damping[1]
        if driven.joint_damping is not None:
            self._joint_damping += driven.joint_damping
        if driven.motor_damping is not None:
            self._motor_damping += driven.motor_damping
        if driven.joint_torque is not None:
            self._applied[:, 6:] += driven.joint_torque

    def friction(self, velocity: np.ndarray, motor_speed: np.ndarray) -> np.ndarray:
        """Compute the friction torque at the joints.

        Args:
            velocity: of the joints [rad/s], `(..., L, joints)`.
            motor_speed: of the motors [rad/s], `(..., L, motors)`.

        Returns:
            The torque [Nm], `(..., L, joints)`.
        """
        if self.physics.friction_space == "joint":
            return actuation.friction_torque(self.coulomb, self.viscous, velocity, self._width)
        torque = actuation.friction_torque(self.coulomb, self.viscous, motor_speed, self._width)
        return actuation.applied(self.model.joint_from_motor, torque)

    def _resist(self, velocity: np.ndarray, motor_speed: np.ndarray) -> None:
        at_joints = self.physics.friction_space == "joint"
        moving = velocity if at_joints else motor_speed
        if self._damping is not None:
            damping = actuation.friction_damping(self.coulomb, self.viscous, moving, self._width)
            self._damping[:] = damping.reshape(self.count, -1)
        elif at_joints:
            self._applied[:, 6:] = -actuation.friction_torque(
                self.coulomb, self.viscous, moving, self._width
            ).reshape(self.count, -1)
        else:
            self._ctrl[:] -= actuation.friction_torque(
                self.coulomb, self.viscous, moving, self._width
            ).reshape(self.count, -1)


def _linkage(design: RobotDesign) -> LinkageModel | RodLinkage:
    """What gives the reductions of a design in any posture."""
    if isinstance(design, TreeDesign):
        return RodLinkage(design)
    return LinkageModel.of(cast("Design", design))


def _varied(
    model: actuation.ActuationModel,
    shape: tuple[int, int, int],
    randomisation: Randomisation,
    rng: Random,
) -> actuation.ActuationModel:
    def drawn(values: np.ndarray, spread: float) -> np.ndarray:
        return values * rng.uniform(1 - spread, 1 + spread, shape) if spread else values

    return dataclasses.replace(
        model,
        stiffness=drawn(model.stiffness, randomisation.gains),
        damping=drawn(model.damping, randomisation.gains),
        coulomb=drawn(model.coulomb, randomisation.joint_friction),
        viscous=drawn(model.viscous, randomisation.joint_friction),
    )


def _wrap_places(batch: Batch, layout: Layout) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Limb, joint and motor of each tendon coefficient, in the model's order."""
    model = batch.model
    leg, joint, motor = [], [], []
    first = model.joint(layout.joints[0]).id
    for tendon in range(model.ntendon):
        start = model.tendon_adr[tendon]
        for place in range(start, start + model.tendon_num[tendon]):
            side, row = divmod(int(model.wrap_objid[place]) - first, layout.leg_joints)
            leg.append(side)
            joint.append(row)
            motor.append(tendon % layout.leg_motors)
    return np.array(leg), np.array(joint), np.array(motor)
