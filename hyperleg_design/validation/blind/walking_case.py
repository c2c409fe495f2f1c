"""One case of a robot on its feet: draw robot and day, size the effect, record with an estimator's
base, an IMU and loaded soles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.validation.blind.chain import GRAVITY, Chain, chain
from hyperleg_design.validation.blind.nuisance import Nuisance, built, of_day, of_robot
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.plant_walking import (
    Ground,
    Stand,
    WalkingPlant,
    WalkingTrace,
    pad_names,
    simulate_walking,
    walking_model,
)
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.residual import CUTOFF, EDGE, SLOW, SOFT, multiple
from hyperleg_design.validation.blind.rig_build import build_rig, tilted
from hyperleg_design.validation.blind.rig_case import Case, draw, size_at
from hyperleg_design.validation.blind.wrong import SIZES, WALKING_ONLY, Size, Wrong

if TYPE_CHECKING:
    from hyperleg_design.gap.logs.log import Log

BASE = "pelvis"
RECORDINGS = 2
"""Logs of a case."""
PROBE = 4.0
"""Length of the runs that seek an effect's size [s]."""
PROBED = 3
"""Sizes tried."""
ATTEMPTS = 3
"""Places tried."""
MILDER, MOTIONS = 3, 4
"""Times that an effect which fells the robot is made milder; sets of motions tried, as some are
near a fall without any."""
FORCE_NOISE = 0.6
"""Of a pad's load cell [N]."""
ESTIMATE = (4e-4, 3e-4, 4e-3)
"""Noise of the base's estimated position [m], orientation [rad] and velocity [m/s]."""
INERTIAL = (2e-3, 0.04)
"""Noise of gyro [rad/s] and accelerometer [m/s^2]."""
GROUND_SIZES = {
    "imu_bias": Size("of 1 rad/s (gyro) or 10 m/s^2 (accelerometer)", 0.003, 0.12),
    "ground_friction": Size("1 - true friction / nominal", 0.5, 0.9),
    "ground_compliance": Size("nominal stiffness over true", 3.0, 60.0),
}
"""As `wrong.SIZES`, of the effects that only a robot on its feet shows."""
NOMINAL_GROUND = (2.5e4, 230.0)
"""Stiffness [1/s^2] and damping [1/s] of the plant's own contact; about as deep as the simulator's
at rest."""


def walking_case(plan: Plan) -> Case:
    """Simulate one case of the plant `walking`."""
    from hyperleg_design.validation.blind.truth import parameters, places

    rng = np.random.default_rng([*plan.seed, 3])
    robot = chain("hyperleg")
    life = of_robot(robot, rng)
    floor = Floor(
        float(rng.uniform(0.92, 1.08)),
        float(rng.uniform(0.8, 1.25)),
        float(rng.uniform(0.98, 1.02)),
    )
    walker = _Walker(robot, of_day(robot, life, rng), floor, plan.recorder)
    wrongs: list[Wrong] = []
    for effect, wanted in zip(plan.effects, plan.multiples, strict=True):
        wrongs.append(_sized(walker, effect, wanted, rng, [w.location for w in wrongs]))
    made = None
    for _ in range(MOTIONS):
        if (made := _recorded(walker, plan, wrongs, rng)) is not None:
            break
    if made is None:
        raise RuntimeError("the robot fell in every recording, however small the effect")
    logs, wrongs, reached = made
    references: list[Log] = []
    if plan.references:
        walker = replace(walker, day=of_day(robot, life, rng))
        seed = int(rng.integers(2**31))
        log = walker.log(
            walker.trace((), drawn_stand(rng), plan.duration, seed),
            seed,
            "before_0",
            session="before",
            role="reference",
        )
        references = [log] if log is not None else []
    return Case(
        plan=plan,
        robot=robot.robot,
        mjcf=None,
        logs=tuple(logs),
        references=tuple(references),
        wrongs=tuple(wrongs),
        multiples=reached,
        parameters=tuple(
            _ground_parameters(w)
            if w.effect in WALKING_ONLY
            else parameters(w, robot, walker.day, None)
            for w in wrongs
        ),
        also=tuple(
            (BASE, "robot")
            if w.location == BASE
            else (*places(w, robot), *_FEET)
            if w.location in _FEET
            else places(w, robot)
            for w in wrongs
        ),
    )


