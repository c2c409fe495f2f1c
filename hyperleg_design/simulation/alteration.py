"""Alterations: what can be added to a simulation that its model lacks, without the simulation
knowing what it stands for.

An `Alteration` changes a simulation in up to three places, each of which it may leave out:

    edit(model)         the compiled MuJoCo model, before the first step: masses, springs, contacts
    machine(machine)    constants: what the controller believes, what motors and transmission are
    live(...)           hooks in every simulation step, with a hidden state of their own: `Live`

`Chain` runs the hooks in order. Nothing here knows a `Design`: joints, motors and constants are
arrays with names, so that any simulator can use it. Arrays of hooks are `(n, J)` joints and `(n,
K)` motors, n simulations in front. Constants of an alteration are numbers, or `(n,)`, one a
simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hyperleg_design.simulation.drives.limits import Limits
from hyperleg_design.simulation.drives.machine import Machine

if TYPE_CHECKING:
    import mujoco

    from hyperleg_design.robot.parameters.described import RobotDesign


@dataclass(slots=True, eq=False)
class Tick:
    """One simulation step as hooks see it; filled from top to bottom as the step goes on."""

    step: float
    """Time step of the simulation [s]."""
    position: np.ndarray
    velocity: np.ndarray
    """True, of the joints `(n, J)` [rad, rad/s], at the start of the step."""
    motor_position: np.ndarray
    motor_velocity: np.ndarray
    """Speeds of the rotors [rad/s], `(n, K)`: M^T q, or an alteration's own where it lets them move
    apart from the joints."""
    last_torque: np.ndarray
    """Motor torques of the step before [Nm], `(n, K)`; zero in the first step."""
    temperature: np.ndarray | None
    """Measured temperatures of the motors [degC], `(n, K)`; None where they were not measured."""
    battery: np.ndarray | None
    """Voltage `(n,)` [V], where somebody measured it."""
    command: np.ndarray | None = None
    """Motor torque that the controller asked for, before any hook `(n, K)` [Nm]; None where torque
    is replayed."""
    torque: np.ndarray | None = None
    """Torque at the rotors [Nm], `(n, K)`; None until `motor_torque` has computed it."""
    joint_torque: np.ndarray | None = None
    """M torque, `(n, J)` [Nm]."""


class Live:
    """Hooks of one alteration at work, with its hidden state; each hook by itself changes nothing.

    A hook may write into arrays it is given and return them, except into the tick's. `measured` and
    `imu` are also called between steps, so they must leave the state alone.
    """

    hidden_state: ClassVar[tuple[str, ...]] = ()
    """Names of the attributes that are hidden state: arrays with the simulations in front."""

    def __init__(self, alteration: Any, machine: Machine, count: int, step: float) -> None:
        self.alteration, self.machine, self.count, self.step = alteration, machine, count, step
        self.prepare()

    def prepare(self) -> None:
        """Find places by name, make the hidden state."""

    def reset(self, ids: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> None:
        """Start some simulations anew; by default their hidden state becomes zero.

        Args:
            ids: indices of the simulations.
            position: of the joints [rad], `(len(ids), J)`.
            velocity: of the joints [rad/s], `(len(ids), J)`.
        """
        for name in self.hidden_state:
            getattr(self, name)[ids] = 0

    def begin(self, tick: Tick) -> None:
        """Take in the new joint state, first in each step.

        Args:
            tick: the state; the rotors' state may be written into it.
        """

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Change the joint state that the controller and the policy measure.

        Args:
            position: of the joints [rad], `(n, J)`.
            velocity: of the joints [rad/s], `(n, J)`.

        Returns:
            Measured position and velocity, `(n, J)` each.
        """
        return position, velocity

    def imu(self, angular_velocity: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Change what gyro and accelerometer measure.

        Args:
            angular_velocity: in the base's frame [rad/s], `(n, 3)`.
            force: specific force in the base's frame [m/s^2], `(n, 3)`.

        Returns:
            Measured angular velocity and specific force, `(n, 3)` each.
        """
        return angular_velocity, force

    def target(self, target: np.ndarray, tick: Tick) -> np.ndarray:
        """Change the position target that the controller follows.

        Args:
            target: as given [rad], `(n, J)`.
            tick: the state of this step.

        Returns:
            The target that is followed [rad], `(n, J)`.
        """
        return target

    def command(self, command: np.ndarray, tick: Tick) -> np.ndarray:
        """Change the motor torque that the controller asks for into the one that the drive tries to
        give.

        Args:
            command: as asked for [Nm], `(n, K)`.
            tick: the state of this step.

        Returns:
            The torque that is tried [Nm], `(n, K)`.
        """
        return command

    def limits(self, limits: Limits, tick: Tick) -> Limits:
        """Change what the motors can give in this step.

        Args:
            limits: so far.
            tick: the state of this step.

        Returns:
            New limits, or the same object.
        """
        return limits

    def motor_torque(self, torque: np.ndarray, tick: Tick) -> np.ndarray:
        """Change the torque that the drive believes to give, within its limits, into the torque at
        the rotor.

        Args:
            torque: as believed [Nm], `(n, K)`.
            tick: the state of this step.

        Returns:
            The torque at the rotor [Nm], `(n, K)`.
        """
        return torque

    def motor_damping(self, tick: Tick) -> np.ndarray | None:
        """State the resistance D >= 0 at the rotors: D times the motor velocity *after* the step is
        taken off.

        Friction f(v) of any kind is D = f(v) / v at the present velocity, bounded at rest; see
        `resistance`.

        Args:
            tick: the state of this step.

        Returns:
            D [Nms/rad], `(n, K)`; None for no resistance.
        """
        return None

    def joint_damping(self, tick: Tick) -> np.ndarray | None:
        """State the resistance at the joints, as `motor_damping` does at the rotors.

        Args:
            tick: the state of this step.

        Returns:
            D [Nms/rad], `(n, J)`; None for no resistance.
        """
        return None

    def joint_torque(self, tick: Tick) -> np.ndarray | None:
        """State a torque that is added at the joints as it is; stiff springs belong into `edit`.

        Args:
            tick: the state of this step.

        Returns:
            The torque [Nm], `(n, J)`; None for no torque.
        """
        return None

    def transmitted(
        self, torque: np.ndarray, damping: np.ndarray | None, tick: Tick
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """Change torque and resistance at the rotors into those on the motor's side of a rigid M.

        Args:
            torque: at the rotors [Nm], `(n, K)`.
            damping: at the rotors [Nms/rad], `(n, K)`; None for no resistance.
            tick: the state of this step.

        Returns:
            Torque and resistance that are transmitted, `(n, K)` each.
        """
        return torque, damping


@dataclass(frozen=True, eq=False)
class Alteration:
    """Something added to a simulation; this one changes nothing. Subclasses are frozen dataclasses
    of constants.
    """

    live: ClassVar[type[Live] | None] = None
    """Its hooks, if it has any."""

    def shape(self, spec: mujoco.MjSpec) -> None:
        """Change the model before it is compiled, such as the form of the floor; structure that
        `edit` cannot change. Robot, joints, motors and the names of pads and floor stay.

        Args:
            spec: of the simulation, of one robot.
        """

    @property
    def vertical(self) -> np.ndarray | None:
        """Direction against gravity in the world `(3,)`, where that is not z; the robot's sensors
        tell it.
        """
        return None

    def edit(self, model: mujoco.MjModel, simulation: int = 0) -> None:
        """Change a compiled model in place; whoever calls runs `mj_setConst` afterwards (`edited`
        does both).

        Joint and tendon damping belong into the hooks instead, which a simulator sums up with its
        own.

        Args:
            model: of MuJoCo.
            simulation: whose constants to take, where they are `(n,)`.
        """

    def machine(self, machine: Machine) -> Machine:
        """Change the constants of the robot.

        Args:
            machine: without this alteration.

        Returns:
            The machine with it.
        """
        return machine

    @property
    def edits(self) -> bool:
        """Whether it has something to `edit`."""
        return type(self).edit is not Alteration.edit


Alterations = Sequence[Alteration] | Callable[[Any], Sequence[Alteration]]
"""Alterations, or what makes them for a design."""


def alterations_of(alterations: Alterations | None, design: RobotDesign) -> tuple[Alteration, ...]:
    """Collect the alterations of a design.

    Args:
        alterations: themselves, or a function that makes them for a design; None for none.
        design: the robot.

    Returns:
        The alterations.
    """
    return tuple(alterations(design) if callable(alterations) else alterations or ())


def edited(
    model: mujoco.MjModel, alterations: Sequence[Alteration], simulation: int = 0
) -> mujoco.MjModel:
    """Apply the edits of alterations to a model.

    Args:
        model: the compiled model.
        alterations: whose edits are applied.
        simulation: index of the simulation, for alterations that differ between simulations.

    Returns:
        The same model if there are no edits, a changed copy otherwise.
    """
    import copy

    import mujoco

    if not any(a.edits for a in alterations):
        return model
    model = copy.copy(model)
    for alteration in alterations:
        alteration.edit(model, simulation)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def damps_motors(alterations: Sequence[Alteration]) -> bool:
    """Decide whether any alteration resists at the rotors; MuJoCo then needs an integrator that is
    implicit in tendon damping.

    Args:
        alterations: all of a simulation.

    Returns:
        True if one does.
    """
    return any(
        overrides(a.live, "motor_damping") or overrides(a.live, "transmitted") for a in alterations
    )


def resistance(torque: np.ndarray, velocity: np.ndarray, width: np.ndarray | float) -> np.ndarray:
    """Compute the D of friction that grows from zero over a width of velocity, torque tanh(|v| / w)
    / |v|.

    Args:
        torque: size of the friction [Nm].
        velocity: v [rad/s], `(...)`.
        width: w [rad/s], as many or one.

    Returns:
        D [Nms/rad], `(...)`.
    """
    speed = np.maximum(np.abs(velocity), 1e-9 * width)
    return np.asarray(torque * np.tanh(speed / width) / speed)


def overrides(live: type[Live] | None, hook: str) -> bool:
    """Decide whether a class of hooks has a hook of its own.

    Args:
        live: the class; None for none.
        hook: name of the method.

    Returns:
        True if the class overrides it.
    """
    return live is not None and getattr(live, hook) is not getattr(Live, hook)
