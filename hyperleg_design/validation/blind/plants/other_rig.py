"""Second rig plant, built differently from the first so that what is developed on one can be
checked on the other.

| | first | second |
|---|---|---|
| integrator | semi-implicit Euler, 0.25 ms | drift, kick in the middle, drift, 0.2 ms |
| friction | LuGre bristles | exact sticking at the rotors; at coupled joints Dahl's |
| drive | first-order torque loop in an envelope | winding with inductance, voltage limit |
| control | filtered speed of the joint | differences of an encoder on the rotor |
| transmission | linear belt | belt that stiffens |
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hyperleg_design.validation.blind.plants.parts import (
    DelayLine,
    Drives,
    HostTargets,
    Ripple,
    UnlistedForces,
    stacked,
)
from hyperleg_design.validation.blind.plants.plant import (
    RigPlant,
    Trace,
    columns_of,
    inverse_inertia,
    traces_of,
)
from hyperleg_design.validation.blind.plants.rig import SETTLING

STEP = 0.2e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 5
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
ELECTRICAL = 900.0
"""Resistance over inductance of the windings [1/s]."""
STIFFENING = 0.02
"""Stretch of a belt, over the largest reduction, at which it is twice as stiff [rad]."""
BELT_STIFFNESS, BELT_DAMPING = 2.0, 4.0
"""Over those of the first plant's belts."""
PRESLIDING = 8e-4
"""Angle over which Dahl's friction builds up [rad]."""
DIFFERENCED = 1
"""Control ticks over which the rotor's encoder is differenced."""
CONTROL = STEP * CONTROL_STEPS
"""Between ticks of the controllers [s]."""


def simulate_other(
    plants: Sequence[RigPlant], targets: np.ndarray, rate: float, *, seeds: Sequence[int]
) -> list[Trace]:
    """Run rigs side by side; arguments and result as `rig.simulate`.

    `position` and `velocity` are the joints' own; `encoder` is what the rotors' encoders say of
    them.

    Args:
        plants: the rigs.
        targets: `(b, ticks, n)` [rad].
        rate: of the targets [Hz].
        seeds: of the noise, one a rig.

    Returns:
        One trace a rig.
    """
    b, ticks, n = targets.shape
    hold, lead = round(1.0 / (rate * CONTROL)), round(SETTLING / CONTROL)
    count = ticks * hold
    host, rigs = HostTargets(targets, hold), _Rigs(plants, targets[:, 0], seeds)
    columns = columns_of(n, plants[0].rotor_inertia.size)
    recorded = {name: np.empty((count, b, width)) for name, width in columns.items()}
    for tick in range(-lead, count):
        for name, values in rigs.control(tick, host.at(tick)).items():
            if tick >= 0:
                recorded[name][tick] = values
        for _ in range(CONTROL_STEPS):
            rigs.step(tick * CONTROL)
    return traces_of(recorded, np.full((count, b), np.nan), CONTROL)


class _Rigs:
    """`b` rigs and where they are."""

    def __init__(
        self, plants: Sequence[RigPlant], target: np.ndarray, seeds: Sequence[int]
    ) -> None:
        self.matrix = stacked(plants, "joint_from_motor")
        self.transposed = np.ascontiguousarray(np.swapaxes(self.matrix, 1, 2))
        self.friction = _Friction(plants, self.matrix)
        self.belts = _Belts(plants, self.matrix)
        self.drives = _Drives(plants)
        self.controllers = _Controllers(plants, seeds)
        self.forces, self.ripple = UnlistedForces(plants, STEP), Ripple(plants)
        self.inertia = stacked(plants, "rotor_inertia")
        self.models = [p.model for p in plants]
        self.datas = [p.model.createData() for p in plants]
        self.q = target - stacked(plants, "offset")
        self.qd = np.zeros(self.q.shape)
        self.rotor = self.at_motors(self.q)
        self.spin = np.zeros(self.rotor.shape)
        self.joint_pull = np.zeros(self.q.shape)

    def at_motors(self, values: np.ndarray) -> np.ndarray:
        """Angles or speeds of joints `(b, n)` as those of rigid transmissions' motors `(b, m)`."""
        return np.asarray((values[:, None] @ self.matrix)[:, 0])

    def control(self, tick: int, target: np.ndarray) -> dict[str, np.ndarray]:
        """Read the encoders, command the drives, and state what is recorded."""
        fresh = self.controllers.command(tick, target, self.rotor)
        self.drives.receive(self.controllers.arriving(tick, fresh), self.spin)
        return {
            "position": self.q,
            "velocity": self.qd,
            "encoder": self.controllers.shown,
            "speed": self.controllers.speed,
            "motor_velocity": self.spin,
            "command": fresh,
            "drive_torque": self.drives.torque,
            "pull": self.joint_pull,
            "temperature": self.drives.temperature,
            "voltage": self.drives.bus,
        }

    def step(self, time: float) -> None:
        """Drift half a step, change the speeds there, drift the other half."""
        import pinocchio as pin

        given = self.drives.step(self.spin)
        self.drift()
        pull = self.belts.pull(
            self.rotor - self.at_motors(self.q), self.spin - self.at_motors(self.qd)
        )
        self.joint_pull = (pull[:, None] @ self.transposed)[:, 0]
        force = self.joint_pull
        if self.friction.at_joints:
            force = self.friction.slowed_joints(force, self.q, self.qd)
        force = self.forces.beside(force, time, self.q, self.qd)
        self.qd = self.qd + STEP * np.stack(
            [
                pin.aba(model, data, self.q[i], self.qd[i], force[i])
                for i, (model, data) in enumerate(zip(self.models, self.datas, strict=True))
            ]
        )
        drive = given + self.ripple.cogging(self.rotor) + self.ripple.of_torque(self.rotor, given)
        self.spin = self.friction.slowed_rotors(self.spin, drive, pull, self.inertia)
        self.drift()

    def drift(self) -> None:
        """Move half a step at the speeds there are."""
        self.q = self.q + 0.5 * STEP * self.qd
        self.rotor = self.rotor + 0.5 * STEP * self.spin