def _recorded(
    walker: _Walker, plan: Plan, wrongs: Sequence[Wrong], rng: np.random.Generator
) -> tuple[list[Log], list[Wrong], tuple[float, ...]] | None:
    """Logs of motions in which the robot stands, without and with the effects, these as large as
    that allows, and their multiples.

    None where it falls with the mildest.
    """
    runs: list[tuple[Stand, int]] = []
    clean: list[Log] = []
    for _ in range(5 * RECORDINGS):
        if len(clean) == RECORDINGS:
            break
        stand, seed = drawn_stand(rng), int(rng.integers(2**31))
        upright = walker.log(
            walker.trace((), stand, plan.duration, seed),
            seed,
            f"today_{len(clean)}",
            session="today",
        )
        if upright is not None:
            runs.append((stand, seed))
            clean.append(upright)
    if len(clean) < RECORDINGS:
        raise RuntimeError("the healthy robot fell in every recording")
    if not wrongs:
        return clean, [], ()

    def run(given: Sequence[Wrong]) -> list[Log] | None:
        logs: list[Log] = []
        for number, (stand, seed) in enumerate(runs):
            log = walker.log(
                walker.trace(given, stand, plan.duration, seed),
                seed,
                f"today_{number}",
                session="today",
            )
            if log is None:
                return None
            logs.append(log)
        return logs

    given = list(wrongs)
    for _ in range(1 + MILDER):  # sized on short runs, an effect may fell the robot in a long one
        logs = run(given)
        alone = (
            [logs] if len(given) == 1 else [run((w,)) for w in given] if logs is not None else []
        )
        if logs is not None and all(own is not None for own in alone):
            return (
                logs,
                given,
                tuple(
                    shown(w.effect, own or [], clean, walker.chain)
                    for w, own in zip(given, alone, strict=True)
                ),
            )
        given = [replace(w, size=_milder(w)) for w in given]
    return None


_FEET = ("ground", "left_foot", "right_foot", "robot")


def _milder(wrong: Wrong) -> float:
    return (
        1.0 + 0.4 * (wrong.size - 1.0) if wrong.effect == "ground_compliance" else 0.4 * wrong.size
    )


@dataclass(frozen=True)
class Floor:
    """What stays with one place and one pelvis."""

    friction: float
    stiffness: float
    """Over the nominal [-]."""
    pelvis: float
    """True mass of the pelvis over the drawing's [-]."""


@dataclass(frozen=True, eq=False)
class _Walker:
    chain: Chain
    day: Nuisance
    floor: Floor
    recorder: Recorder

    def plant(self, wrongs: Sequence[Wrong]) -> WalkingPlant:
        gravity, masses, push, loads = GRAVITY.copy(), built(self.chain, self.day), np.zeros(3), []
        friction, stiffness = self.floor.friction, self.floor.stiffness
        gyro, accelerometer, frequency = np.zeros(3), np.zeros(3), 1.0
        drives: list[Wrong] = []
        for w in wrongs:
            axis = np.array([w.shape.get(a, 0.0) for a in "xyz"])
            if w.effect == "tilted_gravity":
                gravity = tilted(w.size, w.shape["heading"])
            elif w.effect == "periodic_push":
                push, frequency = 400.0 * w.size * np.array([0.5, 1.0, 0.0]), w.shape["frequency"]
            elif w.effect == "imu_bias":
                gyro, accelerometer = (
                    w.shape["gyro"] * w.size * axis,
                    (1 - w.shape["gyro"]) * 10.0 * w.size * axis,
                )
            elif w.effect == "ground_friction":
                friction *= 1.0 - w.size
            elif w.effect == "ground_compliance":
                stiffness /= w.size
            elif w.effect == "payload":
                loads.append((w.size, axis))
            elif w.effect == "link_mass":
                link = next(link for link in self.chain.links if link.name == w.location)
                own = next(link for link in masses.links if link.name == w.location)
                masses = masses.with_link(
                    link.name,
                    mass=own.mass + w.size * link.mass,
                    inertia=own.inertia * (1 + w.size),
                )
            else:
                drives.append(w)
        ground = Ground(
            friction, NOMINAL_GROUND[0] * stiffness, NOMINAL_GROUND[1] * np.sqrt(stiffness)
        )
        model = walking_model(self.chain, masses, ground, self.floor.pelvis, gravity)
        for mass, place in loads:
            _hang(model, mass, place)
        return WalkingPlant(
            model,
            replace(build_rig(self.chain, self.day, drives), push_frequency=frequency),
            gyro,
            accelerometer,
            push,
        )

    def trace(
        self, wrongs: Sequence[Wrong], stand: Stand, duration: float, seed: int
    ) -> tuple[WalkingPlant, WalkingTrace]:
        plant = self.plant(wrongs)
        return plant, simulate_walking(plant, self.chain, stand, duration, self.recorder.rate, seed)

    def log(
        self, made: tuple[WalkingPlant, WalkingTrace], seed: int, name: str, **metadata: Any
    ) -> Log | None:
        """A log, or None where the robot fell."""
        plant, trace = made
        return (
            None
            if trace.fell
            else _record(
                plant, trace, self.chain, self.recorder, np.random.default_rng(seed), name, metadata
            )
        )


