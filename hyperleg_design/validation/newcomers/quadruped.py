"""A quadruped on its feet as somebody writes it who has the description of Unitree's A1, in a plain
MuJoCo loop: nothing of the package takes part, but for the folder of the description.

Twelve drives with position and damping gains at 400 Hz whose torques lag by 2 ms, a simulation at
0.5 ms with implicit integration and elliptic cones, logs at 200 Hz. A robot is built differently
from its file (masses 1.5 %, centres of mass 1.5 mm, torques 1.5 %, gains 1 %, zeros 2 mrad), and
friction, torques, zeros, the floor and the IMU differ by a little from session to session. Load
cells of the feet, IMU, encoders and an estimator of the base are noisy; load cells and the
accelerometer are filtered.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np

from hyperleg_design.sizing.other_robots import robots_folder
from hyperleg_design.validation.benchmark.case import Recording
from hyperleg_design.validation.newcomers.plant import Wrong
from hyperleg_design.validation.newcomers.quadruped_log import FEET, JOINTS, logged
from hyperleg_design.validation.newcomers.quadruped_motion import MOTIONS

FILE = "a1_description/urdf/a1.urdf"
"""In the robots of `example-robot-data`."""
STIFFNESS, DAMPING = np.tile([90.0, 90.0, 110.0], 4), np.full(12, 2.0)
"""Of the controllers, which logs declare [Nm/rad], [Nms/rad]."""
RUBBING, VISCOUS, ROTOR = 0.25, 0.06, 0.009
"""Dry friction [Nm], damping [Nms/rad] and rotor inertia [kg m^2] of all joints."""
LARGEST = 33.5
"""Torque of all drives [Nm]."""
FLOOR, SOFT, SETTLING = 0.8, 0.0175, 0.011
"""Friction of the floor, and time in which contacts settle, of the file and of the plant [s]: with
the plant's cones and impedances both give as much under a standing robot."""
STEP, TICK, LOGGED = 0.0005, 5, 2
"""Of the simulation [s]; its steps in one of the controller; ticks of that in one of the log."""
LAG = 0.002
"""Of the torques [s]."""
MASSES, CENTRES, TORQUES, GAINS, ZEROS = 0.015, 0.0015, 0.015, 0.01, 0.002
"""Standard deviations by which a robot differs from its file: shares, metres and radians."""
FRICTION_CHANGES, TORQUE_CHANGES, ZERO_CHANGES, FLOOR_CHANGES = 0.05, 0.01, 0.001, 0.04
"""Standard deviations from session to session: shares and radians."""
GYRO_BIAS, FORCE_BIAS = 0.001, 0.02
"""Of the IMU, from session to session [rad/s, m/s^2]."""
COUNT = 2 * np.pi / 2**15
"""Of the encoders [rad]."""
SPEED_NOISE, ANGLE_NOISE = 0.01, 1e-4
"""Of encoders [rad/s, rad]."""
FILTER = 0.003
"""Of load cells and accelerometer [s]."""
ROPE_LENGTH = 0.13
"""Of a rope between a calf and the point of the floor below it, before it pulls [m]."""
BRISTLE = 0.05
"""Turn over which a joint with hysteresis yields [rad]."""
LIVE = ("push", "rope", "lost", "hysteresis", "lossy")
"""Wrong in the loop: a periodic push at the trunk [N], a rope at a calf [N/m], commands that do not
arrive with a probability, hysteresis [Nm], friction over the load of a joint."""


@dataclass(frozen=True)
class Run:
    """How one log is made."""

    motion: str
    """One of `quadruped_motion.MOTIONS`."""
    seed: int
    """Of the motion and the noise."""
    build: int
    """Seed of how the robot was built."""
    session: int
    """Seed of what changes from session to session."""
    name: str
    duration: float = 12.0
    """Of the log [s]."""


def plain_file() -> str:
    """The URDF as it comes: without friction, and without rotors."""
    return (robots_folder() / FILE).read_text()


