"""First rig plant: rotors and joints as two masses on belts, LuGre friction, torque drives;
Pinocchio's ABA, semi-implicit Euler at 0.25 ms.

Coordinates of a robot are its `m` motors, then its `n` joints, `c` in all. With `C = [I; -M]` the
belts stretch by `C^T x`; each pulls `C (stiffness stretch + damping rate)` on the coordinates.
Rotors follow `J w' = drive - friction - pull`, the joints ABA with pull less friction. Several logs
run side by side; only the rigid bodies are taken one by one.
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

STEP = 0.25e-3
"""Of the integrator [s]."""
CONTROL_STEPS = 4
"""Integrator steps a tick of the drives' controllers: 1 kHz."""
SETTLING = 0.6
"""Time that the first target is held before the recording begins [s]."""
BRISTLE_DAMPING = 3e-4
"""Damping over stiffness of the friction's bristles [s]."""
CONTROL = STEP * CONTROL_STEPS
"""Between ticks of the controllers [s]."""


def simulate(
    plants: Sequence[RigPlant],
    targets: np.ndarray,
    rate: float,
    *,
    seeds: Sequence[int],
    energy: bool = False,
) -> list[Trace]:
    """Run rigs side by side.

    Args:
        plants: `b` rigs of the same robot.
        targets: position targets `(b, ticks, n)` [rad] at the host's rate; the drives interpolate
            between its ticks.
        rate: of the host [Hz]; divides 1 kHz.
        seeds: of what is random inside the plant (lost packets), one a rig.
        energy: also compute the energy, for checks.

    Returns:
        One trace a rig.
    """
    b, ticks, n = targets.shape
    hold, lead = round(1.0 / (rate * CONTROL)), round(SETTLING / CONTROL)
    count = ticks * hold
    host, rigs = HostTargets(targets, hold), _Rigs(plants, targets[:, 0])
    lost = _lost(stacked(plants, "loss"), lead + count, CONTROL, seeds)
    columns = columns_of(n, plants[0].rotor_inertia.size)
    recorded = {name: np.empty((count, b, width)) for name, width in columns.items()}
    energies = np.full((count, b), np.nan)
    for tick in range(-lead, count):
        values = rigs.control(tick, host.at(tick), lost[:, tick + lead, None])
        if tick >= 0:
            for name, value in values.items():
                recorded[name][tick] = value
        for _ in range(CONTROL_STEPS):
            rigs.step(tick * CONTROL)
        if tick >= 0:
            recorded["pull"][tick] = rigs.joint_pull()
            if energy:
                energies[tick] = rigs.energies()
    return traces_of(recorded, energies, CONTROL)


class _Rigs:
    """`b` rigs and where they are."""

    def __init__(self, plants: Sequence[RigPlant], target: np.ndarray) -> None:
        matrix = stacked(plants, "joint_from_motor")
        b, n, m = matrix.shape
        self.motors = m
        self.belts, self.friction = _Belts(plants, matrix), _Friction(plants)
        self.drives, self.controllers = _Drives(plants), _Controllers(plants)
        self.forces, self.ripple = UnlistedForces(plants, STEP), Ripple(plants)
        self.inverse_rotor = 1.0 / stacked(plants, "rotor_inertia")
        self.models = [p.model for p in plants]
        self.datas = [p.model.createData() for p in plants]
        self.state = np.zeros((2, b, 1, m + n))
        self.x, self.v = self.state[0, :, 0], self.state[1, :, 0]
        self.x[:, m:] = target - stacked(plants, "offset")
        self.x[:, :m] = (self.x[:, None, m:] @ matrix)[:, 0]

    def control(self, tick: int, target: np.ndarray, lost: np.ndarray) -> dict[str, np.ndarray]:
        """Read the encoders, command the drives, and state what is recorded."""
        m, controllers, drives = self.motors, self.controllers, self.drives
        q, qd, spin = self.x[:, m:], self.v[:, m:], self.v[:, :m]
        fresh = controllers.command(tick, target, q, qd)
        drives.receive(controllers.line.send(tick, fresh, lost), spin)
        return {
            "position": q,
            "velocity": qd,
            "encoder": controllers.encoder,
            "speed": controllers.speed,
            "motor_velocity": spin,
            "command": fresh,
            "drive_torque": drives.current,
            "temperature": drives.temperature,
            "voltage": drives.bus,
        }

    def step(self, time: float) -> None:
        """Change the speeds, then move at the new ones."""
        import pinocchio as pin

        m, x, v = self.motors, self.x, self.v
        given = self.drives.step()
        force = self.belts.force(self.state)
        force -= self.friction.of(force, x, v)
        if self.forces.act:
            force[:, m:] += self.forces.beside(0.0, time, x[:, m:], v[:, m:])
        force[:, :m] += given
        if self.ripple.act:
            turned = x[:, :m]
            force[:, :m] += self.ripple.cogging(turned) + self.ripple.of_torque(turned, given)
        joints = force[:, m:]
        for i, (model, data) in enumerate(zip(self.models, self.datas, strict=True)):
            joints[i] = pin.aba(model, data, x[i, m:], v[i, m:], joints[i])
        force[:, :m] *= self.inverse_rotor
        force *= STEP
        v += force
        x += STEP * v

    def joint_pull(self) -> np.ndarray:
        """Torques of the belts on the joints in the last step `(b, n)` [Nm]."""
        return -(self.belts.pull[:, None] @ self.belts.back)[:, 0][:, self.motors :]

    def energies(self) -> list[float]:
        """Kinetic and elastic energy of rotors and belts, and of the bodies `(b,)` [J]."""
        import pinocchio as pin

        m, x, v, belts = self.motors, self.x, self.v, self.belts
        return [
            pin.computeMechanicalEnergy(model, data, x[i, m:], v[i, m:])
            + 0.5 * (v[i, :m] ** 2 / self.inverse_rotor[i]).sum()
            + 0.5 * (belts.stiff[i] * (x[i] @ belts.split[i]) ** 2).sum()
            for i, (model, data) in enumerate(zip(self.models, self.datas, strict=True))
        ]