def _hang(model: Any, mass: float, place: np.ndarray) -> None:
    """Put a point mass on the pelvis of a compiled model."""
    import mujoco

    from hyperleg_design.validation.blind.chain import matrix, steiner

    body = model.body(BASE).id
    own, com, axes = (
        float(model.body_mass[body]),
        model.body_ipos[body].copy(),
        matrix(model.body_iquat[body]),
    )
    total = own + mass
    middle = (own * com + mass * place) / total
    inertia = (
        axes @ np.diag(model.body_inertia[body]) @ axes.T
        + steiner(own, com - middle)
        + steiner(mass, place - middle)
    )
    values, turned = np.linalg.eigh(inertia)
    if np.linalg.det(turned) < 0:
        turned[:, 0] *= -1
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, turned.ravel())
    (
        model.body_mass[body],
        model.body_ipos[body],
        model.body_inertia[body],
        model.body_iquat[body],
    ) = total, middle, values, quaternion
    mujoco.mj_setConst(model, mujoco.MjData(model))


def drawn_stand(rng: np.random.Generator) -> Stand:
    """A motion on both feet."""
    return Stand(
        squat=rng.uniform(0.18, 0.3),
        sway=rng.uniform(0.03, 0.06),
        twist=rng.uniform(0.03, 0.06),
        rock=rng.uniform(0.005, 0.012),
        frequency=rng.uniform([0.35, 0.3, 0.4, 0.3, 0.25], [0.7, 0.5, 0.8, 0.6, 0.5]),
        knee=rng.uniform(0.65, 0.85),
        spread=rng.uniform(0.10, 0.22),
        turn=rng.uniform(0.08, 0.18),
    )


def _sized(
    walker: _Walker, effect: str, wanted: float, rng: np.random.Generator, taken: Sequence[str]
) -> Wrong:
    limits = {**SIZES, **GROUND_SIZES}[effect]
    best: tuple[float, Wrong] | None = None
    for _ in range(ATTEMPTS):
        draft = _draft(walker.chain, effect, rng, taken)
        stand, seed = drawn_stand(rng), int(rng.integers(2**31))
        clean = walker.log(walker.trace((), stand, PROBE, seed), seed, "probe")
        if clean is None:
            continue
        sizes, ratios = np.geomspace(limits.smallest, limits.largest, PROBED), []
        for size in sizes:
            log = walker.log(
                walker.trace((replace(draft, size=float(size * draft.size)),), stand, PROBE, seed),
                seed,
                "probe",
            )
            ratios.append(np.inf if log is None else shown(effect, [log], [clean], walker.chain))
            if ratios[-1] > wanted:
                break
        size, reached = size_at(sizes[: len(ratios)], np.array(ratios), wanted, limits.smallest)
        if best is None or reached > best[0]:
            best = (reached, replace(draft, size=float(size * draft.size)))
        if reached >= 0.8 * wanted:
            break
    if best is None:
        raise RuntimeError("the healthy robot fell in every run")
    return best[1]


def _draft(robot: Chain, effect: str, rng: np.random.Generator, taken: Sequence[str]) -> Wrong:
    way = rng.standard_normal(3)
    axis = dict(zip("xyz", (way / np.linalg.norm(way)).tolist(), strict=True))
    if effect == "imu_bias":
        return Wrong(effect, "imu", 1.0, {**axis, "gyro": float(rng.integers(2))})
    if effect in WALKING_ONLY:
        return Wrong(effect, "ground", 1.0, {})
    if effect == "payload":
        return Wrong(
            effect,
            BASE,
            1.0,
            dict(
                zip("xyz", rng.uniform([-0.1, -0.08, 0.05], [0.1, 0.08, 0.3]).tolist(), strict=True)
            ),
        )
    if effect == "periodic_push":
        return Wrong(effect, "robot", 1.0, {"frequency": float(rng.uniform(0.4, 1.2))})
    return draw(robot, effect, rng, taken)


