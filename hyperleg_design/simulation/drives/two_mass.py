"""Belts: a motor and its joints as two masses, joined by a spring with play.

The simulator's model has the joints; the rotor moves here, in smaller steps of its own, and is left
out of the model (`Machine.rigid_inertia`). Within a simulation step the model's side of the belt
moves evenly. MuJoCo steps as a leapfrog: its velocity belongs to the time half a step before its
position, so at that time q - h q_dot / 2 goes with q_dot, and from one such time to the next the
joint moves at the mean of the two velocities. Over that way the rotor is integrated and the belt's
mean torque goes to the joints, affine in the velocity after the step, that is as a torque and an
implicit damping. What the rotor loses the joints gain, to rounding where the belt is linear, so
that resonances keep their frequency and their energy.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from hyperleg_design.simulation.alteration import Alteration, Live, Tick
from hyperleg_design.simulation.drives.actuation import applied
from hyperleg_design.simulation.drives.machine import Machine

DAMPING_RATIO = 0.05
"""Damping ratio of the rotor on its belt where no damping is given (assumed: belts with steel cords
ring for a few periods)."""
STIFFEST = 100.0
"""Highest frequency of a rotor on its belt that is resolved [Hz]; logs at 200 Hz show nothing
faster."""
FINENESS = 0.5
"""Largest change of phase within an inner step [rad]."""


@dataclass(frozen=True, eq=False)
class Belt(Alteration):
    """A belt between one motor and its joints, on the motor's side of M; without compliance and
    play it is rigid.
    """

    motor: str
    compliance: Any = 0.0
    """Compliance of the belt [rad/Nm], `()` or `(n,)`."""
    play: Any = 0.0
    """Whole width of the dead zone [rad], `()` or `(n,)`."""
    damping: Any = None
    """Damping of the belt while it is taut [Nms/rad], `()` or `(n,)`; by default that of
    `DAMPING_RATIO`."""
    stiffening: Any = 0.0
    """1 over the stretch at which it is twice as stiff [1/rad], `()` or `(n,)`: torque grows as s
    (1 + (stiffening s)^2)."""
    side: Any = 0.0
    """Where the encoder that tells of the joints sits, `()` or `(n,)`: 0 at the joints, 1 at the
    rotor, which it takes for them."""

    @override
    def machine(self, machine: Machine) -> Machine:
        """Let the rotor move freely where the belt is not rigid."""
        place = machine.motor(self.motor)
        loose = (np.asarray(self.compliance, float) > 0) | (np.asarray(self.play, float) > 0)
        inertia = np.asarray(machine.rotor_inertia, float)
        free = np.zeros(inertia.shape, bool) if machine.free is None else np.asarray(machine.free)
        free = np.array(
            np.broadcast_to(
                free, (*np.broadcast_shapes(free.shape[:-1], loose.shape), free.shape[-1])
            )
        )
        free[..., place] = free[..., place] | loose
        return dataclasses.replace(machine, free=free)


class _Rotor(Live):
    hidden_state: ClassVar[tuple[str, ...]] = (
        "angle",
        "speed",
        "begun",
        "way",
        "torque",
        "drag",
        "stretch",
        "rate",
    )

    alteration: Belt

    def prepare(self) -> None:
        belt, machine = self.alteration, self.machine
        self.place = machine.motor(belt.motor)

        def full(values: Any) -> np.ndarray:
            return np.array(np.broadcast_to(np.asarray(values, float), (self.count,)))

        compliance, self.play = full(belt.compliance), full(belt.play)
        inertia = full(np.asarray(machine.rotor_inertia, float)[..., self.place])
        fastest = (2 * np.pi * STIFFEST) ** 2
        self.loose = (compliance > 0) | (self.play > 0)
        given = compliance > 0
        # Stiffer belts than can be resolved, and play without compliance, get the stiffest that is.
        self.inertia = np.where(inertia > 0, inertia, LIGHTEST)
        self.stiffest = stiffest = self.inertia * fastest
        self.stiffness = np.where(
            given, np.minimum(1 / np.where(given, compliance, 1.0), stiffest), stiffest
        )
        standard = 2 * DAMPING_RATIO * np.sqrt(self.stiffness * self.inertia)
        self.damping = standard if belt.damping is None else full(belt.damping)
        highest = np.where(full(belt.stiffening) > 0, stiffest, self.stiffness)
        rate = float(np.sqrt(highest / self.inertia)[self.loose].max(initial=1.0))
        self.inner = max(4, int(np.ceil(self.step * rate / FINENESS)))
        self.angle, self.speed, self.begun, self.way, self.torque, self.drag = (
            np.zeros(self.count) for _ in range(6)
        )
        self.stretch, self.rate = np.zeros(self.count), np.zeros(self.count)
        self.side, self.stiffening = full(belt.side), full(belt.stiffening)

    def reset(self, ids: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> None:
        for name in self.hidden_state:
            getattr(self, name)[ids] = 0.0

    def begin(self, tick: Tick) -> None:
        place, old = self.place, self.begun > 0
        way = tick.motor_position[:, place] - self.step / 2 * tick.motor_velocity[:, place]
        angle, speed, _ = self._moved(
            (way - self.way) / self.step, self.way, self.torque, self.drag
        )
        self.angle = np.where(old, angle, way)
        self.speed = np.where(old, speed, tick.motor_velocity[:, place])
        self.way, self.begun = way, np.ones(self.count)
        # of the rotor at the time of the joints' position
        self.stretch = np.where(
            self.loose, self.angle + self.step / 2 * self.speed - tick.motor_position[:, place], 0.0
        )
        self.rate = np.where(self.loose, self.speed - tick.motor_velocity[:, place], 0.0)
        tick.motor_position[:, place] += self.stretch
        tick.motor_velocity[:, place] += self.rate

    def measured(self, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        if self.side.any():
            share = np.asarray(self.machine.motor_from_joint)[..., self.place, :]
            position += (self.side * self.stretch)[:, None] * share
            velocity += (self.side * self.rate)[:, None] * share
        return position, velocity

    def transmitted(
        self, torque: np.ndarray, damping: np.ndarray | None, tick: Tick
    ) -> tuple[np.ndarray, np.ndarray | None]:
        place = self.place
        damping = np.zeros_like(torque) if damping is None else np.array(damping)
        self.torque, self.drag = torque[:, place].copy(), damping[:, place].copy()
        matrix = self.machine.joint_from_motor
        velocity = applied(np.swapaxes(matrix, -1, -2), tick.velocity)[:, place]
        # Even motion at the present velocity, and a little faster: by which the mean torque is
        # affine in the velocity.
        change = 1e-3 * np.maximum(self.play / self.step, 1e-3)
        mean = self._moved(velocity, self.way, self.torque, self.drag)[2]
        slope = np.minimum(
            (self._moved(velocity + change, self.way, self.torque, self.drag)[2] - mean) / change,
            0.0,
        )
        torque[:, place] = np.where(self.loose, mean - slope * velocity / 2, torque[:, place])
        damping[:, place] = np.where(self.loose, -slope / 2, damping[:, place])
        return torque, damping

    def _moved(
        self, velocity: np.ndarray, way: np.ndarray, torque: np.ndarray, drag: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rotor's angle and speed after a step in which the joints' side moves evenly, and the
        belt's mean torque, `(n,)` each.
        """
        step, half = self.step / self.inner, self.play / 2
        angle, speed, total = self.angle.copy(), self.speed.copy(), np.zeros(self.count)
        for number in range(self.inner):
            angle += step / 2 * speed
            stretch = angle - (way + (number + 0.5) * step * velocity)
            taut = np.where(np.abs(stretch) >= half, 1.0, 0.0)
            beyond = stretch - np.clip(stretch, -half, half)
            stiffer = np.minimum(
                self.stiffness * (1 + (self.stiffening * beyond) ** 2), self.stiffest
            )
            pull = stiffer * beyond
            damping = taut * self.damping
            # damping at the mean of the old and the new speed, drag at the new one
            free = self.inertia * speed + step * (torque - pull - damping * (speed / 2 - velocity))
            new = free / (self.inertia + step * (damping / 2 + drag))
            total += pull + damping * ((speed + new) / 2 - velocity)
            speed = new
            angle += step / 2 * speed
        return angle, speed, total / self.inner