class _Controllers:
    """Joint controllers on encoders of the joints."""

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        from_joint = np.stack([np.linalg.pinv(p.declared) for p in plants])
        self.to_motor = np.ascontiguousarray(np.swapaxes(from_joint, 1, 2))
        self.kp, self.kd = stacked(plants, "stiffness"), stacked(plants, "damping")
        self.offset, self.drift = stacked(plants, "offset"), stacked(plants, "drift")
        self.resolution = stacked(plants, "resolution")
        self.eccentricity = stacked(plants, "eccentricity")
        bandwidth = stacked(plants, "velocity_bandwidth")[:, None]
        self.smooth = -np.expm1(-2 * np.pi * bandwidth * CONTROL)
        self.line = DelayLine(stacked(plants, "delay"), CONTROL)
        self.speed, self.encoder = np.zeros(self.kp.shape), np.zeros(self.kp.shape)

    def command(
        self, tick: int, target: np.ndarray, angle: np.ndarray, rate: np.ndarray
    ) -> np.ndarray:
        """Torques that the motors are to give `(b, m)` [Nm], from what the encoders show."""
        encoder = angle + self.offset
        if tick > 0 and self.drift.any():
            encoder = encoder + self.drift * (tick * CONTROL)
        if self.eccentricity.any():
            encoder = encoder + self.eccentricity * np.sin(3 * angle)
        self.encoder = np.round(encoder / self.resolution) * self.resolution
        self.speed += self.smooth * (rate - self.speed)
        joint = self.kp * (target - self.encoder) - self.kd * self.speed
        return np.asarray((joint[:, None] @ self.to_motor)[:, 0])


class _Drives(Drives):
    """Torque loops of first order within an envelope, under a supply that sags, and motors that
    lose torque as they warm up.
    """

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        super().__init__(plants)
        self.lag = -np.expm1(-STEP / np.maximum(stacked(plants, "lag"), 1e-6))
        self.current, self.given = np.zeros(self.peak.shape), np.zeros(self.peak.shape)

    def receive(self, wanted: np.ndarray, spin: np.ndarray) -> None:
        """Take new commands, and see what supply and temperature allow until the next ones."""
        # current, and the voltage that is there against the rotor's back-EMF
        available = self.stall * (self.bus / self.nominal)
        back_emf = self.droop * spin
        within = np.clip(wanted, -available - back_emf, available - back_emf)
        self.wanted = np.clip(within, -self.peak, self.peak)
        given = self.given
        power = np.maximum((given * spin + self.heat * given * given).sum(1, keepdims=True), 0.0)
        self.bus = self.supply - self.resistance * power / self.supply
        warming = self.thermal_resistance * self.heat * given * given - (self.temperature - 25.0)
        self.temperature += CONTROL / self.thermal_time * warming
        warm = np.maximum(self.temperature - 25.0, 0.0)
        self.strength = self.scale * (1.0 - self.derating * warm)

    def step(self) -> np.ndarray:
        """Torques of the motors after one step `(b, m)` [Nm]."""
        self.current += self.lag * (self.wanted - self.current)
        return np.multiply(self.current, self.strength, out=self.given)


