"""An arm of hobby servos as somebody writes it, in a plain MuJoCo loop: nothing of the package
takes part.

Five serial-bus servos with their own firmware: a proportional controller on counts of the encoder
sets the duty of a bridge, so a motor gives the torque that its supply and its speed leave. New
targets come with each row of the log. The supply sags under the current of all servos. The
description has links only, as most of such arms have; what logs declare of the servos (gains,
torque constants, supply) is worked out from a data sheet. Logs hold targets, positions and speeds
at 50 Hz, no torque. Every arm is built differently from its file and its data sheet, and gears have
stiction and friction under load.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from hyperleg_design.validation.benchmark.case import Recording
from hyperleg_design.validation.newcomers.plant import Wrong, rise
from hyperleg_design.validation.newcomers.point_mass import add_point_mass
from hyperleg_design.validation.newcomers.recorded import recorded

XML = """<mujoco model="servo_arm"><compiler angle="degree" autolimits="true"/>
<option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
<worldbody><body name="turret" pos="0 0 .06">
<inertial pos="-.01 0 .03" mass=".12" diaginertia="7e-5 7e-5 5e-5"/>
<joint name="pan" axis="0 0 1" range="-110 110"/>
<body name="upper_arm" pos="0 0 .05">
<inertial pos=".07 0 .005" mass=".13" diaginertia="3e-5 2.4e-4 2.4e-4"/>
<joint name="lift" axis="0 -1 0" range="-20 110"/>
<body name="forearm" pos=".12 0 0">
<inertial pos=".075 .004 0" mass=".11" diaginertia="2.5e-5 2.2e-4 2.2e-4"/>
<joint name="elbow" axis="0 1 0" range="-20 150"/>
<body name="wrist" pos=".13 0 0">
<inertial pos=".03 0 0" mass=".085" diaginertia="2e-5 4e-5 4e-5"/>
<joint name="bend" axis="0 1 0" range="-100 100"/>
<body name="hand" pos=".06 0 0">
<inertial pos=".03 .008 0" mass=".09" diaginertia="3.5e-5 6e-5 5e-5"/>
<joint name="roll" axis="1 0 0" range="-160 160"/>
</body></body></body></body></body></worldbody></mujoco>"""
JOINTS = ("pan", "lift", "elbow", "bend", "roll")
BODIES = ("turret", "upper_arm", "forearm", "wrist", "hand")
LOAD_AT = ((0.0, 0.0, 0.03), (0.1, 0.0, 0.0), (0.1, 0.0, 0.0), (0.04, 0.0, 0.01), (0.05, 0.0, 0.0))
"""Of a load, in the frame of each body [m]."""
MIDDLE = np.radians([0.0, 45.0, 60.0, 0.0, 0.0])
SWING = np.radians([60.0, 38.0, 45.0, 55.0, 70.0])
"""Of all motions [rad]."""
VOLTAGE, RESISTANCE, CONSTANT = 7.4, 2.5, 1.1
"""Of the data sheet [V, ohm, Nm/A at the output]."""
GAIN = 2.6
"""Of the firmware, share of the whole duty a radian."""
STIFFNESS = GAIN * CONSTANT * VOLTAGE / RESISTANCE
DAMPING = CONSTANT**2 / RESISTANCE
"""What the data sheet makes of them [Nm/rad], [Nms/rad]."""
STEP, LOGGED, JITTER = 0.001, 20, 4e-4
"""Of simulation and firmware [s]; its steps in one of the log's; of the log's stamps [s]."""
COUNT = 2 * np.pi / 4096
"""Of the encoders [rad]."""
BLEND = 0.05
"""Of each new speed in the firmware's filter."""
SLOW = 0.05
"""Speed at which stiction fades [rad/s]."""
DEAD = 1
"""Counts of error without any torque."""
ROTOR, DRY, VISCOUS, UNDER_LOAD, STICTION = 0.011, 0.06, 0.03, 0.1, 0.03
"""Of each servo at its output: inertia [kg m^2], friction [Nm], [Nms/rad], share of the torque, and
more friction at rest [Nm]."""
SAG = 0.12
"""Resistance of the supply [ohm]; a servo's electronics are on the same wires."""
SPREAD = {"rotor": 0.2, "dry": 0.25, "viscous": 0.3, "under_load": 0.3, "gain": 0.03}
MOTORS_ALIKE, MOTORS = 0.08, 0.03
"""Standard deviations of the torque constants from the data sheet: of all together, and of each."""
MASSES, CENTRES, ZEROS = 0.04, 0.003, 0.01
"""Of links (share, m) and of encoders [rad], whose horns are on splines."""


