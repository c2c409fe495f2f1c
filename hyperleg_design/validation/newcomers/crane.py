"""A small crane as somebody writes it whose drives are not those of the other newcomers' robots, in
a plain MuJoCo loop: nothing of the package takes part.

Four joints with gears; controllers on a clock of 2 ms, a simulation at 0.5 ms. Its drives, those of
references as well, are of one of two kinds: `filtered`, whose controllers take speeds from
differences of encoder counts below 35 Hz, or `lagging`, whose torques follow their commands through
a lag of 2.5 ms that the file does not tell. Every crane is built differently from its file (masses
1.5 %, centres of mass 1.5 mm, friction 7 %, damping 10 %, zeros 0.7 mrad), and sensors are noisy.
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

XML = """<mujoco model="crane"><compiler angle="degree" autolimits="true"/>
<option timestep="0.0005" integrator="implicitfast"><flag contact="disable"/></option>
<worldbody><body name="column" pos="0 0 .9">
<inertial pos="0 0 .05" mass="2.4" diaginertia=".006 .006 .005"/>
<joint name="slew" axis="0 0 1" range="-150 150" damping=".25" frictionloss=".35" armature=".04"/>
<body name="boom" pos=".03 0 .12">
<inertial pos=".17 .01 0" mass="2.1" diaginertia=".002 .028 .028"/>
<joint name="luff" axis="0 -1 0" range="-75 80" damping=".3" frictionloss=".5" armature=".06"/>
<body name="jib" pos=".36 0 0">
<inertial pos=".13 0 .015" mass="1.1" diaginertia=".0012 .0085 .008"/>
<joint name="fold" axis="0 -1 0" range="-140 140" damping=".12" frictionloss=".2" armature=".025"/>
<body name="tool" pos=".27 0 0">
<inertial pos=".02 .03 .05" mass=".45" diaginertia=".0007 .0007 .0004"/>
<joint name="twist" axis="1 0 0" range="-170 170" damping=".03" frictionloss=".06" armature=".006"/>
</body></body></body></body></worldbody>
<actuator><motor name="drive_slew" joint="slew" gear="30" ctrlrange="-1.2 1.2"/>
<motor name="drive_luff" joint="luff" gear="30" ctrlrange="-2 2"/>
<motor name="drive_fold" joint="fold" gear="20" ctrlrange="-1.4 1.4"/>
<motor name="drive_twist" joint="twist" gear="10" ctrlrange="-.6 .6"/></actuator></mujoco>"""
JOINTS = ("slew", "luff", "fold", "twist")
MOTORS = tuple(f"drive_{joint}" for joint in JOINTS)
BODIES = ("column", "boom", "jib", "tool")
LOAD_AT = ((0.2, 0.0, 0.02),) * 3 + ((0.05, 0.0, 0.06),)
"""Of a load, in the frame of each body [m]."""
DRIVES = ("filtered", "lagging")
STIFFNESS = np.array([110.0, 160.0, 70.0, 12.0])
DAMPING = np.array([6.0, 8.0, 3.0, 0.5])
"""Of the controllers, which logs declare [Nm/rad], [Nms/rad]."""
MIDDLE, SWING = np.array([0.0, 0.25, -0.9, 0.2]), np.array([0.9, 0.55, 0.8, 1.0])
"""Of all motions [rad]."""
STEP, EVERY = 0.0005, 4
"""Of the simulation [s], and its steps in one of the controller's and the log's."""
CUT, LAG = 35.0, 0.0025
"""Of the filter of speeds [Hz]; of the torque of lagging drives [s]."""
COUNT = 2 * np.pi / 2**17
"""Of the encoders [rad]."""
MASSES, CENTRES, FRICTION, DAMPERS, ZEROS = 0.015, 0.0015, 0.07, 0.1, 0.0007
"""Standard deviations by which a crane differs from its file: shares, metres and radians."""
POSITION_NOISE, SPEED_NOISE, TORQUE_NOISE = 3e-5, 0.003, 0.004
"""Of sensors [rad, rad/s, share of the motor's largest torque]."""


@dataclass(frozen=True)
class Run:
    """How one log is made."""

    motion: str
    """One of `MOTIONS`."""
    drive: str
    """One of `DRIVES`."""
    seed: int
    """Of the motion and the noise."""
    build: int
    """Seed of how the crane was built."""
    name: str
    duration: float = 12.0
    """Of the log [s]."""


def _picks(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """From point to point with least jerk, and rests between."""
    targets = np.tile(MIDDLE, (len(clock), 1))
    begin, here = 0.0, MIDDLE.copy()
    while begin < clock[-1]:
        there = MIDDLE + SWING * rng.uniform(-1, 1, 4)
        last, rest = rng.uniform(0.6, 1.3), rng.uniform(0.1, 0.5)
        s = np.clip((clock - begin) / last, 0, 1)
        way = 10 * s**3 - 15 * s**4 + 6 * s**5
        moved = here + way[:, None] * (there - here)
        targets = np.where((clock >= begin)[:, None], moved, targets)
        begin, here = begin + last + rest, there
    return targets


def _waves(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """Sums of sines, slow and fast."""
    columns = []
    for middle, swing in zip(MIDDLE, SWING, strict=True):
        wave = sum(
            share * np.sin(2 * np.pi * rng.uniform(low, high) * clock + rng.uniform(0, 6.28))
            for low, high, share in ((0.1, 0.2, 0.5), (0.3, 0.6, 0.4), (0.9, 1.6, 0.12))
        )
        columns.append(middle + swing * wave * rise(clock / 1.5))
    return np.array(columns).T


def _draws(rng: np.random.Generator, clock: np.ndarray) -> np.ndarray:
    """A figure, drawn again and again and ever faster, in a part of the range."""
    phase = 2 * np.pi * (0.25 * clock + 0.02 * clock**2) + rng.uniform(0, 6.28)
    shape = 0.5 * np.array(
        [1.2 * np.sin(phase), np.sin(2 * phase + 1), np.cos(phase), np.sin(phase + 2)]
    )
    return np.asarray(MIDDLE + 0.8 * SWING * shape.T * rise(clock)[:, None])


MOTIONS: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "picks": _picks,
    "waves": _waves,
    "draws": _draws,
}
"""Targets `(t, 4)` [rad] at times `(t,)` [s]."""


@dataclass(frozen=True)
class _State:
    """Of one joint in a step: angle, speed, time over the log's length."""

    angle: float
    speed: float
    share: float

    @property
    def rubs(self) -> float:
        """Sign of the speed, smooth at rest."""
        return float(np.tanh(self.speed / 0.02))


def _stop(place: float, state: _State) -> float:
    """A soft stop that begins at a place [rad]."""
    over = max(state.angle - place, 0.0)
    return -(60 * over + 250 * over**2 + (state.speed if over > 0 else 0.0))


LIVE: dict[str, Callable[[float, _State], float]] = {
    "stop": _stop,
    "oneway": lambda x, s: -x * max(s.rubs, 0.0),
    "warming": lambda x, s: -x * s.share * s.rubs,
    "gust": lambda x, s: x * float(np.sin(2 * np.pi * 12 * s.share * (0.4 + 0.6 * s.share))),
}
"""Torque on a joint [Nm] from the size of what is wrong and the joint's state: a soft stop from an
angle on [rad], friction of one direction [Nm], friction that grows from nothing along the log [Nm],
a push from outside of rising frequency [Nm]."""
SIGNALS = ("eccentric", "dropout", "crosstalk")
"""Wrong in signals and drives: an encoder's error twice a turn [rad], a drive without torque now
and then, for so long each time [s], a share of the torque of the motor before."""


def built(build: int) -> tuple[mujoco.MjModel, np.ndarray]:
    """A crane as it was built: its model, and the zeros of its encoders `(4,)` [rad].

    Args:
        build: seed of what is off in it.

    Returns:
        Model and zeros.
    """
    model, rng = mujoco.MjModel.from_xml_string(XML), np.random.default_rng(build)
    share = 1 + MASSES * rng.normal(size=model.nbody)
    model.body_mass[:] *= share
    model.body_inertia[:] *= share[:, None]
    model.body_ipos[1:] += CENTRES * rng.normal(size=(model.nbody - 1, 3))
    model.dof_frictionloss[:] *= 1 + FRICTION * rng.normal(size=model.nv)
    model.dof_damping[:] *= 1 + DAMPERS * rng.normal(size=model.nv)
    return model, ZEROS * rng.normal(size=model.nv)


def simulate(wrongs: Sequence[Wrong], run: Run) -> Recording:
    """A log of a crane with something wrong, with targets, positions, velocities, commanded and
    given motor torques.

    Args:
        wrongs: what is wrong; empty, nothing is.
        run: how the log is made.

    Raises:
        ValueError: something is wrong that no crane knows.
    """
    model, zero = built(run.build)
    gear, limit = model.actuator_gear[:, 0].copy(), model.actuator_ctrlrange[:, 1].copy()
    gains, weak, late = STIFFNESS.copy(), np.ones(4), 0
    lag = np.full(4, LAG if run.drive == "lagging" else 0.0)
    live: list[Wrong] = []
    for wrong in wrongs:
        j, x = wrong.place, wrong.size
        match wrong.what:
            case "rough":
                model.dof_frictionloss[j] *= x
            case "thick":
                model.dof_damping[j] *= x
            case "load":
                add_point_mass(model, BODIES[j], x, LOAD_AT[j])
            case "weak":
                weak[j] = x
            case "late":
                late = round(x / STEP / EVERY)
            case "zero":
                zero[j] += x
            case "rotor":
                model.dof_armature[j] += x
            case "gain":
                gains[j] *= x
            case "lag":
                lag[j] += x
            case what if what in LIVE or what in SIGNALS:
                live.append(wrong)
            case what:
                raise ValueError(f"{what} is nothing that a crane knows")
    mujoco.mj_setConst(model, mujoco.MjData(model))
    rng, noise = np.random.default_rng(run.seed), np.random.default_rng(run.seed + 1)
    clock = np.arange(int(run.duration / STEP)) * STEP
    target, data = MOTIONS[run.motion](rng, clock), mujoco.MjData(model)
    data.qpos[:] = target[0]
    last = np.round((target[0] + zero) / COUNT) * COUNT
    speed, given, asked = np.zeros(4), np.zeros(4), np.zeros(4)
    past: list[np.ndarray] = []
    rows = []
    blend = 1 - np.exp(-2 * np.pi * CUT * STEP * EVERY)
    smooth = np.where(lag > 0, 1 - np.exp(-STEP / np.maximum(lag, 1e-9)), 1.0)
    dead = 0
    for k, wanted in enumerate(target):
        q, v = data.qpos, data.qvel
        if k % EVERY == 0:
            read = q + zero
            for wrong in live:
                if wrong.what == "eccentric":
                    read[wrong.place] += wrong.size * np.sin(2 * q[wrong.place] + 0.5)
            read = np.round((read + POSITION_NOISE * noise.normal(size=4)) / COUNT) * COUNT
            if run.drive == "filtered":
                speed = speed + blend * ((read - last) / (STEP * EVERY) - speed)
            else:
                speed = v + SPEED_NOISE * noise.normal(size=4)
            last = read
            past.append((gains * (wanted - read) - DAMPING * speed) / gear)
            asked = np.clip(past[max(0, len(past) - 1 - late)], -limit, limit)
            for wrong in live:
                if wrong.what == "dropout":
                    if dead > 0:
                        dead -= 1
                    elif rng.uniform() < 0.004:
                        dead = int(wrong.size / (STEP * EVERY))
            if k == 0:
                given = asked.copy()
            shown = given if run.drive == "lagging" else asked
            rows.append(np.r_[k * STEP, wanted, read, speed, past[-1], shown])
        given = given + smooth * (asked - given)
        torque = given * weak
        data.qfrc_applied[:] = 0.0
        for wrong in live:
            j = wrong.place
            if wrong.what == "dropout" and dead > 0:
                torque[j] = 0.0
            if wrong.what == "crosstalk":
                torque[j] += wrong.size * given[j - 1]
            if wrong.what in LIVE:
                state = _State(float(q[j]), float(v[j]), clock[k] / run.duration)
                data.qfrc_applied[j] += LIVE[wrong.what](wrong.size, state)
        data.ctrl[:] = np.clip(torque, -limit, limit)
        mujoco.mj_step(model, data)
    return _logged(np.array(rows), limit, noise, run.name)


def _logged(
    table: np.ndarray, limit: np.ndarray, noise: np.random.Generator, label: str
) -> Recording:
    """The log with the noise of its torque sensors."""
    parts = np.split(table[:, 1:], 5, axis=1)
    parts[4] = parts[4] + TORQUE_NOISE * limit * noise.normal(size=parts[4].shape)
    blocks = zip(
        ("position_target", "position", "velocity", "motor_torque_command", "motor_torque"),
        (JOINTS, JOINTS, JOINTS, MOTORS, MOTORS),
        parts,
        strict=True,
    )
    return recorded(label, table[:, 0], blocks, JOINTS, STIFFNESS, DAMPING)
