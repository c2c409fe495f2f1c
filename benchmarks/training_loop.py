"""Policy steps per second of the whole training loop on all cores, over those of bare mj_step from
as many C threads.

One training of one thread a core, side by side, as a campaign runs them: physics, actuators,
observations, rewards, acting and PPO's updates. Bare physics is `mujoco.batch.Batch.step` on the
same model with as many threads, from a standing start, in turn with the trainings so that the
machine's drift hits both. The walk is trained from scratch, so the robots fall about at first.

    python benchmarks/training_loop.py --processes 2 --iterations 24 --rounds 3
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

TRAIN = """
import sys
from hyperleg_design.learning.train import train
train("walk", "toe", int(sys.argv[1]), "laptop", sys.argv[2], iterations=int(sys.argv[3]))
"""
WARM = 4
"""First iterations of a round that do not count."""
SECONDS = 4.0
"""Of bare physics a round."""


def trained(processes: int, iterations: int, folder: Path) -> float:
    """One round of trainings: policy steps per second of all together."""
    from hyperleg_design.learning.launch import surroundings

    begun = [
        subprocess.Popen(
            [sys.executable, "-c", TRAIN, str(seed), str(folder / str(seed)), str(iterations)],
            env=surroundings(),
        )
        for seed in range(processes)
    ]
    if any(process.wait() for process in begun):
        raise SystemExit("a training failed")
    rates = []
    for seed in range(processes):
        lines = [
            json.loads(line)
            for line in (folder / str(seed) / "progress.jsonl").read_text().splitlines()
        ]
        rates.append([line["rate"] for line in lines][-iterations:][WARM:])
    return float(sum(np.median(r) for r in rates))


def physics(threads: int, simulations: int = 256) -> float:
    """Policy steps per second of bare physics, four substeps each."""
    from mujoco import batch

    from hyperleg_design.robot.design import load_design
    from hyperleg_design.simulation.environment import Environment
    from hyperleg_design.simulation.tasks import load_task

    environment = Environment(
        load_design("toe"), load_task("walk"), simulations=simulations, seed=0, threads=threads
    )
    environment.reset()
    bare = batch.Batch(environment.model, simulations, threads)
    for chunk in environment.chunks:
        bare.state[chunk.first : chunk.first + chunk.count] = chunk.batch.state
    start, substeps, taken = bare.state.copy(), int(environment.task.physics.substeps), []
    until = time.perf_counter() + SECONDS
    while time.perf_counter() < until:
        bare.state[:] = start
        began = time.perf_counter()
        for _ in range(5):
            bare.step(nstep=substeps)
        taken.append((time.perf_counter() - began) / 5)
    environment.close()
    return simulations / float(np.median(taken))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--iterations", type=int, default=24)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    loops, bare = [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(options.rounds):
            bare.append(physics(options.processes))
            loops.append(trained(options.processes, options.iterations, Path(folder)))
    print(
        f"{options.processes} trainings side by side: {np.median(loops):.0f} policy steps/s "
        f"together; bare mj_step on "
        f"{options.processes} threads {np.median(bare):.0f}; ratio of medians "
        f"{np.median(loops) / np.median(bare):.3f}"
    )


if __name__ == "__main__":
    main()
