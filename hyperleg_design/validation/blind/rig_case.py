"""One case on a rig: draw robot and day, seek the size at which the effect shows as often over the
floor as planned, record.

`case.describe` can be had from here as well, where the benchmark asks every version for it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hyperleg_design.gap.logs.log import Log
from hyperleg_design.validation.blind import excitation
from hyperleg_design.validation.blind.case import Case
from hyperleg_design.validation.blind.case import describe as describe
from hyperleg_design.validation.blind.drawing import draw
from hyperleg_design.validation.blind.plan import Plan
from hyperleg_design.validation.blind.plants.nuisance import Nuisance, of_day, of_robot
from hyperleg_design.validation.blind.plants.other_rig import BELT_STIFFNESS, simulate_other
from hyperleg_design.validation.blind.plants.plant import Trace
from hyperleg_design.validation.blind.plants.rig import simulate
from hyperleg_design.validation.blind.plants.rig_build import Reach, build_rig
from hyperleg_design.validation.blind.recorder import Recorder, record
from hyperleg_design.validation.blind.residual import multiple, residual
from hyperleg_design.validation.blind.robots.catalogue import chain
from hyperleg_design.validation.blind.robots.chain import Chain
from hyperleg_design.validation.blind.truth import parameters, places
from hyperleg_design.validation.blind.wrong import SIZES, Wrong

PROBE = 5.0
"""Length of the runs that seek an effect's size [s]."""
PROBED = 4
"""Sizes tried at once."""
ATTEMPTS = 4
"""Places tried until one shows the effect as strongly as planned."""
WILD, WILD_SPEED = 4.0, 40.0
"""Position [rad] and speed [rad/s] from which a rig has gone wild."""
CALMED, SMALLER = 6, 0.6
"""Attempts to record a rig that stays whole, each with effects so much smaller."""
FEWEST_MULTIPLES = 0.8
"""Share of the planned multiple that a place must reach."""
SOFTER = (0.7, 0.4)
"""Gains of a coupled leg on the second plant over its data sheet's: encoders on the rotors bear no
more."""


def rig_case(plan: Plan) -> Case:
    """Simulate one case of the plants `rig` and `other`.

    Args:
        plan: of the case.

    Returns:
        The case.
    """
    rng = np.random.default_rng([*plan.seed, 2])
    robot = chain(plan.robot)
    if plan.plant == "other" and not robot.diagonal:
        robot = replace(
            robot, stiffness=robot.stiffness * SOFTER[0], damping=robot.damping * SOFTER[1]
        )
    life = of_robot(robot, rng)
    rig = _Rig(plan, robot, of_day(robot, life, rng))
    wrongs: list[Wrong] = []
    for effect, wanted in zip(plan.effects, plan.multiples, strict=True):
        wrongs.append(_sized(rig, effect, wanted, rng, [w.location for w in wrongs]))
    wrongs, runs = _recorded(rig, wrongs, rng)
    clean = [residual(log, robot) for log in runs[:3]]
    logs = runs[3:6] if wrongs else runs[:3]
    alone = (
        [runs[6 + 3 * i : 9 + 3 * i] for i in range(len(wrongs))]
        if len(wrongs) > 1
        else [logs] * len(wrongs)
    )
    reached = tuple(multiple([residual(log, robot) for log in group], clean) for group in alone)
    references: list[Log] = []
    if plan.references:
        healthy = replace(rig, day=of_day(robot, life, rng), session="before", role="reference")
        references = _referred(healthy, rng)
    return Case(
        plan=plan,
        robot=robot.robot,
        mjcf=robot.mjcf,
        logs=tuple(logs),
        references=tuple(references),
        wrongs=tuple(wrongs),
        multiples=reached,
        parameters=tuple(
            parameters(
                w, robot, rig.day, rig.reach, belts=1.0 if plan.plant == "rig" else BELT_STIFFNESS
            )
            for w in wrongs
        ),
        also=tuple(places(w, robot) for w in wrongs),
    )