LIGHTEST = 1e-4
"""Inertia of a rotor with play where the model has none [kg m^2] (assumed; small against any
joint's)."""
Belt.live = _Rotor


def joined(alterations: Sequence[Alteration]) -> list[Alteration]:
    """Combine the belts of each motor into one: compliances and plays add up, dampings act in
    series.

    Args:
        alterations: all of a simulation.

    Returns:
        The alterations, with one belt for each motor at most.
    """
    belts: list[Alteration] = []
    for alteration in alterations:
        twin = next(
            (
                i
                for i, a in enumerate(belts)
                if isinstance(alteration, Belt)
                and isinstance(a, Belt)
                and a.motor == alteration.motor
            ),
            None,
        )
        if twin is None:
            belts.append(alteration)
            continue
        first, second = belts[twin], alteration
        assert isinstance(first, Belt)
        assert isinstance(second, Belt)
        dampings = [np.asarray(b.damping, float) for b in (first, second) if b.damping is not None]
        damping = (
            None
            if not dampings
            else dampings[0]
            if len(dampings) == 1
            else dampings[0] * dampings[1] / (dampings[0] + dampings[1])
        )
        side, stiffening = (
            np.maximum(getattr(first, name), getattr(second, name))
            for name in ("side", "stiffening")
        )
        compliance, play = (
            np.asarray(getattr(first, name)) + getattr(second, name)
            for name in ("compliance", "play")
        )
        belts[twin] = Belt(first.motor, compliance, play, damping, stiffening=stiffening, side=side)
    return belts