class _Controllers:
    """Joint controllers on encoders of the rotors, and commands that get lost or are late."""

    def __init__(self, plants: Sequence[RigPlant], seeds: Sequence[int]) -> None:
        declared = stacked(plants, "declared")
        ratio = np.abs(declared).max(1)
        least = stacked(plants, "resolution").min(-1, keepdims=True)
        self.counts = least * ratio / np.where(ratio > 1, 12, 2)
        self.allot = np.ascontiguousarray(np.stack([np.linalg.pinv(p.declared).T for p in plants]))
        # (b, m, n): q^T = theta^T pinv(M)
        self.from_rotor = np.ascontiguousarray(np.linalg.pinv(declared))
        self.kp, self.kd = stacked(plants, "stiffness"), stacked(plants, "damping")
        self.offset, self.drift = stacked(plants, "offset"), stacked(plants, "drift")
        self.eccentricity = stacked(plants, "eccentricity")
        self.loss = stacked(plants, "loss")
        self.dice = [np.random.default_rng([seed, 1]) for seed in seeds]
        self.silent = np.zeros(len(plants), int)
        self.line = DelayLine(stacked(plants, "delay"), CONTROL)
        self.seen: np.ndarray | None = None
        self.shown = self.speed = np.zeros(self.kp.shape)

    def command(self, tick: int, target: np.ndarray, rotor: np.ndarray) -> np.ndarray:
        """Torques that the motors are to give `(b, m)` [Nm], from what their encoders show."""
        angles = (np.round(rotor / self.counts) * self.counts)[:, None]
        reading = (angles @ self.from_rotor)[:, 0]
        self.shown = (
            reading
            + self.offset
            + self.eccentricity * np.sin(3 * reading)
            + self.drift * max(tick * CONTROL, 0.0)
        )
        if self.seen is None:
            self.seen = np.repeat(self.shown[None], DIFFERENCED + 1, 0)
        before = self.seen[(tick + 1) % (DIFFERENCED + 1)]
        self.speed = (self.shown - before) / (DIFFERENCED * CONTROL)
        self.seen[tick % (DIFFERENCED + 1)] = self.shown
        joint = self.kp * (target - self.shown) - self.kd * self.speed
        return np.asarray((joint[:, None] @ self.allot)[:, 0])

    def arriving(self, tick: int, command: np.ndarray) -> np.ndarray:
        """What comes to the drives at a tick at which a command is sent, `(b, m)` [Nm]."""
        for i in np.flatnonzero(self.loss):
            chance = self.loss[i] * CONTROL / (0.04 * (1 - self.loss[i]))
            if self.silent[i] == 0 and self.dice[i].random() < chance:
                self.silent[i] = 1 + int(self.dice[i].exponential(0.04) / CONTROL)
        arrived = self.line.send(tick, command, self.silent[:, None] > 0)
        np.maximum(self.silent - 1, 0, out=self.silent)
        return arrived


class _Drives(Drives):
    """Windings under a supply that sags, and motors that lose torque as they warm up."""

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        super().__init__(plants)
        self.follow = 1.0 / np.maximum(stacked(plants, "lag"), 2 * STEP)
        self.torque = self.given = self.wanted = np.zeros(self.peak.shape)

    def receive(self, wanted: np.ndarray, spin: np.ndarray) -> None:
        """Take new commands, and see what supply and temperature allow until the next ones."""
        self.wanted = np.clip(wanted, -self.peak, self.peak)
        power = (self.given * spin + self.heat * self.given**2).sum(1, keepdims=True)
        self.bus = self.supply - self.resistance * np.maximum(power, 0.0) / self.supply
        self.ceiling = self.stall * self.bus / self.nominal
        warming = self.thermal_resistance * self.heat * self.given**2 - (self.temperature - 25.0)
        self.temperature = self.temperature + CONTROL / self.thermal_time * warming
        warm = np.maximum(self.temperature - 25.0, 0.0)
        self.strength = self.scale * (1.0 - self.derating * warm)

    def step(self, spin: np.ndarray) -> np.ndarray:
        """Torques of the motors after one step `(b, m)` [Nm]."""
        back_emf = self.droop * spin
        ahead = self.follow / ELECTRICAL * (self.wanted - self.torque)
        terminal = np.clip(self.wanted + back_emf + ahead, -self.ceiling, self.ceiling)
        self.torque = self.torque + (terminal - back_emf - self.torque) * min(
            ELECTRICAL * STEP, 0.9
        )
        self.given = self.strength * self.torque
        return self.given