def _recorded(
    rig: _Rig, wrongs: list[Wrong], rng: np.random.Generator
) -> tuple[list[Wrong], list[Log]]:
    """Three clean logs, three of all effects, and three of each of several; effects that shake the
    rig to pieces made smaller first.
    """
    for _ in range(CALMED):
        moves = rig.motions(3, rig.plan.duration, rng)
        seeds = [int(s) for s in rng.integers(2**31, size=3)]
        ways: list[Sequence[Wrong]] = [(), wrongs] if wrongs else [()]
        if len(wrongs) > 1:
            ways += [[w] for w in wrongs]
        jobs = [(w, moves[k], seeds[k]) for w in ways for k in range(3)]
        traces = rig.traces(jobs)
        if all(calm(trace) for trace in traces):
            break
        wrongs = [
            replace(
                w,
                size=float(np.sign(w.size) * max(SMALLER * abs(w.size), SIZES[w.effect].smallest)),
            )
            for w in wrongs
        ]
    return wrongs, rig.logs(traces, jobs)


def _referred(healthy: _Rig, rng: np.random.Generator) -> list[Log]:
    """Two logs of the healthy rig; none where it shakes itself to pieces in all motions tried."""
    for _ in range(CALMED):
        moves = healthy.motions(2, healthy.plan.duration, rng)
        jobs: list[tuple[Sequence[Wrong], np.ndarray, int]] = [
            ((), moves[k], int(rng.integers(2**31))) for k in range(2)
        ]
        traces = healthy.traces(jobs)
        if all(calm(trace) for trace in traces):
            return healthy.logs(traces, jobs)
    return []


def calm(trace: Trace) -> bool:
    """Whether no joint of a run turns farther or faster than joints can.

    Args:
        trace: of the run.

    Returns:
        True if it did.
    """
    limits = ((trace.position, WILD), (trace.velocity, WILD_SPEED))
    return all(
        bool(np.isfinite(values).all() and np.abs(values).max() < limit) for values, limit in limits
    )


@dataclass(eq=False)
class _Rig:
    plan: Plan
    chain: Chain
    day: Nuisance
    session: str = "today"
    role: str = "test"
    reach: Reach | None = None

    @property
    def recorder(self) -> Recorder:
        return self.plan.recorder

    @property
    def simulator(self) -> Callable[..., list[Trace]]:
        return simulate if self.plan.plant == "rig" else simulate_other

    def motions(self, count: int, duration: float, rng: np.random.Generator) -> list[np.ndarray]:
        kinds = list(excitation.RIG if self.plan.plant == "rig" else excitation.OTHER)
        return [
            excitation.motion(k, self.chain, duration, self.recorder.rate, rng)
            for k in list(rng.permutation(kinds))[:count]
        ]

    def traces(self, jobs: Sequence[tuple[Sequence[Wrong], np.ndarray, int]]) -> list[Trace]:
        plants = [build_rig(self.chain, self.day, wrongs, self.reach) for wrongs, _, _ in jobs]
        # a size too large may shake a rig to pieces; it is then not taken
        with np.errstate(all="ignore"):
            return self.simulator(
                plants,
                np.stack([t for _, t, _ in jobs]),
                self.recorder.rate,
                seeds=[s for *_, s in jobs],
            )

    def logs(
        self, traces: Sequence[Trace], jobs: Sequence[tuple[Sequence[Wrong], np.ndarray, int]]
    ) -> list[Log]:
        return [
            self.log(trace, job, self.recorder, number)
            for number, (trace, job) in enumerate(zip(traces, jobs, strict=True))
        ]

    def log(
        self,
        trace: Trace,
        job: tuple[Sequence[Wrong], np.ndarray, int],
        recorder: Recorder,
        number: int,
    ) -> Log:
        return record(
            trace,
            job[1],
            self.chain,
            recorder,
            np.random.default_rng(job[2]),
            name=f"{self.session}_{number}",
            robot=self.chain.robot,
            session=self.session,
            role=self.role,
        )