def _ground_parameters(wrong: Wrong) -> dict[str, float]:
    if wrong.effect == "imu_bias":
        kind, factor = ("gyro", 1.0) if wrong.shape["gyro"] else ("accelerometer", 10.0)
        return {f"{kind}_{a}": factor * wrong.size * wrong.shape[a] for a in "xyz"}
    if wrong.effect == "ground_friction":
        return {"scale": 1.0 - wrong.size}
    return {}


def _record(
    plant: WalkingPlant,
    trace: WalkingTrace,
    robot: Chain,
    recorder: Recorder,
    rng: np.random.Generator,
    name: str,
    metadata: dict[str, Any],
) -> Log:
    from hyperleg_design.gap.logs.log import Log
    from hyperleg_design.gap.logs.metadata import Metadata

    ticks = np.arange(len(trace.targets)) / recorder.rate
    read = np.clip(ticks + np.abs(rng.normal(0, recorder.jitter, ticks.size)), 0, trace.time[-1])
    keep = rng.random(ticks.size) >= recorder.dropped
    keep[[0, -1]] = True
    written = read + rng.normal(0, recorder.clock, ticks.size)
    keep[1:] &= np.diff(np.maximum.accumulate(written)) > 1e-5
    place = read / (trace.time[1] - trace.time[0])
    below = np.minimum(place.astype(int), trace.time.size - 2)
    signals: dict[str, np.ndarray] = {}

    def put(kind: str, names: Sequence[str], values: np.ndarray, noise: Any) -> None:
        share = (place - below)[:, None]
        at = values[below] * (1 - share) + values[below + 1] * share
        at = at + rng.standard_normal(at.shape) * noise
        signals.update({f"{kind}/{n}": at[keep, k] for k, n in enumerate(names)})

    put("position", robot.joints, trace.encoder, recorder.position_noise)
    put("velocity", robot.joints, trace.speed, recorder.velocity_noise)
    put("motor_torque_command", robot.motors, trace.command, 0.0)
    put("motor_torque", robot.motors, trace.drive_torque, recorder.torque_noise * robot.peak_torque)
    put("gyro", "xyz", trace.gyro, INERTIAL[0])
    put("accelerometer", "xyz", trace.accelerometer, INERTIAL[1])
    put("base_position", "xyz", trace.base[:, :3], ESTIMATE[0])
    put("base_orientation", "wxyz", trace.base[:, 3:7], ESTIMATE[1] / 2)
    put("base_velocity", "xyz", trace.base[:, 7:], ESTIMATE[2])
    for k, pad in enumerate(pad_names(plant.model)):
        put("contact_force", [f"{pad}_{a}" for a in "xyz"], trace.contact[:, k], FORCE_NOISE)
    signals.update(
        {f"position_target/{j}": trace.targets[keep, k] for k, j in enumerate(robot.joints)}
    )
    length = np.sqrt(sum(signals[f"base_orientation/{a}"] ** 2 for a in "wxyz"))
    for a in "wxyz":
        signals[f"base_orientation/{a}"] = signals[f"base_orientation/{a}"] / length
    known: dict[str, Any] = {
        "robot": robot.robot,
        "base": "floating",
        "gains": {
            j: (float(k), float(d))
            for j, k, d in zip(robot.joints, robot.stiffness, robot.damping, strict=True)
        },
    }
    return Log(name, written[keep], signals, Metadata(**{**known, **metadata}))


def shown(effect: str, with_effect: Sequence[Log], clean: Sequence[Log], robot: Chain) -> float:
    """How many times over the floor an effect shows: in the residuals, or, of the ground, in where
    the base stands and how pads are loaded.
    """
    if effect in ("ground_friction", "ground_compliance"):
        levels = []
        for kind, noise in (
            ("base_position", 2 * ESTIMATE[0]),
            ("base_orientation", 2 * ESTIMATE[1]),
        ):
            for a in "wxyz" if kind == "base_orientation" else "xyz":
                gaps = [
                    np.interp(c.time, w.time, w.column(f"{kind}/{a}")) - c.column(f"{kind}/{a}")
                    for w, c in zip(with_effect, clean, strict=True)
                ]
                levels.append(np.sqrt(np.mean(np.concatenate(gaps) ** 2)) / noise / 3.0)
        return float(max(levels))
    ours, theirs = (
        [walking_residual(w, robot) for w in with_effect],
        [walking_residual(c, robot) for c in clean],
    )
    lengths = [min(len(a), len(b)) for a, b in zip(ours, theirs, strict=True)]
    return multiple(
        [a[:k] for a, k in zip(ours, lengths, strict=True)],
        [b[:k] for b, k in zip(theirs, lengths, strict=True)],
    )


