"""Swaps: what a trained policy does when one thing about the toe is taken away or given.

The arms of a study differ in their robots and in the policies that were trained for them. A swap
changes the robot and leaves the policy as it is, so that what follows is the robot's doing alone:

| swap | of policies | changes |
|---|---|---|
| `lock_toe` | with an active toe | the toe's angle stays what it is at the start; its motor still helps knee and ankle, as in `toe_locked` |
| `toe_motor_alone` | with an active toe | the toe's motor moves the toe and no longer helps knee and ankle |
| `toe_motor_to_ankle` | without a toe motor | the two ankle motors are one and a half of what they were: the toe motor's torque, heat capacity and rotor are shared out between them |

The lock is a damper of `LOCK` at the joint: it dissipates under 0.01 W and lets the toe creep by
less than 0.3 deg in 20 s under 20 Nm. The policy goes on seeing the toe's angle, and its action
for a locked toe has no effect.
"""  # noqa: E501

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from typing_extensions import override

from hyperleg_design.errors import InputError, meant
from hyperleg_design.robot.ablation import states
from hyperleg_design.robot.names import LAYOUTS, SIDES
from hyperleg_design.robot.parameters.hyperleg import HyperLeg
from hyperleg_design.simulation.alteration import Alteration, Live, Tick
from hyperleg_design.simulation.drives.actuation import motor_from_joint
from hyperleg_design.simulation.drives.machine import Machine

if TYPE_CHECKING:
    from hyperleg_design.robot.parameters.described import RobotDesign

LOCK = 1e5
"""Damping that holds a locked toe [Nms/rad]; assumed, see the module."""
TOES = tuple(f"{side}_toe" for side in SIDES)
"""Joints and motors of the toes."""
ANKLES = tuple(f"{side}_ankle_{motor}" for side in SIDES for motor in ("left", "right"))
"""Motors of the ankles."""
SHARE = 1.5
"""Ankle motors in place of one, where two take over a third of the same kind."""


class _Held(Live):
    def prepare(self) -> None:
        self.damping = np.zeros((self.count, len(self.machine.joints)))
        self.damping[:, [self.machine.joint(name) for name in TOES]] = LOCK

    def joint_damping(self, tick: Tick) -> np.ndarray:
        return self.damping


@dataclass(frozen=True, eq=False)
class LockedToe(Alteration):
    """Holds the toes; their motors help knee and ankle at the least Joule heat."""

    live = _Held

    @override
    def machine(self, machine: Machine) -> Machine:
        """Take the torque of the toe joints out of the controller's map."""
        driven = np.array([name not in TOES for name in machine.joints])
        matrix = machine.joint_from_motor
        own = motor_from_joint(matrix[..., driven, :], machine.power_constant)
        inverse = np.zeros((*own.shape[:-1], len(driven)))
        inverse[..., driven] = own
        return dataclasses.replace(machine, motor_from_joint=inverse)


@dataclass(frozen=True, eq=False)
class ToeMotorAlone(Alteration):
    """Takes the toe motors' help from knee and ankle."""

    @override
    def machine(self, machine: Machine) -> Machine:
        """Take the coupling of the toe's motor with other joints out of transmission and
        controller.
        """
        matrix = machine.joint_from_motor.copy()
        others = [j for j, name in enumerate(machine.joints) if name not in TOES]
        for name in TOES:
            matrix[..., others, machine.motor(name)] = 0.0
        inverse = motor_from_joint(matrix, machine.power_constant)
        return dataclasses.replace(machine, joint_from_motor=matrix, motor_from_joint=inverse)


@dataclass(frozen=True, eq=False)
class ToeMotorToAnkle(Alteration):
    """Ankle motors that are one and a half of what they were.

    Motors of the same kind side by side add their torques and rotors; at the same torque n of them
    heat as much as one of 1 / n of the power constant.
    """

    @override
    def machine(self, machine: Machine) -> Machine:
        """Enlarge the ankle motors by the share of the toe's motor."""
        larger = ("peak_torque", "stall_torque", "rated_torque", "rotor_inertia")
        for name in ANKLES:
            place = machine.motor(name)
            for field in larger:
                machine = machine.changed(field, place, lambda value: SHARE * value)
            machine = machine.changed("power_constant", place, lambda value: value / SHARE)
        return machine


SWAPS: dict[str, type[Alteration]] = {
    "lock_toe": LockedToe,
    "toe_motor_alone": ToeMotorAlone,
    "toe_motor_to_ankle": ToeMotorToAnkle,
}
"""Swaps by name."""
NEEDS_ACTIVE = ("lock_toe", "toe_motor_alone")
"""Swaps of robots with an active toe; the others need one without a toe motor."""


@dataclass(frozen=True)
class Swap:
    """Makes a swap's alterations for a design, as evaluations take them.

    Raises:
        InputError: no such swap; when called, a design whose toe does not fit it, or a robot that
            is no HyperLeg.
    """

    name: str
    """One of `SWAPS`."""

    def __post_init__(self) -> None:
        if self.name not in SWAPS:
            raise InputError("swap", "", self.name, meant(self.name, SWAPS))

    def __call__(self, design: RobotDesign) -> tuple[Alteration, ...]:
        """Alterations of one robot."""
        if not isinstance(design, HyperLeg):
            remedy = "is no HyperLeg, whose toe the swap is of; leave the swap out"
            raise InputError(f"swap {self.name}", "design", design.name, remedy)
        active = (design.toe.joint, bool(design.actuators.toe_installed)) == states("toe")
        fits = active if self.name in NEEDS_ACTIVE else not design.actuators.toe_installed
        if not fits:
            needs_active = self.name in NEEDS_ACTIVE
            fitting = [
                layout
                for layout in LAYOUTS
                if (layout == "toe" if needs_active else not states(layout)[1])
            ]
            raise InputError(
                f"swap {self.name}",
                "variant",
                design.variant,
                f"expects a policy of {' or '.join(fitting)}",
            )
        return (SWAPS[self.name](),)
