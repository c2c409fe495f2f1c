"""Policy steps per second of the whole environment, over those of bare mj_step on the same model
and states.

Bare physics is `mujoco.batch.Batch.step` with four substeps a policy step, on as many C threads,
from the very states that the environment stepped and with the joint damping that stands for
friction there. Both are timed in turn, in blocks of a few steps, so that the machine's drift hits
both; between blocks the threads of the other come to rest. The ratio of processor times leaves out
waiting, so it means something on a busy machine.

    python benchmarks/environment_throughput.py --threads 2 --simulations 256 512 1024
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from hyperleg_design.robot.design import load_design
from hyperleg_design.simulation.environment import Environment
from hyperleg_design.simulation.tasks import load_task

BLOCK = 10
"""Policy steps timed together."""
PAUSE = 0.02
"""Between blocks [s]."""


def measure(
    simulations: int, threads: int, blocks: int, task: str, noise: float
) -> dict[str, float]:
    """Policy steps per second of the environment and of bare physics, and the ratio of the
    medians.
    """
    from mujoco import batch

    environment = Environment(
        load_design(), load_task(task), simulations=simulations, seed=0, threads=threads
    )
    bare = batch.Batch(environment.model, simulations, threads)
    rng = np.random.default_rng(1)
    environment.reset()
    actions = rng.normal(size=(16, simulations, environment.action_size)) * noise
    damping = bare.expand("dof_damping")
    states, dampings = np.empty((BLOCK, *bare.state.shape)), np.zeros((BLOCK, *damping.shape))
    whole, physics, whole_work, physics_work = [], [], [], []
    for block in range(blocks + 1):
        spent, work = 0.0, time.process_time()
        for step in range(BLOCK):
            for chunk in environment.chunks:
                states[step, chunk.first : chunk.first + chunk.count] = chunk.batch.state
            start = time.perf_counter()
            environment.step(actions[(block * BLOCK + step) % len(actions)])
            spent += time.perf_counter() - start
            for chunk in environment.chunks:
                dampings[step, chunk.first : chunk.first + chunk.count] = chunk.batch.expand(
                    "dof_damping"
                )
        whole.append(spent / BLOCK)
        whole_work.append(time.process_time() - work)
        time.sleep(PAUSE)
        spent, work = 0.0, time.process_time()
        for state, same in zip(states, dampings, strict=True):
            bare.state[:], damping[:] = state, same
            start = time.perf_counter()
            bare.step(nstep=int(environment.task.physics.substeps))
            spent += time.perf_counter() - start
        physics.append(spent / BLOCK)
        physics_work.append(time.process_time() - work)
        time.sleep(PAUSE)
    for found in (whole, physics, whole_work, physics_work):
        del found[0]  # warming up
    environment.close()
    return {
        "environment": simulations / float(np.median(whole)),
        "bare": simulations / float(np.median(physics)),
        "ratio": float(np.median(np.array(physics) / np.array(whole))),
        "work_ratio": float(np.median(np.array(physics_work) / np.array(whole_work))),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--simulations", type=int, nargs="+", default=[256, 512, 1024])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--blocks", type=int, default=12)
    parser.add_argument("--task", default="walk")
    parser.add_argument(
        "--noise",
        type=float,
        nargs="+",
        default=[0.1, 1.0],
        help="standard deviations of the random actions",
    )
    options = parser.parse_args()
    for noise in options.noise:
        for simulations in options.simulations:
            found = measure(simulations, options.threads, options.blocks, options.task, noise)
            print(
                f"noise {noise:g}, {simulations} simulations, {options.threads} threads: "
                f"environment {found['environment']:.0f}, "
                f"bare mj_step {found['bare']:.0f} policy steps/s, ratio {found['ratio']:.3f} "
                f"(of processor time {found['work_ratio']:.3f})"
            )


if __name__ == "__main__":
    main()
