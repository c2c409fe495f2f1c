"""From targets to what joints feel, with alterations: the order in which their hooks act in one
simulation step.

    joint state --measured--> controller <--target-- target
    controller: K (target - q) - D q_dot, then M^-1              or a motor command that is replayed
    --command--> --limits--> clip                                or a motor torque that is replayed
    --motor_torque--> rotor, less motor_damping
    --transmitted--> M --> joints, less joint_damping, plus joint_torque

Without alterations it computes what `actuation` does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hyperleg_design.simulation.alteration import Alteration, Live, Tick, overrides
from hyperleg_design.simulation.drives.actuation import applied
from hyperleg_design.simulation.drives.limits import Limits
from hyperleg_design.simulation.drives.machine import Machine
from hyperleg_design.simulation.drives.two_mass import joined


@dataclass(slots=True, eq=False)
class Driven:
    """What a step gives the simulator to apply, and what a log of it would say."""

    command: np.ndarray | None
    """Torque that the controller asked for [Nm], `(n, K)`."""
    believed: np.ndarray
    """Torque within the limits, which the drive takes itself to give `(n, K)` [Nm]."""
    torque: np.ndarray
    """Torque at the rotors [Nm], `(n, K)`."""
    motor_velocity: np.ndarray
    """Speeds of the rotors [rad/s], `(n, K)`."""
    transmitted: np.ndarray
    """Torque to be applied through M [Nm], `(n, K)`."""
    motor_damping: np.ndarray | None
    """Damping to be applied through M, implicitly, as `M diag(D) M^T` [Nms/rad], `(n, K)`."""
    joint_damping: np.ndarray | None
    """Damping to be applied at the joints, implicitly [Nms/rad], `(n, J)`."""
    joint_torque: np.ndarray | None
    """Torque to be applied at the joints [Nm], `(n, J)`."""


class Chain:
    """The drives of n simulations of one machine, altered.

    Args:
        machine: as it is without alterations.
        alterations: in the order in which their hooks act; belts of one motor act as one.
        count: simulations.
        step: of the simulation [s].
    """

    def __init__(
        self, machine: Machine, alterations: Sequence[Alteration], count: int, step: float
    ) -> None:
        alterations = joined(alterations)
        self.nominal = machine
        for alteration in alterations:
            machine = alteration.machine(machine)
        self.machine = machine
        """With the alterations; where `rigid_inertia` or M differ from those of `nominal`, the
        simulator must change its model."""
        self.count, self.step = count, step
        self.lives: list[Live] = [
            a.live(a, machine, count, step) for a in alterations if a.live is not None
        ]
        self.last_torque = np.zeros((count, len(machine.motors)))
        self._limits = Limits(machine.no_load_speed, machine.stall_torque, machine.peak_torque)

        hooks = (
            "begin",
            "measured",
            "imu",
            "target",
            "command",
            "limits",
            "motor_torque",
            "motor_damping",
            "joint_damping",
            "joint_torque",
            "transmitted",
        )
        self._hooks = {
            hook: [live for live in self.lives if overrides(type(live), hook)] for hook in hooks
        }

    def reset(self, ids: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> None:
        """Start some simulations anew.

        Args:
            ids: indices of the simulations.
            position: of the joints [rad], `(len(ids), J)`.
            velocity: of the joints [rad/s], `(len(ids), J)`.
        """
        self.last_torque[ids] = 0.0
        for live in self.lives:
            live.reset(ids, position, velocity)

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute the joint state that controller and policy measure.

        Args:
            position: true, of the joints [rad], `(n, J)`.
            velocity: true, of the joints [rad/s], `(n, J)`.

        Returns:
            Measured position and velocity, `(n, J)` each; copies.
        """
        position, velocity = position.copy(), velocity.copy()
        for live in self._hooks["measured"]:
            position, velocity = live.measured(position, velocity)
        return position, velocity

    def imu(self, angular_velocity: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute what the IMU measures.

        Args:
            angular_velocity: true, in the base's frame [rad/s], `(n, 3)`.
            force: true specific force in the base's frame [m/s^2], `(n, 3)`.

        Returns:
            Measured angular velocity and specific force, `(n, 3)` each; copies.
        """
        angular_velocity, force = angular_velocity.copy(), force.copy()
        for live in self._hooks["imu"]:
            angular_velocity, force = live.imu(angular_velocity, force)
        return angular_velocity, force

    def drive(
        self,
        position: np.ndarray,
        velocity: np.ndarray,
        *,
        target: np.ndarray | None = None,
        command: np.ndarray | None = None,
        torque: np.ndarray | None = None,
        temperature: np.ndarray | None = None,
        battery: np.ndarray | None = None,
        joint_from_motor: np.ndarray | None = None,
        motor_from_joint: np.ndarray | None = None,
    ) -> Driven:
        """Compute one step of all drives, before the simulator makes its own.

        Args:
            position: of the joints, true `(n, J)` [rad].
            velocity: of the joints, true `(n, J)` [rad/s].
            target: that the controller follows `(n, J)` [rad]; or
            command: motor torque that the controller asks for `(n, K)` [Nm]; or
            torque: motor torque that the drive takes itself to give `(n, K)` [Nm].
            temperature: of the motors, where a log has it `(n, K)` [degC].
            battery: its voltage, where a log has it `(n,)` [V].
            joint_from_motor: of this posture, in place of the machine's `(n, J, K)`.
            motor_from_joint: of this posture, in place of the machine's `(n, K, J)`.

        Returns:
            Torques and resistances at rotors and joints.
        """
        machine = self.machine
        matrix = machine.joint_from_motor if joint_from_motor is None else joint_from_motor
        to_motor = machine.motor_from_joint if motor_from_joint is None else motor_from_joint
        transposed = np.swapaxes(matrix, -1, -2)
        tick = Tick(
            self.step,
            position,
            velocity,
            applied(transposed, position),
            applied(transposed, velocity),
            self.last_torque,
            temperature,
            battery,
        )
        for live in self._hooks["begin"]:
            live.begin(tick)
        if torque is None:
            if command is None:
                assert target is not None
                command = applied(to_motor, self._controller(target, tick))
            tick.command, wanted = command, command.copy()
            for live in self._hooks["command"]:
                wanted = live.command(wanted, tick)
            limits = self._limits
            for live in self._hooks["limits"]:
                limits = live.limits(limits, tick)
            torque = limits.clip(wanted, tick.motor_velocity)
        believed, torque = torque, torque.copy()
        for live in self._hooks["motor_torque"]:
            torque = live.motor_torque(torque, tick)
        tick.torque, tick.joint_torque = torque, applied(matrix, torque)
        transmitted, motor_damping = torque.copy(), self._sum("motor_damping", tick)
        for live in self._hooks["transmitted"]:
            transmitted, motor_damping = live.transmitted(transmitted, motor_damping, tick)
        driven = Driven(
            command=tick.command,
            believed=believed,
            torque=torque,
            motor_velocity=tick.motor_velocity,
            transmitted=transmitted,
            motor_damping=motor_damping,
            joint_damping=self._sum("joint_damping", tick),
            joint_torque=self._sum("joint_torque", tick),
        )
        self.last_torque = torque
        return driven

    def _controller(self, target: np.ndarray, tick: Tick) -> np.ndarray:
        target = target.copy()
        for live in self._hooks["target"]:
            target = live.target(target, tick)
        position, velocity = self.measured(tick.position, tick.velocity)
        return np.asarray(
            self.machine.stiffness * (target - position) - self.machine.damping * velocity
        )

    def _sum(self, hook: str, tick: Tick) -> np.ndarray | None:
        total = None
        for live in self._hooks[hook]:
            part = getattr(live, hook)(tick)
            if part is not None:
                total = part if total is None else total + part
        return total

    def state(self) -> dict[str, np.ndarray]:
        """Collect all arrays that the next step depends on.

        Returns:
            Copies by name, as `put_state` takes them.
        """
        of_alterations = {
            f"{i}.{name}": np.array(getattr(live, name))
            for i, live in enumerate(self.lives)
            for name in live.hidden_state
        }
        return {"last_torque": self.last_torque.copy(), **of_alterations}

    def put_state(self, state: dict[str, np.ndarray]) -> None:
        """Restore arrays that `state` returned.

        Args:
            state: arrays by name.
        """
        self.last_torque = state["last_torque"].copy()
        for i, live in enumerate(self.lives):
            for name in live.hidden_state:
                getattr(live, name)[:] = state[f"{i}.{name}"]
