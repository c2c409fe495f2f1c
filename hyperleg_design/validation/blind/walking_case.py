"""One case of a robot on its feet: draw robot and day, size the effect, record with an estimator's
base, an IMU and loaded soles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hyperleg_design.validation.blind.case import Case
from hyperleg_design.validation.blind.chain import GRAVITY, Chain, chain
from hyperleg_design.validation.blind.drawing import draw
from hyperleg_design.validation.blind.nuisance import Nuisance, built, of_day, of_robot
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.plant_walking import (
    Ground,
    Stand,
    WalkingPlant,
    WalkingTrace,
    simulate_walking,
    walking_model,
)
from hyperleg_design.validation.blind.recorder import Recorder
from hyperleg_design.validation.blind.rig_build import build_rig, tilted
from hyperleg_design.validation.blind.rig_case import size_at
from hyperleg_design.validation.blind.walking_record import walking_log
from hyperleg_design.validation.blind.walking_residual import shown
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
    """Simulate one case of the plant `walking`.

    Args:
        plan: of the case.

    Returns:
        The case.
    """
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
        """A log, or None where the robot fell.

        Args:
            made: the plant and the trace of its run.
            seed: of the recording.
            name: of the log.
            metadata: of the log.

        Returns:
            The log, or None.
        """
        plant, trace = made
        return (
            None
            if trace.fell
            else walking_log(
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
    """A motion on both feet.

    Args:
        rng: source of randomness.

    Returns:
        The motion.
    """
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
