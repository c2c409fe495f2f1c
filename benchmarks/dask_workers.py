"""Walks of a sweep's designs on two workers of a Dask cluster, over the same on one.

Sixteen designs with different knees walk ten times each, two designs a batch, as `hyperleg sweep
run --scheduler` distributes them. Workers are processes of one thread on this machine. Every round
times one worker, then both; the first round warms up and is not counted. The ratio is of medians
within this run, and means something on an idle machine with two processors only.

    python benchmarks/dask_workers.py --rounds 3
"""

from __future__ import annotations

import argparse
import dataclasses
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

from hyperleg_design.evaluation.protocol import Steady, load_protocol
from hyperleg_design.sweep.jobs import cluster
from hyperleg_design.sweep.run import run_sweep
from hyperleg_design.sweep.space import sweep_from_mapping
from hyperleg_design.sweep.trial_runs import run_trials
from hyperleg_design.sweep.trials.trial_plan import plan

TARGET = 1.8
BATCH = 2


def seconds(sweep, protocol, address):
    """Wall time of the trials of all designs of a sweep on the workers of a cluster [s]."""
    wanted = plan(sweep, [protocol], seeds=1)
    with tempfile.TemporaryDirectory() as folder, cluster(address) as executor:
        result = run_sweep(sweep, Path(folder) / "sweep", progress=False)
        start = time.perf_counter()
        run_trials(result, wanted, batch=BATCH, executor=executor, threads=1, progress=False)
        return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--designs", type=int, default=16)
    parser.add_argument("--distance", type=float, default=20.0, help="of each walk [m]")
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    from distributed import LocalCluster

    sweep = sweep_from_mapping(
        {
            "name": "benchmark",
            "design": "hyperleg",
            "variants": ["toe"],
            "sampling": "grid",
            "axes": {
                "knee": {
                    "paths": ["transmission.scale.knee"],
                    "scale": [round(float(s), 3) for s in np.linspace(0.85, 1.2, given.designs)],
                }
            },
        }
    )
    protocol = dataclasses.replace(
        load_protocol("walk"),
        distance=given.distance,
        steady=Steady(begin=0.2 * given.distance, end=given.distance),
    )
    spent: dict[int, list[float]] = {1: [], 2: []}
    local = {"threads_per_worker": 1, "processes": True, "dashboard_address": ":0"}
    with LocalCluster(n_workers=1, **local) as one, LocalCluster(n_workers=2, **local) as two:
        for turn in range(given.rounds + 1):
            for workers, here in ((1, one), (2, two)):
                wall = seconds(sweep, protocol, here.scheduler_address)
                print(f"{workers} workers: {wall:.1f} s{'' if turn else ' (not counted)'}")
                if turn:
                    spent[workers].append(wall)
    ratio = statistics.median(spent[1]) / statistics.median(spent[2])
    print(f"two workers over one: {ratio:.2f} times as fast (aim: {TARGET})")


if __name__ == "__main__":
    main()
