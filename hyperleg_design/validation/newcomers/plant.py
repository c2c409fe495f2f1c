"""Plain MuJoCo loops that make logs of a robot with something wrong: nothing of the package takes
part.

Controllers and logs run at 200 Hz, the simulation at 1 kHz. Every robot is built differently from
its file (masses 1.5 %, friction 8 %, zeros 1 mrad), and sensors are noisy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from hyperleg_design.validation.benchmark.case import Recording
from hyperleg_design.validation.newcomers.recorded import recorded
from hyperleg_design.validation.newcomers.robots import Robot

STEP, TICKS, DURATION = 0.001, 5, 14.0
"""Of the simulation [s]; its steps in one of controller and log; length of a log [s]."""
MASSES, FRICTION, ZEROS = 0.015, 0.08, 0.001
"""Standard deviations by which a robot differs from its file: shares, and radians."""
POSITION_NOISE, VELOCITY_NOISE, TORQUE_NOISE = 5e-5, 4e-3, 0.004
"""Of sensors [rad, rad/s, share of the motor's largest torque]."""
ROTORS = 0.6
"""Share of a drive's reflected inertia that is before its transmission, where all have one that
gives; the rest is its gear's wheel at the joint."""
STIFF = 60.0
"""Of a transmission that has play: how its rotor rings while it is taut [Hz]."""


@dataclass(frozen=True)
class Wrong:
    """One thing that is wrong."""

    what: str
    """One of those that `simulate` knows."""
    place: int = 0
    """Number of the joint or motor."""
    size: float = 0.0
    body: str = ""
    """Of a load."""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of a load, in the frame of its body [m]."""


def everywhere(wrongs: Sequence[Wrong]) -> bool:
    """Tell whether what is wrong is one thing at several places.

    Args:
        wrongs: all that is wrong.

    Returns:
        Whether it is.
    """
    return len(wrongs) > 1 and len({wrong.what for wrong in wrongs}) == 1


def rise(clock: np.ndarray) -> np.ndarray:
    """Rise from 0 to 1 between the times 0 and 1, smoothly at both.

    Args:
        clock: `(t,)`.

    Returns:
        `(t,)`.
    """
    share = np.clip(clock, 0, 1)
    return np.asarray(share**2 * (3 - 2 * share))


def motion(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Targets of slow and fast swings with pauses `(t, n)` [rad], one row a step.

    Args:
        robot: the robot.
        rng: source of randomness.

    Returns:
        The targets `(t, n)` [rad].
    """
    clock = np.arange(int(DURATION / STEP)) * STEP
    if not robot.steps:
        return _smooth(robot, rng, clock)
    columns = []
    for middle, swing in zip(robot.middle, robot.swing, strict=True):
        wave = np.full_like(clock, middle)
        for (low, high), share in (((0.12, 0.25), 0.5), ((0.4, 0.8), 0.35), ((1.2, 2.2), 0.1)):
            frequency, phase = rng.uniform(low, high), rng.uniform(0, 2 * np.pi)
            wave += swing * share * np.sin(2 * np.pi * frequency * clock + phase)
        pause = clock % 5 > 4.2
        begins = np.where(pause & ~np.roll(pause, 1), np.arange(len(clock)), 0)
        wave = np.where(pause, wave[np.maximum.accumulate(begins)], wave)
        wave = middle + (wave - middle) * np.clip(clock / 0.5, 0, 1)
        window = np.hanning(81) / np.hanning(81).sum()
        columns.append(np.convolve(np.pad(wave, 40, "edge"), window, "valid"))
    return np.array(columns).T


def _smooth(robot: Robot, rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Swings whose own time stands still for a while every five seconds, without a jump."""
    pace = np.clip((np.abs((clock - 2) % 5 - 2.5) - 0.4) / 0.5, 0, 1)
    own = np.cumsum(pace * pace * (3 - 2 * pace)) * STEP
    begun = np.clip(clock, 0, 1)
    columns = []
    for middle, swing in zip(robot.middle, robot.swing, strict=True):
        wave = np.zeros_like(clock)
        for (low, high), share in (((0.12, 0.25), 0.5), ((0.4, 0.8), 0.35), ((1.2, 2.2), 0.1)):
            frequency, phase = rng.uniform(low, high), rng.uniform(0, 2 * np.pi)
            wave += share * np.sin(2 * np.pi * frequency * own + phase)
        columns.append(middle + swing * wave * begun * begun * (3 - 2 * begun))
    return np.array(columns).T


def built(robot: Robot, build: int) -> tuple[mujoco.MjModel, np.ndarray]:
    """A robot as it was built: its model, and the zeros of its encoders `(n,)` [rad].

    Args:
        robot: the robot.
        build: seed of what is off in it.

    Returns:
        Model and zeros.
    """
    model, own = mujoco.MjModel.from_xml_string(robot.xml), np.random.default_rng(build)
    model.body_mass[:] *= 1 + MASSES * own.normal(size=model.nbody)
    model.dof_frictionloss[:] *= 1 + FRICTION * own.normal(size=model.nv)
    model.dof_damping[:] *= 1 + FRICTION * own.normal(size=model.nv)
    return model, ZEROS * own.normal(size=model.nv)


def moment(model: mujoco.MjModel) -> np.ndarray:
    """Joint torques from motor torques, transposed `(motors, joints)`: the gears and tendons.

    Args:
        model: the compiled model.

    Returns:
        `(motors, joints)`.
    """
    data, dense = mujoco.MjData(model), np.zeros((model.nu, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mju_sparse2dense(
        dense, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
    )
    return dense


def simulate(
    robot: Robot, wrongs: tuple[Wrong, ...], seed: int, build: int, name: str
) -> Recording:
    """A log of a robot with something wrong, with targets, positions, velocities, commanded and
    given motor torques.

    Args:
        robot: nominal.
        wrongs: what is wrong; empty, nothing is.
        seed: of the motion and the noise.
        build: seed of how the robot was built.
        name: of the log.

    Raises:
        ValueError: something is wrong that no plant knows.
    """
    model, zero = built(robot, build)
    lever = moment(model)
    to_motor, limit = np.linalg.inv(lever.T), model.actuator_ctrlrange[:, 1].copy()
    gains, weak = np.array(robot.stiffness, float), np.ones(model.nu)
    constant = np.full(model.nu, robot.lag)
    late, lost, live = 0, 0.0, []
    drives = _Drives(model, robot.belts) if robot.belts else None
    for wrong in wrongs:
        j, x = wrong.place, wrong.size
        match wrong.what:
            case "load":
                _load(model, model.body(wrong.body).id, x, np.array(wrong.at))
            case "rotor":
                model.dof_armature[j] += x
            case "rough":
                model.dof_frictionloss[j] *= x
            case "thick":
                model.dof_damping[j] *= x
            case "tilt":
                model.opt.gravity[:] = 9.81 * np.array([np.sin(x), 0, -np.cos(x)])
            case "zero":
                zero[j] += x
            case "gain":
                gains[j] *= x
            case "weak":
                weak[j] = x
            case "limit":
                limit[j] = x
            case "late":
                late = round(x / STEP / TICKS)
            case "lag":
                constant[j] += x
            case "lost commands":
                lost = x
            case "soft" | "play":
                drives = _Drives(model, 0.0, wrong) if drives is None else drives.with_wrong(wrong)
            case what if what in LIVE or what == "ripple":
                live.append(wrong)
            case what:
                raise ValueError(f"{what} is nothing that a plant knows")
    if drives is not None:
        drives.take_rotors(model)
    mujoco.mj_setConst(model, mujoco.MjData(model))
    rng, data = np.random.default_rng(seed), mujoco.MjData(model)
    target, middle = motion(robot, rng), np.array(robot.middle)
    damping, bristle = np.array(robot.damping), np.zeros(model.nv)
    data.qpos[:] = target[0]
    if drives is not None:
        drives.angle[:] = target[0]
    past: list[np.ndarray] = []
    rows = []
    given = np.zeros(model.nu)
    smooth = 1 - np.exp(-STEP / np.maximum(constant, 1e-9))
    for tick, wanted in enumerate(target):
        q, v = data.qpos, data.qvel
        if tick % TICKS == 0:
            past.append(to_motor @ (gains * (wanted - q - zero) - damping * v))
            skipped = 1 + rng.integers(0, 6) if lost and rng.uniform() < lost else 0
            asked = np.clip(past[max(0, len(past) - 1 - (late or skipped))], -limit, limit)
            if tick == 0:
                given = asked.copy()
            shown = asked if not constant.any() else given
            rows.append(np.r_[tick * STEP, wanted, q + zero, v, past[-1], shown])
        given += smooth * (asked - given)
        torque = given * weak
        for wrong in live:
            if wrong.what == "ripple":
                torque[wrong.place] *= 1 + wrong.size * np.sin(14 * float(lever[wrong.place] @ q))
        bristle += STEP * (v - abs(v) * bristle) / 0.05
        data.qfrc_applied[:] = 0.0
        for wrong in live:
            if wrong.what != "ripple":
                j = wrong.place
                state = _State(
                    float(q[j]), float(v[j]), float(q[j] - middle[j]), float(bristle[j]),
                    float((lever.T @ torque)[j]), tick * STEP,
                )  # fmt: skip
                data.qfrc_applied[j] += LIVE[wrong.what](wrong.size, state)
        if drives is not None:
            joint = lever.T @ torque
            data.ctrl[:] = to_motor @ np.where(drives.there, 0.0, joint)
            data.qfrc_applied[:] += drives.pull(joint, q, v)
        else:
            data.ctrl[:] = torque
        mujoco.mj_step(model, data)
    return _logged(robot, model, np.array(rows), seed, name)


@dataclass(frozen=True)
class _State:
    """Of one joint in a step: angle, speed, angle from the middle, bristle, motor torque, time."""

    angle: float
    speed: float
    away: float
    bristle: float
    torque: float
    time: float

    @property
    def rubs(self) -> float:
        """Sign of the speed, smooth at rest."""
        return float(np.tanh(self.speed / 0.02))


LIVE = {
    "dry": lambda x, s: -x * s.rubs,
    "viscous": lambda x, s: -x * s.speed,
    "spring": lambda x, s: -x * s.away,
    "breakaway": lambda x, s: -x * np.exp(-((s.speed / 0.1) ** 2)) * np.tanh(s.speed / 0.01),
    "lossy": lambda x, s: -x * abs(s.torque) * s.rubs,
    "drag": lambda x, s: -x * abs(s.speed) * s.speed,
    "hysteresis": lambda x, s: -x * s.bristle,
    "push": lambda x, s: x * float(np.sin(2 * np.pi * 0.9 * s.time + 1) > 0.8),
    "patch": lambda x, s: -x * np.exp(-(((s.away - 0.1) / 0.08) ** 2)) * s.rubs,
}
"""Torque on a joint [Nm] from the size of what is wrong and the joint's state."""


class _Drives:
    """Rotors between their torques and their joints, on springs, some with play; counted at the
    joints.
    """

    def __init__(self, model: mujoco.MjModel, frequency: float, wrong: Wrong | None = None) -> None:
        n = model.nv
        self.angle, self.speed = np.zeros(n), np.zeros(n)
        self.share = ROTORS if frequency else 1.0
        self.inertia = np.zeros(n)
        self.there = np.full(n, bool(frequency))
        self.frequency, self.half = np.full(n, frequency), np.zeros(n)
        if wrong is not None:
            self.with_wrong(wrong)

    def with_wrong(self, wrong: Wrong) -> _Drives:
        """Make one transmission soft, `size` its frequency [Hz], or give it a play of `size`
        [rad].

        Args:
            wrong: what is wrong.

        Returns:
            The changed drives.
        """
        self.there[wrong.place] = True
        soft = wrong.what == "soft"
        self.frequency[wrong.place] = wrong.size if soft else STIFF
        self.half[wrong.place] = 0.0 if soft else wrong.size / 2
        return self

    def take_rotors(self, model: mujoco.MjModel) -> None:
        """Take the rotors out of the model: they move by themselves.

        Args:
            model: the compiled model, which is changed.
        """
        self.inertia = self.share * model.dof_armature
        model.dof_armature[self.there] *= 1 - self.share
        self.stiffness = self.inertia * (2 * np.pi * self.frequency) ** 2
        self.damping = 0.1 * np.sqrt(self.stiffness * self.inertia)

    def pull(self, torque: np.ndarray, place: np.ndarray, speed: np.ndarray) -> np.ndarray:
        """Mean torques on the joints over a step of the simulation `(n,)` [Nm].

        Args:
            torque: of the motors `(m,)` [Nm].
            place: of the joints `(n,)` [rad].
            speed: of the joints `(n,)` [rad/s].

        Returns:
            The torques `(n,)` [Nm].
        """
        total, parts = np.zeros_like(torque), 8
        for part in range(parts):
            stretch = self.angle - place - speed * STEP * part / parts
            taut = stretch - np.clip(stretch, -self.half, self.half)
            touches = (taut != 0) | (self.half == 0)
            force = self.stiffness * taut + touches * self.damping * (self.speed - speed)
            self.speed += STEP / parts * (torque - force) / self.inertia
            self.angle += STEP / parts * self.speed
            total += force / parts
        return np.where(self.there, total, 0.0)


def _load(model: mujoco.MjModel, body: int, mass: float, at: np.ndarray) -> None:
    """Put a point mass on a body."""
    old, centre = float(model.body_mass[body]), model.body_ipos[body].copy()
    away = float((at - centre) @ (at - centre))
    model.body_inertia[body] += mass * old / (mass + old) * away * np.array([1, 1, 0.02])
    model.body_ipos[body] = (old * centre + mass * at) / (old + mass)
    model.body_mass[body] = old + mass


def _logged(
    robot: Robot, model: mujoco.MjModel, table: np.ndarray, seed: int, name: str
) -> Recording:
    """The log with the noise of its sensors."""
    n, m, noise = model.nv, model.nu, np.random.default_rng(seed + 1)
    time, target, position, velocity, command, torque = np.split(
        table, np.cumsum([1, n, n, n, m]), axis=1
    )
    position = position + POSITION_NOISE * noise.normal(size=position.shape)
    velocity = velocity + VELOCITY_NOISE * noise.normal(size=velocity.shape)
    largest = model.actuator_ctrlrange[:, 1]
    torque = torque + TORQUE_NOISE * largest * noise.normal(size=torque.shape)
    stamps = time[:, 0] + np.clip(robot.jitter * noise.normal(size=len(time)), -1e-3, 1e-3)
    joints = [model.joint(i).name for i in range(model.njnt)]
    motors = [model.actuator(i).name for i in range(m)]
    blocks = (
        ("position_target", joints, target),
        ("position", joints, position),
        ("velocity", joints, velocity),
        ("motor_torque_command", motors, command),
        ("motor_torque", motors, torque),
    )
    return recorded(name, stamps, blocks, joints, robot.stiffness, robot.damping)