@cache
def _nominal() -> tuple[Any, list[tuple[str, str, np.ndarray]]]:
    """Pinocchio model with a free base, and the pads: name, link and place in the link `(3,)`."""
    from hyperleg_design.robot.design import load_design
    from hyperleg_design.robot.mjcf import mujoco_model
    from hyperleg_design.robot.models import rigid_body_model

    design = load_design("hyperleg")
    model = mujoco_model(design)
    pads = [
        (p, model.body(int(model.geom(p).bodyid[0])).name, model.geom(p).pos.copy())
        for p in pad_names(model)
    ]
    return rigid_body_model(design), pads


def walking_residual(log: Log, robot: Chain) -> np.ndarray:
    """What the nominal model leaves over: base, joints and drives `(t, 6 + n + m)` [N, Nm],
    filtered; NaN where a joint may stick.
    """
    import pinocchio as pin
    from scipy.signal import butter, sosfiltfilt

    rigid, pads = _nominal()
    step = float(np.median(np.diff(log.time)))
    time = np.arange(log.time[0], log.time[-1], step)
    sos = butter(2, min(CUTOFF * 2 * step, 0.8), output="sos")

    def even(kind: str, names: Sequence[str]) -> np.ndarray:
        return np.stack([np.interp(time, log.time, log.column(f"{kind}/{n}")) for n in names], -1)

    def smooth(values: np.ndarray) -> np.ndarray:
        return np.asarray(sosfiltfilt(sos, values, axis=0))

    raw = even("position", robot.joints)
    position, turning, force = (
        smooth(raw),
        smooth(even("gyro", "xyz")),
        smooth(even("accelerometer", "xyz")),
    )
    velocity = smooth(np.gradient(position, step, axis=0))
    acceleration, spin = (
        smooth(np.gradient(velocity, step, axis=0)),
        np.gradient(turning, step, axis=0),
    )
    quaternion = smooth(even("base_orientation", "wxyz"))
    measured = even("motor_torque", robot.motors)
    command = even("motor_torque_command", robot.motors)
    loads = smooth(even("contact_force", [f"{p}_{a}" for p, *_ in pads for a in "xyz"])).reshape(
        len(time), len(pads), 3
    )
    links = list(dict.fromkeys(link for _, link, _ in pads))
    gravity = rigid.model.gravity.linear.copy()
    needed = np.empty((len(time), 6 + len(robot.joints)))
    try:
        rigid.model.gravity.linear = np.zeros(
            3
        )  # the accelerometer's specific force has gravity in it
        for k in range(len(time)):
            w, x, y, z = quaternion[k] / np.linalg.norm(quaternion[k])
            world = pin.Quaternion(w, x, y, z).toRotationMatrix()
            q = np.concatenate([np.zeros(3), [0, 0, 0, 1], position[k]])
            row = rigid.inverse_dynamics(
                q,
                np.concatenate([np.zeros(3), turning[k], velocity[k]]),
                np.concatenate([force[k], spin[k], acceleration[k]]),
            )
            for link in links:
                jacobian = rigid.frame_jacobian(q, link)
                frame = rigid.data.oMf[rigid.model.getFrameId(link)].rotation
                for number, (_, owner, place) in enumerate(pads):
                    if owner == link:
                        push = world.T @ loads[k, number]
                        row = row - jacobian.T @ np.concatenate(
                            [push, np.cross(frame @ place, push)]
                        )
            needed[k] = row
    finally:
        rigid.model.gravity.linear = gravity
    slow = np.abs(velocity) < SLOW
    joints = (
        measured @ robot.joint_from_motor.T
        - needed[:, 6:]
        - robot.coulomb * np.tanh(velocity / SOFT)
        - robot.viscous * velocity
    )
    asked = (
        robot.stiffness * (even("position_target", robot.joints) - raw)
        - robot.damping * even("velocity", robot.joints)
    ) @ np.linalg.pinv(robot.joint_from_motor).T
    rows = [
        smooth(-needed[:, :6]),
        np.where(slow, np.nan, smooth(joints)),
        smooth(measured - asked),
        smooth(command - asked)[:, :0],
    ]
    cut = round(EDGE / step)
    return np.concatenate(rows, -1)[cut:-cut]