@cache
def careful_file() -> str:
    """An MJCF as somebody saves it from the URDF who measured friction, rotors and the floor."""
    spec = mujoco.MjSpec.from_string(plain_file())
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = True
    for body in spec.bodies:
        for geom in list(body.geoms):
            if body.name not in FEET or not geom.contype:
                spec.delete(geom)
            else:
                geom.friction[0], geom.solref[0] = FLOOR, SOFT
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    for joint in spec.joints:
        joint.armature, joint.frictionloss = ROTOR, RUBBING
        joint.damping[0] = VISCOUS
    spec.worldbody.first_body().add_freejoint(name="free")
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 1],
        friction=[FLOOR, 0.005, 0.0001],
        solref=[SOFT, 1],
    )
    for name in JOINTS:
        spec.add_actuator(
            name=name.removesuffix("_joint"),
            target=name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            ctrllimited=True,
            ctrlrange=[-LARGEST, LARGEST],
        )
    spec.compile()
    return str(spec.to_xml())


def built(build: int) -> tuple[mujoco.MjModel, np.ndarray, np.ndarray, np.ndarray]:
    """A robot as it was built.

    Args:
        build: seed of what is off in it.

    Returns:
        Its model, and the zeros of its encoders [rad], the torques of its drives and the gains of
        its controllers over those that are believed, `(12,)` each.
    """
    spec, rng = mujoco.MjSpec.from_string(careful_file()), np.random.default_rng(build)
    for actuator in spec.actuators:
        actuator.dyntype = mujoco.mjtDyn.mjDYN_FILTEREXACT
        actuator.dynprm[0] = STEP
    model = spec.compile()
    model.opt.timestep = STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICIT
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 5.0
    model.geom_solref[:, 0] = SETTLING
    model.geom_solimp[:, :3] = 0.9, 0.96, 0.002
    share = 1 + MASSES * rng.normal(size=model.nbody)
    model.body_mass[:] *= share
    model.body_inertia[:] *= share[:, None]
    heavy = model.body_mass > 0.05
    model.body_ipos[heavy] += CENTRES * rng.normal(size=(heavy.sum(), 3))
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return (
        model,
        ZEROS * rng.normal(size=12),
        1 + TORQUES * rng.normal(size=12),
        1 + GAINS * rng.normal(size=12),
    )


@dataclass(frozen=True, eq=False)
class Session:
    """What is otherwise in one session."""

    rubbing: np.ndarray
    """Of dry friction, as damping and torques by joint over that of the robot `(12,)`."""
    viscous: np.ndarray
    floor: float
    """Of the floor's friction."""
    torques: np.ndarray
    zero: np.ndarray
    """Of the encoders, to be added `(12,)` [rad]."""
    bias: np.ndarray
    """Of gyro and accelerometer `(6,)` [rad/s, m/s^2]."""


def session(seed: int) -> Session:
    """Draw what is otherwise in a session.

    Args:
        seed: of the session.

    Returns:
        The deviations.
    """
    rng = np.random.default_rng(seed)
    return Session(
        1 + FRICTION_CHANGES * rng.normal(size=12),
        1 + FRICTION_CHANGES * rng.normal(size=12),
        1 + FLOOR_CHANGES * float(rng.normal()),
        1 + TORQUE_CHANGES * rng.normal(size=12),
        ZERO_CHANGES * rng.normal(size=12),
        np.r_[GYRO_BIAS * rng.normal(size=3), FORCE_BIAS * rng.normal(size=3)],
    )