def _sized(
    rig: _Rig, effect: str, wanted: float, rng: np.random.Generator, taken: Sequence[str]
) -> Wrong:
    """Draw an effect at a place, with the size at which it shows `wanted` times over the noise
    floor.
    """
    best: tuple[float, Wrong] | None = None
    for _ in range(ATTEMPTS):
        draft = draw(rig.chain, effect, rng, taken)
        moves = rig.motions(2, min(PROBE, rig.plan.duration), rng)
        seeds = [int(s) for s in rng.integers(2**31, size=2)]
        sizes = np.geomspace(SIZES[effect].smallest, SIZES[effect].largest, PROBED) * np.sign(
            draft.size
        )
        if effect == "controller_gain" and draft.size < 0:
            sizes = np.maximum(sizes, -0.6)
        smallest = 0.0, replace(draft, size=float(sizes[0]))
        if rig.reach is None:
            healthy = rig.traces([((), moves[k], seeds[k]) for k in range(2)])
            if not all(calm(trace) for trace in healthy):
                best = best or smallest
                continue
            rig.reach = reach_of(healthy)
        jobs = [
            ((replace(draft, size=float(s)),) if s else (), moves[k], seeds[k])
            for s in (0.0, *sizes)
            for k in range(2)
        ]
        traces = rig.traces(jobs)
        quiet = replace(rig.recorder, dropped=0.0)
        residuals = [
            residual(rig.log(t, j, quiet, 0), rig.chain) if calm(t) else None
            for t, j in zip(traces, jobs, strict=True)
        ]
        clean = [f for f in residuals[:2] if f is not None]
        if len(clean) < 2:  # motions that shake even the healthy rig to pieces say nothing of sizes
            best = best or smallest
            continue
        ratios = []
        for row in range(1, PROBED + 1):
            pair = [f for f in residuals[2 * row : 2 * row + 2] if f is not None]
            ratios.append(multiple(pair, clean) if len(pair) == 2 else np.inf)
        size, reached = size_at(np.abs(sizes), np.array(ratios), wanted, SIZES[effect].smallest)
        wrong = replace(draft, size=float(size * np.sign(draft.size)))
        if best is None or reached > best[0]:
            best = (reached, wrong)
        if reached >= FEWEST_MULTIPLES * wanted:
            break
    assert best is not None
    return best[1]


def size_at(
    sizes: np.ndarray, ratios: np.ndarray, wanted: float, smallest: float
) -> tuple[float, float]:
    """Size at which an effect shows `wanted` times over the floor, and how far it comes; never
    below the smallest that was tried.

    Args:
        sizes: tried, rising.
        ratios: multiples they gave; infinite where the rig went wild.
        wanted: multiple.
        smallest: what is taken where even the first size goes wild.
    """
    tame = np.isfinite(ratios)
    last = int(np.argmin(tame)) if not tame.all() else len(ratios)
    if last == 0:
        return float(smallest), 0.0
    sizes, ratios = sizes[:last], np.maximum(ratios[:last], 1e-6)
    above = np.flatnonzero(ratios >= wanted)
    if not above.size:
        return float(sizes[-1]), float(ratios[-1])
    k = int(above[0])
    if k == 0:
        return float(sizes[0]), float(ratios[0])  # anything smaller drowns in what is off anyway
    share = np.log(wanted / ratios[k - 1]) / np.log(ratios[k] / ratios[k - 1])
    return float(sizes[k - 1] * (sizes[k] / sizes[k - 1]) ** share), wanted


def reach_of(traces: Sequence[Trace]) -> Reach:
    """How far clean runs drive the motors.

    Args:
        traces: of the clean runs.

    Returns:
        The reach.
    """
    return Reach(
        np.max([np.percentile(np.abs(t.command), 99.5, axis=0) for t in traces], 0),
        np.max([np.abs(t.motor_velocity).max(0) for t in traces], 0),
    )