class _Belts:
    """Linear belts with play."""

    def __init__(self, plants: Sequence[RigPlant], matrix: np.ndarray) -> None:
        b, _, m = matrix.shape
        split = np.concatenate([np.broadcast_to(np.eye(m), (b, m, m)), -matrix], axis=1)
        self.back = np.ascontiguousarray(np.swapaxes(split, 1, 2))
        self.split = np.ascontiguousarray(split)
        self.stiff, damp = stacked(plants, "belt_stiffness"), stacked(plants, "belt_damping")
        self.play = stacked(plants, "backlash") / 2
        self.has_play = bool(self.play.any())
        inverse_rotor = 1.0 / stacked(plants, "rotor_inertia")
        ahead, self.soften = _stiff_belts(plants, self.stiff, damp, inverse_rotor, matrix)
        self.drag = damp + self.stiff * ahead
        self.pull = np.zeros((b, m))

    def force(self, state: np.ndarray) -> np.ndarray:
        """Torques on motors and joints `(b, m + n)` [Nm]."""
        stretch = (state @ self.split)[:, :, 0]
        if self.has_play:
            taut = stretch[0] - np.clip(stretch[0], -self.play, self.play)
            rated = self.drag * stretch[1] * (taut != 0)
        else:
            taut, rated = stretch[0], self.drag * stretch[1]
        self.pull = (self.stiff * taut + rated) * self.soften
        return np.negative((self.pull[:, None] @ self.back)[:, 0])


class _Friction:
    """LuGre friction of motors and joints."""

    def __init__(self, plants: Sequence[RigPlant]) -> None:
        self.coulomb, self.stribeck = stacked(plants, "coulomb"), stacked(plants, "stribeck_speed")
        static, bristle = stacked(plants, "static"), stacked(plants, "bristle")
        self.viscous, self.load = stacked(plants, "viscous"), stacked(plants, "load_friction")
        self.patch, self.patch_middle = stacked(plants, "patch"), stacked(plants, "patch_middle")
        self.has_load, self.has_patch = bool(self.load.any()), bool(self.patch.any())
        self.size = np.maximum(np.maximum(self.coulomb, static), 1e-9)
        self.excess, self.gain = static - self.coulomb, STEP / bristle
        self.slide = STEP * self.size / bristle
        self.joints = slice(self.size.shape[1] - self.patch.shape[1], None)
        self.bristles = np.zeros(self.size.shape)
        self.rates = np.empty(self.size.shape)

    def of(self, pulled: np.ndarray, x: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Friction after one step `(b, m + n)` [Nm]; in place, as it is most of a step's time."""
        level = v / self.stribeck
        level *= level
        np.negative(level, out=level)
        np.exp(level, out=level)
        level *= self.excess
        level += self.coulomb
        if self.has_load:
            level += self.load * np.abs(pulled)
        if self.has_patch:
            inside = np.abs(x[:, self.joints] - self.patch_middle) < 0.15
            level[:, self.joints] += self.patch * inside
        level += 1e-12
        magnitude = np.abs(v)
        magnitude *= self.slide
        magnitude /= level
        magnitude += 1.0
        bristles = self.bristles + self.gain * v
        bristles /= magnitude
        friction = np.subtract(bristles, self.bristles, out=self.rates)
        friction *= BRISTLE_DAMPING / STEP
        friction += bristles
        friction *= self.size
        friction += self.viscous * v
        self.bristles = bristles
        return friction


def _stiff_belts(
    plants: Sequence[RigPlant],
    stiff: np.ndarray,
    damp: np.ndarray,
    inverse_rotor: np.ndarray,
    matrix: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Of belts whose resonance the step cannot follow, a linearly implicit pull: time ahead [s] and
    factor, `(b, m)` each.
    """
    mobility = inverse_rotor.copy()
    for row, plant in enumerate(plants):
        inverse = inverse_inertia(plant)
        mobility[row] += np.einsum("im,ij,jm->m", matrix[row], inverse, matrix[row])
    fast = (STEP * np.sqrt(stiff * mobility) > 0.35) | (STEP * damp * mobility > 0.2)
    return np.where(fast, STEP, 0.0), np.where(
        fast, 1.0 / (1.0 + STEP * (damp + STEP * stiff) * mobility), 1.0
    )


def _lost(share: np.ndarray, count: int, tick: float, seeds: Sequence[int]) -> np.ndarray:
    """Ticks at which no command arrives `(b, count)`: a two-state process with bursts of 40 ms."""
    lost = np.zeros((share.size, count), bool)
    for row, (part, seed) in enumerate(zip(share, seeds, strict=True)):
        if part > 0:
            rng, at = np.random.default_rng(seed), 0
            while at < count:
                at += round(rng.exponential(0.04 * (1 - part) / part) / tick) + 1
                length = round(rng.exponential(0.04) / tick) + 1
                lost[row, at : at + length] = True
                at += length
    return lost
