"""Evaluation of many designs, over bare physics of the same robots and states.

64 designs with 10 walks each, as a sweep evaluates them: 16 designs side by side, with models
built, policy, actuation, recording and measures. Bare physics is `mujoco.batch.Batch.step` of as
many robots that are not driven by a policy, each with its own design's model, from states that the
walks went through; it counts the simulation steps until each trial ended. Ratios are of processor
time of one process, so they mean something on a busy machine.

    python benchmarks/variants.py --designs 64 --distance 20

With `--export FOLDER`, models and states go to files that `variants_peer.py` steps with other
programs.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from hyperleg_design.evaluation.policy import load_policy
from hyperleg_design.evaluation.protocol import Steady, WalkProtocol
from hyperleg_design.evaluation.protocols.walk import walk_task
from hyperleg_design.simulation import model as models
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.stepping.batch_models import give_models
from hyperleg_design.sweep.trial_runs import BATCH, evaluate_all

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


def states_of(policy, designs, protocol):
    """Models, states and friction of all robots at some moments of their walks."""
    count = len(designs["toe.mass"])
    environment = Environment(
        designs,
        walk_task(policy.task, protocol),
        simulations=count * int(protocol.trials),
        threads=1,
        common_random_numbers=True,
    )
    observation = environment.reset()["policy"]
    moments = []
    for step in range(STEPS * EVERY):
        if step % EVERY == 0:
            moments.append(
                [
                    np.concatenate([np.array(get(chunk)) for chunk in environment.chunks])
                    for get in (
                        lambda chunk: chunk.batch.state,
                        lambda chunk: chunk.batch.expanded("dof_damping"),
                        lambda chunk: chunk.drive.qpos,
                        lambda chunk: chunk.drive.qvel,
                        lambda chunk: chunk.batch.bind("ctrl"),
                    )
                ]
            )
        observation = environment.step(policy(observation)).observations["policy"]
    environment.close()
    robots = [environment.models[i] for i in environment.design_index]
    return environment, robots, moments


def bare_seconds(environment, robots, moments, calls=1):
    """Processor time of one simulation step of one robot in bare physics [s], with the steps of a
    policy step in one call or in several.
    """
    from mujoco import batch

    bare = batch.Batch(robots[0], len(robots), 1)
    give_models(bare, robots)
    substeps, spent = int(environment.task.physics.substeps), []
    for state, damping, *_ in moments:
        bare.state[:] = state
        bare.expand("dof_damping")[:] = damping
        start = time.process_time()
        for _ in range(calls):
            bare.step(nstep=substeps // calls)
        spent.append(time.process_time() - start)
    return float(np.median(spent)) / (len(robots) * substeps)


def export(folder, environment, moments):
    """Models as MJCF in full precision, and states of all robots at the moments of `states_of`.

    Contact sensors are left out: those of pads tell velocities, which older versions of MuJoCo do
    not know.

    Returns:
        The models without contact sensors, one a robot.
    """
    import mujoco

    from hyperleg_design.robot.mjcf import _full_precision
    from hyperleg_design.simulation.model import simulation_spec

    folder.mkdir(parents=True, exist_ok=True)
    plain = []
    for number, design in enumerate(environment.designs):
        spec = simulation_spec(design, environment.task.physics)
        for sensor in list(spec.sensors):
            if sensor.type == mujoco.mjtSensor.mjSENS_CONTACT:
                spec.delete(sensor)
        plain.append(spec.compile())
        with _full_precision():
            (folder / f"{number}.xml").write_text(spec.to_xml())
    names = ("damping", "qpos", "qvel", "ctrl")
    arrays = {name: np.stack([m[1 + k] for m in moments]) for k, name in enumerate(names)}
    np.savez(
        folder / "states.npz",
        design=environment.design_index,
        substeps=int(environment.task.physics.substeps),
        **arrays,
    )
    return [plain[i] for i in environment.design_index]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=64)
    parser.add_argument("--trials", type=int, default=10)
    parser.add_argument("--distance", type=float, default=2.0, help="of each walk [m]")
    parser.add_argument("--batch", type=int, default=BATCH, help="designs side by side")
    parser.add_argument("--export", type=Path, help="folder for models and states")
    chosen = parser.parse_args()
    policy = load_policy("walk_upright-toe-0")
    designs = designs_of(policy, chosen.designs)
    protocol = WalkProtocol(
        trials=chosen.trials,
        distance=chosen.distance,
        time_limit=max(1.5 * chosen.distance, 2.0),
        steady=Steady(begin=min(4.0, chosen.distance / 2)),
    )
    each = [designs.take(i) for i in range(chosen.designs)]
    spent = {}
    for name in ("built", "kept"):
        start = time.process_time()
        models.simulated_robots(each, policy.task.physics)
        spent[name] = time.process_time() - start
    start, ends = time.process_time(), []
    for begin in range(0, chosen.designs, chosen.batch):
        rows = np.arange(begin, min(begin + chosen.batch, chosen.designs))
        done, _ = evaluate_all(policy, designs.rows(rows), protocol, 1)
        ends += [end for evaluation in done.values() for end in evaluation.end_times]
    spent["evaluated"] = time.process_time() - start
    environment, robots, moments = states_of(
        policy, designs.rows(np.arange(min(chosen.batch, chosen.designs))), protocol
    )
    if chosen.export:
        plain = 1e6 * bare_seconds(
            environment, export(chosen.export, environment, moments), moments
        )
        print(f"mujoco.batch without contact sensors: {plain:.1f} us a step of a robot")
    bare = bare_seconds(environment, robots, moments)
    single = bare_seconds(environment, robots, moments, int(environment.task.physics.substeps))
    physics = bare * sum(ends) / float(environment.task.physics.time_step)
    whole = spent["built"] + spent["evaluated"]
    print(
        f"{chosen.designs} designs x {chosen.trials} walks of {chosen.distance:g} m, "
        f"{chosen.batch} designs side by side, processor time: models {spent['built']:.1f} s "
        f"(again: {spent['kept']:.2f} s), evaluation {spent['evaluated']:.1f} s, bare physics "
        f"{physics:.1f} s ({1e6 * bare:.1f} us a step of a robot)"
    )
    print(
        f"bare physics over evaluation: {physics / spent['evaluated']:.2f} with models at hand, "
        f"{physics / whole:.2f} with models built; at most {bare / single:.2f} where torques "
        f"are set before each step ({1e6 * single:.1f} us a step of a robot in a call of its own)"
    )


if __name__ == "__main__":
    main()
