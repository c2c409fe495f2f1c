"""One case of a robot on its feet: draw robot and day, size the effect, record with an estimator's
base, an IMU and loaded soles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.validation.blind.case import Case
from hyperleg_design.validation.blind.drawing import draw
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.plants.nuisance import of_day, of_robot
from hyperleg_design.validation.blind.plants.stand import Stand
from hyperleg_design.validation.blind.rig_case import size_at
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.truth import parameters, places
from hyperleg_design.validation.blind.walker import BASE, Floor, Walker
from hyperleg_design.validation.blind.walking_residual import shown
from hyperleg_design.validation.blind.wrong import SIZES, WALKING_ONLY, Size, Wrong

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


def walking_case(plan: Plan) -> Case:
    """Simulate one case of the plant `walking`.

    Args:
        plan: of the case.

    Returns:
        The case.
    """
    rng = np.random.default_rng([*plan.seed, 3])
    robot = chain("hyperleg")
    life = of_robot(robot, rng)
    floor = Floor(
        float(rng.uniform(0.92, 1.08)),
        float(rng.uniform(0.8, 1.25)),
        float(rng.uniform(0.98, 1.02)),
    )
    walker = Walker(robot, of_day(robot, life, rng), floor, plan.recorder)
    wrongs: list[Wrong] = []
    for effect, wanted in zip(plan.effects, plan.multiples, strict=True):
        wrongs.append(_sized(walker, effect, wanted, rng, [w.location for w in wrongs]))
    recorded = None
    for _ in range(MOTIONS):
        if (recorded := _recorded(walker, plan, wrongs, rng)) is not None:
            break
    if recorded is None:
        raise RuntimeError("the robot fell in every recording, however small the effect")
    logs, wrongs, reached = recorded
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
    walker: Walker, plan: Plan, wrongs: Sequence[Wrong], rng: np.random.Generator
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
    walker: Walker, effect: str, wanted: float, rng: np.random.Generator, taken: Sequence[str]
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