def simulate(wrongs: Sequence[Wrong], run: Run) -> Recording:
    """A log of a quadruped with something wrong.

    Args:
        wrongs: what is wrong; empty, nothing is.
        run: how the log is made.

    Raises:
        ValueError: something is wrong that no quadruped knows.
    """
    model, zero, torques, gains = built(run.build)
    day = session(run.session)
    model.dof_frictionloss[6:] *= day.rubbing
    model.dof_damping[6:] *= day.viscous
    model.geom_friction[:, 0] *= day.floor
    torques, zero, bias = torques * day.torques, zero + day.zero, day.bias.copy()
    soles = [int(model.body(name).geomadr[0]) for name in FEET]
    late = 0
    live: dict[str, Wrong] = {}
    for wrong in wrongs:
        j, x = wrong.place, wrong.size
        match wrong.what:
            case "dry":
                model.dof_frictionloss[6 + j] += x
            case "rough":
                model.dof_frictionloss[6 + j] *= x
            case "load":
                _load(model, model.body(wrong.body).id, x, np.array(wrong.at))
            case "weak":
                torques[j] *= x
            case "late":
                late = round(x / STEP / TICK)
            case "zero":
                zero[j] += x
            case "rotor":
                model.dof_armature[6 + j] += x
            case "gain":
                gains[j] *= x
            case "slippery":
                model.geom_friction[soles[j], 0] *= x
                model.geom_priority[soles[j]] = 1
            case "soft":
                model.geom_solref[soles[j], 0] *= np.sqrt(x)
                model.geom_priority[soles[j]] = 1
            case "gyro":
                bias[j] += x
            case "tilt":
                model.opt.gravity[:] = 9.81 * np.array([np.sin(x), 0, -np.cos(x)])
            case what if what in LIVE:
                live[what] = wrong
            case what:
                raise ValueError(f"{what} is nothing that a quadruped knows")
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return _driven(model, live, run, _Drives(zero, torques, gains, late), bias, soles)


@dataclass(frozen=True, eq=False)
class _Drives:
    zero: np.ndarray
    torques: np.ndarray
    gains: np.ndarray
    late: int


def _driven(
    model: mujoco.MjModel,
    live: dict[str, Wrong],
    run: Run,
    drives: _Drives,
    bias: np.ndarray,
    soles: list[int],
) -> Recording:
    """Run the loop of controller and simulation, and log it."""
    rng, noise = np.random.default_rng(run.seed), np.random.default_rng(run.seed + 1)
    data, tick = mujoco.MjData(model), STEP * TICK
    target = MOTIONS[run.motion](rng, np.arange(round(run.duration / tick)) * tick)
    _stand(model, data, target[0])
    filtered, trunk = 1 - np.exp(-tick / FILTER), model.body("trunk").id
    _lagging(model, data, drives.torques)
    bristle = np.zeros(12)
    past: list[np.ndarray] = []
    rows: list[np.ndarray] = []
    cells, felt, held = np.zeros((4, 3)), np.array([0, 0, 9.81]), np.zeros(12)
    skipped, lost = 0, live["lost"].size if "lost" in live else 0.0
    anchor = np.zeros(3)
    if "rope" in live:
        anchor = data.xpos[model.body(live["rope"].body).id] * [1, 1, 0] + [0.05, 0, 0]
    for k, wanted in enumerate(target):
        read = data.qpos[7:] + drives.zero + ANGLE_NOISE * noise.normal(size=12)
        read = np.round(read / COUNT) * COUNT
        speed = data.qvel[6:] + SPEED_NOISE * noise.normal(size=12)
        past.append(drives.gains * STIFFNESS * (wanted - read) - DAMPING * speed)
        asked = np.clip(past[max(0, len(past) - 1 - drives.late)], -LARGEST, LARGEST)
        if lost:
            skipped = (
                skipped - 1 if skipped > 0 else int(rng.integers(1, 6)) * (rng.uniform() < lost)
            )
            asked = held if skipped > 0 else asked
        if k == 0:
            data.act[:] = asked
            cells = _forces(model, data, soles)
        held = asked
        turn = data.xmat[trunk].reshape(3, 3)
        cells = cells + filtered * (_forces(model, data, soles) - cells)
        felt = felt + filtered * (turn.T @ (data.qacc[:3] - model.opt.gravity) - felt)
        if k % LOGGED == 0:
            rows.append(
                np.r_[
                    k * tick,
                    wanted,
                    read,
                    speed,
                    past[-1],
                    data.act,
                    data.qpos[:7],
                    data.qvel[:3],
                    data.qvel[3:6] + bias[:3],
                    felt + bias[3:],
                    cells.ravel(),
                ]
            )
        data.ctrl[:] = asked
        if not live:
            mujoco.mj_step(model, data, nstep=TICK)
            continue
        for _ in range(TICK):
            _disturb(model, data, live, bristle, anchor)
            mujoco.mj_step(model, data)
    return logged(np.array(rows), noise, run.name, STIFFNESS, DAMPING)


