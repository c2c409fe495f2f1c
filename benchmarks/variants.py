"""Evaluation of many designs side by side, over bare physics of the same robots and states.

64 designs with 10 walks each, as `evaluate_designs` runs them: models built, policy, actuation,
recording, measures. Bare physics is `mujoco.batch.Batch.step` of as many robots, each with its own
design's model, from states that the walks went through. Shares are of processor time, so they mean
something on a busy machine; both run in the same process, one after the other.

    python benchmarks/variants.py --designs 64 --distance 2.0
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from hyperleg_design.evaluation.evaluate import evaluate_designs
from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.evaluation.walk import walk_task
from hyperleg_design.simulation import model as models
from hyperleg_design.simulation.chunk import _give_models
from hyperleg_design.simulation.environment import Environment

STEPS = 12
"""Policy steps whose states bare physics starts from."""
EVERY = 4
"""Policy steps between those."""


def designs_of(policy, count):
    """Designs spread over reductions, toe mass and lengths, near enough to walk."""
    rng = np.random.default_rng(0)
    base = policy.design
    return base.with_values(
        {
            "transmission.scale.knee": rng.uniform(0.8, 1.25, count),
            "toe.mass": rng.uniform(0.1, 0.6, count),
            "thigh.length": float(base.thigh.length) * rng.uniform(0.97, 1.03, count),
        }
    )


def bare_seconds(policy, designs, protocol, threads):
    """Processor time of one policy step of bare physics of all robots [s]."""
    from mujoco import batch

    count = len(designs["toe.mass"])
    environment = Environment(
        designs,
        walk_task(policy.task, protocol),
        simulations=count * int(protocol.trials),
        threads=threads,
        common_random_numbers=True,
    )
    bare = batch.Batch(environment.model, environment.simulations, threads)
    _give_models(bare, [environment.models[i] for i in environment.design_index])
    fields = [
        name
        for name in ("dof_damping", "tendon_damping")
        if environment.chunks[0].batch.expanded(name) is not None
    ]
    observation, found = environment.reset()["policy"], []
    substeps = int(environment.task.physics.substeps)
    for step in range(STEPS * EVERY):
        if step % EVERY == 0:
            for chunk in environment.chunks:
                own = slice(chunk.first, chunk.first + chunk.count)
                bare.state[own] = chunk.batch.state
                for name in fields:
                    bare.expand(name)[own] = chunk.batch.expand(name)
            start = time.process_time()
            bare.step(nstep=substeps)
            found.append(time.process_time() - start)
        observation = environment.step(policy(observation)).observations["policy"]
    environment.close()
    return float(np.median(found)), float(environment.task.physics.policy_step)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=64)
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--distance", type=float, default=2.0, help="of each walk [m]")
    parser.add_argument("--threads", type=int, default=2)
    chosen = parser.parse_args()
    policy = load_policy("walk-toe-0")
    designs = designs_of(policy, chosen.designs)
    protocol = WalkProtocol(
        trials=chosen.trials,
        distance=chosen.distance,
        time_limit=1.5 * chosen.distance,
        steady=Steady(begin=chosen.distance / 2),
    )
    each = [designs.take(i) for i in range(chosen.designs)]
    spent = {}
    for name in ("built", "kept"):
        start = time.process_time()
        models.simulated_robots(each, policy.task.physics)
        spent[name] = time.process_time() - start
    wall, start = time.perf_counter(), time.process_time()
    done = evaluate_designs(policy, designs, protocol, threads=chosen.threads)
    spent["evaluated"], wall = time.process_time() - start, time.perf_counter() - wall
    bare, step = bare_seconds(policy, designs, protocol, chosen.threads)
    # all robots are stepped until the last trial has ended
    steps = max(max(one.end_times) for one in done) / step
    physics = bare * steps
    whole = spent["built"] + spent["evaluated"]
    print(
        f"{chosen.designs} designs x {chosen.trials} walks of {chosen.distance:g} m, processor "
        f"time: models {spent['built']:.1f} s (again: {spent['kept']:.2f} s), evaluation "
        f"{spent['evaluated']:.1f} s ({wall:.1f} s on the clock), bare physics {physics:.1f} s"
    )
    print(
        f"bare physics over evaluation: {physics / spent['evaluated']:.2f} with models at hand, "
        f"{physics / whole:.2f} with models built"
    )


if __name__ == "__main__":
    main()