@dataclass(frozen=True)
class Run:
    """How one log is made."""

    motion: str
    """One of `MOTIONS`."""
    seed: int
    """Of the motion and the noise."""
    build: int
    """Seed of how the arm was built."""
    name: str
    duration: float = 30.0
    """Of the log [s]."""


def _steps(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Targets that jump, one joint or some at a time."""
    targets = np.tile(MIDDLE, (len(clock), 1))
    begin = 1.0
    while begin < clock[-1]:
        moved = rng.uniform(size=5) < 0.45
        there = MIDDLE + 0.7 * SWING * rng.uniform(-1, 1, 5)
        later = clock >= begin
        targets[later] = np.where(moved, there, targets[later][:1])
        begin += rng.uniform(0.8, 1.8)
    return targets


def _triangles(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Up and down at constant speeds."""
    columns = []
    for middle, swing in zip(MIDDLE, SWING, strict=True):
        phase = (clock / rng.uniform(3, 7) + 0.25) % 1
        wave = 1 - 4 * np.abs(phase - 0.5)
        columns.append(middle + 0.8 * swing * wave * rise(clock / 2))
    return np.array(columns).T


def _chirp(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Sines of rising frequency and falling size, one a joint."""
    columns = []
    for middle, swing in zip(MIDDLE, SWING, strict=True):
        rate = 0.1 + rng.uniform(0.9, 1.6) * clock / clock[-1]
        turns = np.cumsum(rate) * STEP
        size = 0.6 / (1 + 1.2 * rate)
        columns.append(middle + swing * size * np.sin(2 * np.pi * turns) * rise(clock))
    return np.array(columns).T


def _waves(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Sums of slow sines, as somebody teaches by hand."""
    columns = []
    for middle, swing in zip(MIDDLE, SWING, strict=True):
        wave = sum(
            share * np.sin(2 * np.pi * rng.uniform(low, high) * clock + rng.uniform(0, 6.28))
            for low, high, share in ((0.05, 0.12, 0.5), (0.15, 0.35, 0.35), (0.5, 0.9, 0.1))
        )
        columns.append(middle + swing * wave * rise(clock / 1.5))
    return np.array(columns).T


MOTIONS: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "steps": _steps,
    "triangles": _triangles,
    "chirp": _chirp,
    "waves": _waves,
}
"""Targets `(t, 5)` [rad] at times `(t,)` [s]."""


@dataclass
class _Servos:
    """What the servos of one arm are, in the order of its joints."""

    constant: np.ndarray
    gain: np.ndarray
    rotor: np.ndarray
    dry: np.ndarray
    viscous: np.ndarray
    under_load: np.ndarray
    zero: np.ndarray
    voltage: float = VOLTAGE
    sag: float = SAG


def built(build: int) -> tuple[mujoco.MjModel, _Servos]:
    """An arm as it was built: the model of its links, and its servos.

    Args:
        build: seed of what is off in it.

    Returns:
        Model and servos.
    """
    model, rng = mujoco.MjModel.from_xml_string(XML), np.random.default_rng(build)

    def about(value: float, spread: float) -> np.ndarray:
        return np.asarray(value * np.exp(spread * rng.normal(size=5)))

    share = 1 + MASSES * rng.normal(size=model.nbody)
    model.body_mass[:] *= share
    model.body_inertia[:] *= share[:, None]
    model.body_ipos[1:] += CENTRES * rng.normal(size=(model.nbody - 1, 3))
    return model, _Servos(
        constant=about(CONSTANT * np.exp(MOTORS_ALIKE * rng.normal()), MOTORS),
        gain=about(GAIN, SPREAD["gain"]),
        rotor=about(ROTOR, SPREAD["rotor"]),
        dry=about(DRY, SPREAD["dry"]),
        viscous=about(VISCOUS, SPREAD["viscous"]),
        under_load=about(UNDER_LOAD, SPREAD["under_load"]),
        zero=ZEROS * rng.normal(size=5),
        voltage=VOLTAGE + 0.1 * rng.normal(),
    )


def simulate(wrongs: Sequence[Wrong], run: Run) -> Recording:
    """A log of an arm with something wrong, with targets, positions and speeds.

    Args:
        wrongs: what is wrong; empty, nothing is.
        run: how the log is made.

    Raises:
        ValueError: something is wrong that no such arm knows.
    """
    model, servos = built(run.build)
    late, live = 0, []
    for wrong in wrongs:
        j, x = wrong.place, wrong.size
        match wrong.what:
            case "rough":
                servos.dry[j] *= x
            case "thick":
                servos.viscous[j] += x
            case "load":
                add_point_mass(model, BODIES[j], x, LOAD_AT[j])
            case "weak":
                servos.constant[j] *= x
            case "gain":
                servos.gain[j] *= x
            case "zero":
                servos.zero[j] += x
            case "rotor":
                servos.rotor[j] += x
            case "late":
                late = round(x / STEP)
            case "empty":
                servos.voltage *= x
            case "spring" | "drag":
                live.append(wrong)
            case what:
                raise ValueError(f"{what} is nothing that an arm of servos knows")
    model.opt.timestep = STEP
    model.dof_armature[:], model.dof_damping[:] = servos.rotor, servos.viscous
    mujoco.mj_setConst(model, mujoco.MjData(model))
    rng, noise = np.random.default_rng(run.seed), np.random.default_rng(run.seed + 1)
    clock = np.arange(int(run.duration / STEP)) * STEP
    target, data = MOTIONS[run.motion](rng, clock), mujoco.MjData(model)
    target = target[np.arange(len(clock)) // LOGGED * LOGGED]
    target = np.vstack([np.tile(target[0], (late, 1)), target])
    data.qpos[:] = target[0]
    shown, read, voltage, rows = np.zeros(5), target[0], servos.voltage, []
    for k in range(len(clock)):
        q, v = data.qpos, data.qvel
        last, read = read, np.round((q + servos.zero) / COUNT) * COUNT
        shown = shown + BLEND * ((read - last) / STEP - shown)
        error = np.round((target[k] - read) / COUNT)
        error = np.where(np.abs(error) <= DEAD, 0.0, error) * COUNT
        duty = np.clip(servos.gain * error, -1, 1)
        current = (voltage * duty - servos.constant * v) / RESISTANCE
        voltage = servos.voltage - servos.sag * float(np.sum(np.clip(duty * current, 0, None)))
        motor = servos.constant * current
        if k % LOGGED == 0:
            rows.append(np.r_[clock[k], target[k + late], read, shown])
        model.dof_frictionloss[:] = (
            servos.dry + STICTION * np.exp(-((v / SLOW) ** 2)) + servos.under_load * np.abs(motor)
        )
        data.qfrc_applied[:] = motor
        for wrong in live:
            j = wrong.place
            data.qfrc_applied[j] -= wrong.size * (
                q[j] - MIDDLE[j] if wrong.what == "spring" else v[j] * abs(v[j])
            )
        mujoco.mj_step(model, data)
    table = np.array(rows)
    stamps = table[:, 0] + np.clip(JITTER * noise.normal(size=len(table)), -0.002, 0.002)
    blocks = zip(
        ("position_target", "position", "velocity"),
        (JOINTS,) * 3,
        np.split(table[:, 1:], 3, axis=1),
        strict=True,
    )
    stall, free = CONSTANT * VOLTAGE / RESISTANCE, VOLTAGE / CONSTANT
    return recorded(
        run.name, stamps, blocks, JOINTS, [STIFFNESS] * 5, [DAMPING] * 5,
        base="fixed",
        torque_constant=dict.fromkeys(JOINTS, CONSTANT),
        supply={joint: [VOLTAGE, stall, free] for joint in JOINTS},
    )  # fmt: skip