class _Belts:
    """Belts with play, which stiffen as they stretch."""

    def __init__(self, plants: Sequence[RigPlant], matrix: np.ndarray) -> None:
        mobility = np.stack(
            [
                1 / p.rotor_inertia + np.einsum("im,ij,jm->m", k, inverse_inertia(p), k)
                for p, k in zip(plants, matrix, strict=True)
            ]
        )
        # Belts too stiff for the step get the stiffest that it carries: they stay rigid to the eye
        # of a log.
        stiff = BELT_STIFFNESS * stacked(plants, "belt_stiffness")
        self.stiff = np.minimum(stiff, (0.45 / STEP) ** 2 / mobility)
        damp = BELT_DAMPING * stacked(plants, "belt_damping")
        self.damp = np.minimum(damp, 0.25 / (STEP * mobility))
        self.play = stacked(plants, "backlash") / 2
        self.soft_limit = STIFFENING * np.abs(matrix).max(1)

    def pull(self, stretch: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Torques on the motors' side `(b, m)` [Nm], of stretches [rad] and their rates [rad/s]."""
        taut = stretch - np.clip(stretch, -self.play, self.play)
        stiffened = 1.0 + np.minimum((taut / self.soft_limit) ** 2, 3.0)
        return np.asarray(self.stiff * taut * stiffened + self.damp * rate * (taut != 0))


class _Friction:
    """Friction of gears at the rotors, with exact sticking; of coupled joints Dahl's there."""

    def __init__(self, plants: Sequence[RigPlant], matrix: np.ndarray) -> None:
        m = self.motors = matrix.shape[-1]
        self.coulomb, self.static = stacked(plants, "coulomb"), stacked(plants, "static")
        self.stribeck, self.viscous = stacked(plants, "stribeck_speed"), stacked(plants, "viscous")
        self.load = stacked(plants, "load_friction")
        self.patch, self.patch_middle = stacked(plants, "patch"), stacked(plants, "patch_middle")
        declared = plants[0].declared
        coupled = matrix.shape[1] != m or bool(np.any(declared - np.diag(np.diag(declared))))
        if not coupled:
            self.before_the_gear(np.abs(np.diagonal(matrix, axis1=1, axis2=2)))
        self.held = np.zeros(self.patch.shape)
        own = (self.coulomb, self.static, self.viscous, self.load)
        self.at_joints = bool(self.patch.any() or any(values[:, m:].any() for values in own))

    def before_the_gear(self, gear: np.ndarray) -> None:
        """Move friction of the joints to the rotors of gears one to one."""
        m = self.motors
        for values in (self.coulomb, self.static, self.viscous):
            values[:, :m] += values[:, m:] / (gear if values is not self.viscous else gear**2)
            values[:, m:] = 0
        of_joints = self.stribeck[:, m:] * gear
        self.stribeck[:, :m] = np.where(self.load[:, m:] > 0, self.stribeck[:, :m], of_joints)
        self.load[:, :m] += self.load[:, m:]
        self.load[:, m:] = 0

    def slowed_joints(self, pull: np.ndarray, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        """Torques at the joints less friction `(b, n)` [Nm]."""
        m = self.motors
        capacity = (
            self.coulomb[:, m:]
            + (self.static - self.coulomb)[:, m:] * np.exp(-np.abs(qd / self.stribeck[:, m:]))
            + self.load[:, m:] * np.abs(pull)
        )
        capacity = capacity + self.patch * (np.abs(q - self.patch_middle) < 0.15) + 1e-12
        bound = capacity * np.sign(qd)
        self.held = bound + (self.held - bound) * np.exp(-np.abs(qd) * (STEP / PRESLIDING))
        return np.asarray(pull - self.held - self.viscous[:, m:] * qd)

    def slowed_rotors(
        self, spin: np.ndarray, drive: np.ndarray, pull: np.ndarray, inertia: np.ndarray
    ) -> np.ndarray:
        """Speeds of the rotors after one step `(b, m)` [rad/s]."""
        m = self.motors
        free = spin + STEP * (drive - pull - self.viscous[:, :m] * spin) / inertia
        capacity = (
            self.coulomb[:, :m]
            + (self.static - self.coulomb)[:, :m] * np.exp(-((spin / self.stribeck[:, :m]) ** 2))
            + self.load[:, :m] * np.abs(pull)
        )
        slowed = np.maximum(np.abs(free) - STEP * capacity / inertia, 0.0)
        return np.asarray(np.sign(free) * slowed)