def _lagging(model: mujoco.MjModel, data: mujoco.MjData, torques: np.ndarray) -> None:
    """Give the drives their lag, and the torques that they have over those that are believed."""
    model.actuator_dynprm[:, 0] = LAG
    model.actuator_gainprm[:, 0] = torques
    data.act[:] = data.ctrl


def _disturb(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    live: dict[str, Wrong],
    bristle: np.ndarray,
    anchor: np.ndarray,
) -> None:
    """Apply what acts from outside and in joints for a step of the simulation."""
    data.qfrc_applied[:] = 0.0
    data.xfrc_applied[:] = 0.0
    for what, wrong in live.items():
        j, x = wrong.place, wrong.size
        speed = float(data.qvel[6 + j])
        if what == "lossy":
            data.qfrc_applied[6 + j] -= x * abs(data.act[j]) * np.tanh(speed / 0.02)
        elif what == "hysteresis":
            bristle[j] += STEP * (speed - abs(speed) * bristle[j]) / BRISTLE
            data.qfrc_applied[6 + j] -= x * bristle[j]
        elif what == "push":
            body = model.body(wrong.body).id
            data.xfrc_applied[body, 1] = x * (np.sin(2 * np.pi * 0.45 * data.time) > 0.75)
        elif what == "rope":
            body = model.body(wrong.body).id
            way = anchor - data.xpos[body]
            length = float(np.linalg.norm(way))
            pull = x * max(length - ROPE_LENGTH, 0.0)
            data.xfrc_applied[body, :3] = pull * way / max(length, 1e-9)


def _stand(model: mujoco.MjModel, data: mujoco.MjData, target: np.ndarray) -> None:
    """Put the robot on its feet at its first targets, and let it come to rest there."""
    data.qpos[2], data.qpos[3], data.qpos[7:] = 0.5, 1.0, target
    mujoco.mj_forward(model, data)
    lowest = min(data.geom_xpos[model.body(name).geomadr[0]][2] for name in FEET)
    data.qpos[2] -= lowest - 0.02
    for _ in range(int(1.0 / STEP)):
        data.ctrl[:] = STIFFNESS * (target - data.qpos[7:]) - DAMPING * data.qvel[6:]
        mujoco.mj_step(model, data)
    data.time = 0.0


def _forces(model: mujoco.MjModel, data: mujoco.MjData, soles: list[int]) -> np.ndarray:
    """Of the floor on the feet, in the world `(4, 3)` [N]."""
    total, force = np.zeros((4, 3)), np.zeros(6)
    for index in range(data.ncon):
        contact = data.contact[index]
        for foot, geom in enumerate(soles):
            if geom in contact.geom:
                mujoco.mj_contactForce(model, data, index, force)
                sign = 1.0 if contact.geom[1] == geom else -1.0
                total[foot] += sign * contact.frame.reshape(3, 3).T @ force[:3]
    return total


def _load(model: mujoco.MjModel, body: int, mass: float, at: np.ndarray) -> None:
    """Put a point mass on a body."""
    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, model.body_iquat[body])
    axes = flat.reshape(3, 3)
    old, centre = float(model.body_mass[body]), model.body_ipos[body].copy()
    away = at - centre
    inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
    inertia += mass * old / (mass + old) * (away @ away * np.eye(3) - np.outer(away, away))
    values, vectors = np.linalg.eigh(inertia)
    vectors[:, 0] *= np.sign(np.linalg.det(vectors))
    mujoco.mju_mat2Quat(model.body_iquat[body], vectors.ravel())
    model.body_inertia[body] = values
    model.body_ipos[body] = (old * centre + mass * at) / (old + mass)
    model.body_mass[body] = old + mass
